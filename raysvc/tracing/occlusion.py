"""How much of the sky a point sees, within some distance.

Cosine-weighted rays in a fixed pattern, from one pixel of every 2 x 2. Neighbours among those take
different shifts of the pattern (interleaved sampling: Keller and Heidrich 2001), and every pixel
takes the mean of the four of them about it that show its surface: as smooth as four times the rays.
"""

import math

import numpy as np

from raysvc.accel.base import Rays
from raysvc.shading.surface import Surface
from raysvc.tracing.occlusion_kernels import cosine_rays
from raysvc.types import Bools, Doubles, Floats, Ints, Longs

EVERY = 2
"""Rays start from one pixel of so many by so many."""
_AWAY = np.array([[1.0, 0.0, 1.0, 0.0, 0.5], [0.0, 1.0, 0.0, 1.0, 0.0]], np.float32)
AROUND: Floats = np.einsum("ay,bx->abyx", _AWAY, _AWAY).reshape(4, 5, 5)
"""Weights of the traced pixels about each of 2 x 2: every shift of the pattern counts the same."""
GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0


def pattern(samples: int, seed: int) -> Doubles:
    """(samples, 2) float64 points of the unit square: a rank-1 lattice shifted by the seed."""
    shift = np.random.default_rng(seed).random(2)
    index = np.arange(samples)
    first = ((index + shift[0]) / samples) % 1.0
    return np.stack([first, (index * GOLDEN + shift[1]) % 1.0], axis=1)


def is_traced(pixel: Longs, width: int) -> Bools:
    """(N,) bool: pixels from which rays start."""
    row, col = np.divmod(pixel, width)
    traced: Bools = (row % EVERY == 0) & (col % EVERY == 0)
    return traced


def tile_of(pixel: Longs, width: int) -> Ints:
    """(N,) int32 in 0..3: which shift of the pattern a pixel takes, not its neighbours'."""
    row, col = np.divmod(pixel, width)
    shifts = np.array([[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]], np.int32)
    tile: Ints = shifts[row // EVERY % 4, col // EVERY % 4]
    return tile


def occlusion_rays(surface: Surface, tile: Ints, samples: Doubles, radius_m: float) -> Rays:
    """Rays (N * K) in a cosine-weighted pattern from N points, those of a point next to each other.

    `tile` (N,) shifts the pattern `samples` (K, 2) by so many quarters.
    """
    count = surface.size * len(samples)
    origins = np.empty((count, 3), np.float32)
    directions = np.empty((count, 3), np.float32)
    cosine_rays(surface, tile, samples, origins, directions)
    return Rays(origins, directions, np.full(count, radius_m, np.float32))
