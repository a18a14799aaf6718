"""The points that pixels show, from the camera's point of view."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from raysvc import records
from raysvc.scene import Camera
from raysvc.shading.footprint import Footprint
from raysvc.shading.surface import Surface
from raysvc.tracing.differentials import primary_differentials
from raysvc.tracing.ray_differentials import RayDifferentials
from raysvc.types import Floats, Ints, Longs


class Seen(NamedTuple):
    """N points as the rays that show them know them."""

    surface: Surface
    triangle: Ints
    """(N,) int32."""
    footprint: Footprint
    """What pixels cover there."""
    arriving: RayDifferentials
    """Of the rays."""


@dataclass(frozen=True, slots=True, eq=False)
class Points:
    """N points of surfaces, those of one pixel next to each other and in order of distance."""

    pixel: Longs
    """(N,) int64 row * width + col."""
    triangle: Ints
    """(N,) int32."""
    depth: Floats
    """(N,) float32 metres along the view axis."""
    footprint: Footprint
    """Of N points: what their pixels cover there."""
    surface: Surface

    def chosen(self, index: Longs) -> "Points":
        """Return some of the points by number."""
        return Points(
            self.pixel[index],
            self.triangle[index],
            self.depth[index],
            records.chosen(self.footprint, index),
            self.surface.chosen(index),
        )

    def seen(self, camera: Camera, begin: int, end: int, pixels_per_step: float = 1.0) -> Seen:
        """Return points begin..end with differentials of the camera's rays to them."""
        surface = self.surface.rows(begin, end)
        return Seen(
            surface,
            self.triangle[begin:end],
            records.rows(self.footprint, begin, end),
            primary_differentials(camera, -surface.to_viewer, pixels_per_step),
        )


def front(pixel: Longs, alpha: Floats, pixels: int) -> Longs:
    """(pixels,) int64: which of N points stands for each pixel in its layers, -1 where there is
    none.

    The first that covers at least half of what is behind it, else the last. Points in pixels (N,)
    are in order of distance within each, and cover alpha (N,).
    """
    chosen = np.full(pixels, -1, np.int64)
    order = np.arange(len(pixel))
    # Later assignments win: first whatever is last, then, from back to front, what covers enough.
    chosen[pixel] = order
    solid = order[alpha >= 0.5][::-1]
    chosen[pixel[solid]] = solid
    return chosen
