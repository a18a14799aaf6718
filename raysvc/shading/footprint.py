"""What pixels cover of the surfaces that they show."""

from typing import NamedTuple

import numpy as np

from raysvc.types import Floats


class Footprint(NamedTuple):
    """What pixels cover at N points: a parallelogram on the triangle's plane, and a blur.

    The parallelogram is where the pixel's ray goes when the pixel moves (Igehy 1999, "Tracing Ray
    Differentials"). The blur is what rough mirrors on the way have added: a cone about the ray
    (Amanatides 1984, "Ray Tracing with Cones"), a disc of which is seen. Textures are filtered over
    both, their variances added. A tuple of arrays, so that kernels take it whole.

    Attributes
    ----------
    dpdx, dpdy
        (N, 3) float32 metres that the point moves on the plane of its triangle, for a step of one
        pixel to the right, and down
    blur
        (N,) float32 metres, radius of the disc across the ray
    """

    dpdx: Floats
    dpdy: Floats
    blur: Floats

    @staticmethod
    def empty(count: int) -> "Footprint":
        """Return room for footprints, to be filled."""
        return Footprint(
            np.empty((count, 3), np.float32),
            np.empty((count, 3), np.float32),
            np.empty(count, np.float32),
        )

    @staticmethod
    def points(count: int) -> "Footprint":
        """Return footprints without extent, for which textures are read at a point."""
        return Footprint(
            np.zeros((count, 3), np.float32),
            np.zeros((count, 3), np.float32),
            np.zeros(count, np.float32),
        )
