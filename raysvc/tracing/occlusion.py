"""How much of the sky a point sees, within some distance.

Cosine-weighted rays in a fixed pattern, from one pixel of every 2 x 2. Neighbours among those take
different shifts of the pattern (interleaved sampling: Keller and Heidrich 2001), and every pixel
takes the mean of the four of them about it that show its surface: as smooth as four times the rays.
"""

import math
from dataclasses import dataclass

import numpy as np

from raysvc.accel.base import Rays
from raysvc.shading.surface import Surface
from raysvc.tracing.occlusion_kernels import cosine_rays, neighbours_mean
from raysvc.tracing.world import World
from raysvc.types import Bools, Doubles, Floats, Ints, Longs

EVERY = 2
"""Rays start from one pixel of so many by so many."""
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
    shifts = np.array([[0, 2], [3, 1]], np.int32)
    tile: Ints = shifts[row // EVERY % 2, col // EVERY % 2]
    return tile


def visibility(
    world: World,
    surface: Surface,
    tile: Ints,
    samples: Doubles,
    radius_m: float,
) -> Floats:
    """(N,) float32 in 0..1: cosine-weighted part of the hemisphere free within `radius_m`.

    `tile` (N,) shifts the pattern `samples` (K, 2) by so many quarters.
    """
    count = surface.size * len(samples)
    origins = np.empty((count, 3), np.float32)
    directions = np.empty((count, 3), np.float32)
    cosine_rays(surface, tile, samples, origins, directions)
    rays = Rays(origins, directions, np.full(count, radius_m, np.float32))
    through = world.transmittance(rays).reshape(surface.size, len(samples))
    free: Floats = np.einsum("nk->n", through) / np.float32(len(samples))
    return free


@dataclass(frozen=True, slots=True, eq=False)
class VisibilityPicture:
    """Ambient visibility by pixel, with what tells one surface from another.

    Attributes
    ----------
    visible
        (H, W) float32, -1 where it is not known
    depth
        (H, W) float32 metres along the view axis, inf where there is nothing
    normal
        (H, W, 3) float32 unit
    depth_step
        (H, W) float32 metres: how much depth may differ per pixel of distance on one surface
    """

    visible: Floats
    depth: Floats
    normal: Floats
    depth_step: Floats

    def around(self, pixel: Longs, depth: Floats, normal: Floats) -> Floats:
        """(N,) visibility at pixel centres, from the traced pixels about them, or -1."""
        return self._mean(pixel, depth, normal, EVERY, EVERY - 1)

    def beside(self, pixel: Longs, depth: Floats, normal: Floats) -> Floats:
        """(N,) visibility of points elsewhere in pixels, from all pixels about them, or -1."""
        return self._mean(pixel, depth, normal, 1, 1)

    def _mean(self, pixel: Longs, depth: Floats, normal: Floats, before: int, after: int) -> Floats:
        mean = np.empty(len(pixel), np.float32)
        neighbours_mean(
            self.visible,
            self.depth,
            self.normal,
            self.depth_step,
            pixel,
            depth,
            normal,
            before,
            after,
            mean,
        )
        return mean
