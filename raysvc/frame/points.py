"""The points that pixels show, from the camera's point of view."""

from dataclasses import dataclass

import numpy as np

from raysvc.shading.surface import Surface
from raysvc.types import Floats, Ints, Longs


@dataclass(frozen=True, slots=True, eq=False)
class Points:
    """N points of surfaces, those of one pixel next to each other and in order of distance."""

    pixel: Longs
    """(N,) int64 row * width + col."""
    triangle: Ints
    """(N,) int32."""
    depth: Floats
    """(N,) float32 metres along the view axis."""
    footprint: Floats
    """(N,) float32 metres: width across the ray of what a pixel sees there."""
    surface: Surface


def front(points: Points, pixels: int) -> Longs:
    """(pixels,) int64: which of the N points stands for each pixel in its layers, -1 where there
    is none.

    The first that covers at least half of what is behind it, else the last.
    """
    chosen = np.full(pixels, -1, np.int64)
    order = np.arange(len(points.pixel))
    # Later assignments win: first whatever is last, then, from back to front, what covers enough.
    chosen[points.pixel] = order
    solid = order[points.surface.alpha >= 0.5][::-1]
    chosen[points.pixel[solid]] = solid
    return chosen
