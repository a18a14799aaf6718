"""Lobes as the talk of 2009 filtered them: boxes of one table of a lat-long map.

The map and its copy beyond the poles, rows reversed and turned by half, make an image that repeats
in both axes; it and its texels' sines are integrated, and a filter is the quotient of both. What is
wrong with that is the shape: towards the poles a rectangle of rows and columns is no disc.
"""

import math

import numpy as np

from raysvc.imaging.sat_orders import integrated, spline_means
from raysvc.types import Doubles, Floats

NESTED = ((0.2, 0.45), (0.35, 0.85), (0.3, 1.25), (0.15, 1.7))
"""Weights and half widths of nested boxes, the latter in units of one box's."""


class LatLongLobes:
    """Tables of a map (H, W, 3) of one order, and lobes cos^exponent out of them."""

    def __init__(self, radiance: Floats, order: int) -> None:
        self._order = order
        self._shape = radiance.shape[:2]
        height, _ = self._shape
        sines = np.sin((np.arange(height) + 0.5) * (math.pi / height))[:, None, None]
        self._light = integrated(self._doubled(radiance * sines), order)
        sines3 = np.ascontiguousarray(np.broadcast_to(sines, radiance.shape))
        self._angle = integrated(self._doubled(sines3), order)

    def _doubled(self, image: Doubles) -> Doubles:
        beyond = np.roll(image[::-1], image.shape[1] // 2, axis=1)
        return np.concatenate([image, beyond])

    def box(self, towards: Doubles, exponent: float) -> Doubles:
        """Mean radiance (N, 3) by one filter of the lobe's variance, 1 / (exponent + 1)."""
        return self._mean(towards, math.sqrt(3.0 / (self._order * (exponent + 1.0))))

    def nested(self, towards: Doubles, exponent: float) -> Doubles:
        """Mean radiance (N, 3) by four boxes inside each other, together of that variance."""
        spread = math.sqrt(sum(weight * half * half for weight, half in NESTED))
        one = math.sqrt(3.0 / (self._order * (exponent + 1.0))) / spread
        total: Doubles = np.sum([w * self._mean(towards, half * one) for w, half in NESTED], axis=0)
        return total

    def _mean(self, towards: Doubles, half_rad: float) -> Doubles:
        height, width = self._shape
        polar = np.arccos(np.clip(towards[:, 1], -1.0, 1.0))
        azimuth = np.arctan2(towards[:, 0], -towards[:, 2])
        half_azimuth = np.minimum(half_rad / np.maximum(np.sin(polar), 1e-6), math.pi)
        filters = np.stack(
            [
                polar * (height / math.pi),
                (azimuth / math.tau + 0.5) * width,
                np.full(len(towards), half_rad * (height / math.pi)),
                half_azimuth * (width / math.tau),
            ],
            axis=1,
        )
        light, angle = (spline_means(t, self._order, filters) for t in (self._light, self._angle))
        mean: Doubles = light / angle
        return mean
