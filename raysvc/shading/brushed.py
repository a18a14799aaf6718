"""In which direction N points are brushed (KHR_materials_anisotropy)."""

from typing import NamedTuple

import numpy as np

from raysvc.types import Floats


class Brushed(NamedTuple):
    """Has a meaning where `strength` is not 0; see `Surface.brushed`.

    Attributes
    ----------
    strength
        (N,) float32 0..1: along the tangent GGX's alpha is mix(alpha, 1, strength^2), across it
        alpha, the surface's own
    tangent
        (N, 3) float32 unit, at right angles to `Surface.normal`: along which microfacets differ
        most and highlights are long, which is across the scratches
    """

    strength: Floats
    tangent: Floats

    @property
    def size(self) -> int:
        """Number of points."""
        return len(self.strength)

    @staticmethod
    def empty(count: int) -> "Brushed":
        """Return room for points, to be filled."""
        return Brushed(np.empty(count, np.float32), np.empty((count, 3), np.float32))
