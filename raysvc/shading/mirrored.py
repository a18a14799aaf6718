"""What pixels see mirrored at N points."""

from typing import NamedTuple

import numpy as np

from raysvc.types import Floats


class Mirrored(NamedTuple):
    """Of all points of a picture, else of none; see `Surface.mirrored`.

    Attributes
    ----------
    pixel_sr
        (N,) float32 steradians of what is far away that a pixel sees mirrored: few where the
        surface is near and flat, many where it is far or curved; 0 where it is rough anyway
    """

    pixel_sr: Floats

    @property
    def size(self) -> int:
        """Number of points."""
        return len(self.pixel_sr)

    @staticmethod
    def empty(count: int) -> "Mirrored":
        """Return room for points, to be filled."""
        return Mirrored(np.empty(count, np.float32))
