"""How much of the sky a point sees, within some distance.

Cosine-weighted rays in a fixed pattern. Each pixel of a 4 x 4 tile turns the pattern by another
angle (interleaved sampling: Keller and Heidrich 2001), and a 4 x 4 mean over neighbours on the same
surface (`VisibilityPicture.smooth`) then joins 16 patterns into one: as smooth as 16 times the
rays.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from raysvc.accel.base import Rays
from raysvc.shading.surface import Surface
from raysvc.tracing.occlusion_kernels import borrow, cosine_rays, tile_mean
from raysvc.tracing.world import World
from raysvc.types import Doubles, Floats, Ints, Longs

TILE = 4
GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0


def pattern(samples: int, seed: int) -> Doubles:
    """(samples, 2) float64 points of the unit square: a rank-1 lattice shifted by the seed."""
    shift = np.random.default_rng(seed).random(2)
    index = np.arange(samples)
    first = ((index + shift[0]) / samples) % 1.0
    return np.stack([first, (index * GOLDEN + shift[1]) % 1.0], axis=1)


def tile_of(pixel: Longs, width: int) -> Ints:
    """(N,) int32 place of pixels in a 4 x 4 tile, 0..15, neighbours far apart (Bayer matrix)."""
    row, col = np.divmod(pixel, width)
    bayer = np.array([[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]], np.int32)
    tile: Ints = bayer[row % TILE, col % TILE]
    return tile


def visibility(
    world: World,
    surface: Surface,
    tile: Ints,
    samples: Doubles,
    radius_m: float,
) -> Floats:
    """(N,) float32 in 0..1: cosine-weighted part of the hemisphere free within `radius_m`.

    `tile` (N,) turns the pattern `samples` (K, 2) by so many sixteenths.
    """
    count = len(surface) * len(samples)
    origins = np.empty((count, 3), np.float32)
    directions = np.empty((count, 3), np.float32)
    cosine_rays(
        surface.position,
        surface.geometric_normal,
        surface.normal,
        tile,
        samples,
        origins,
        directions,
    )
    rays = Rays(origins, directions, np.full(count, radius_m, np.float32))
    free = world.transmittance(rays).reshape(len(surface), len(samples))
    mean: Floats = free.mean(axis=1, dtype=np.float32)
    return mean


@dataclass(frozen=True, slots=True, eq=False)
class VisibilityPicture:
    """Ambient visibility by pixel, with what tells one surface from another.

    Attributes
    ----------
    visible
        (H, W) float32, anything where depth is infinite
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

    def smooth(self) -> "VisibilityPicture":
        """Return the picture of means over the 4 x 4 pixels about each that show its surface."""
        mean = np.empty_like(self.visible)
        tile_mean(self.visible, self.depth, self.normal, self.depth_step, mean)
        return replace(self, visible=mean)

    def near(self, pixel: Longs, depth: Floats, normal: Floats) -> Floats:
        """(N,) visibility of points in pixels, from neighbours that show their surface, or -1."""
        borrowed = np.empty(len(pixel), np.float32)
        borrow(
            self.visible,
            self.depth,
            self.normal,
            self.depth_step,
            pixel,
            depth,
            normal,
            borrowed,
        )
        return borrowed
