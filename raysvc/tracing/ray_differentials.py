"""How rays change from a pixel to the next, as arrays."""

from typing import NamedTuple

import numpy as np

from raysvc.types import Floats


class RayDifferentials(NamedTuple):
    """How R rays change from a pixel to the next, and how wide the cone about each is.

    No component is greater than 1e8, none infinite or NaN. A tuple of arrays, so that kernels take
    it whole.

    Attributes
    ----------
    origin_dx, origin_dy
        (R, 3) float32 metres that the origin moves for a step of one pixel to the right, and down
    direction_dx, direction_dy
        (R, 3) float32, what the unit direction changes by
    blur
        (R,) float32 metres, radius of the cone at the origin
    widening
        (R,) float32 metres that the radius grows per metre: the tangent of half the cone's angle
    """

    origin_dx: Floats
    origin_dy: Floats
    direction_dx: Floats
    direction_dy: Floats
    blur: Floats
    widening: Floats

    @staticmethod
    def empty(count: int) -> "RayDifferentials":
        """Return room for differentials, to be filled."""
        return RayDifferentials(
            *(np.empty((count, 3), np.float32) for _ in range(4)),
            *(np.empty(count, np.float32) for _ in range(2)),
        )
