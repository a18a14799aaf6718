"""The clear varnish on N points (KHR_materials_clearcoat)."""

from typing import NamedTuple

import numpy as np

from raysvc.types import Floats


class Coat(NamedTuple):
    """Varnish with its material evaluated; see `Surface.coat`.

    Attributes
    ----------
    clearcoat
        (N,) float32 0..1: how much varnish there is
    roughness
        (N,) float32 0..1; GGX alpha is roughness squared
    normal
        (N, 3) float32 unit, on the viewer's side; without the bumps of what is underneath
    """

    clearcoat: Floats
    roughness: Floats
    normal: Floats

    @property
    def size(self) -> int:
        """Number of points."""
        return len(self.clearcoat)

    @staticmethod
    def empty(count: int) -> "Coat":
        """Return room for points, to be filled."""
        return Coat(
            clearcoat=np.empty(count, np.float32),
            roughness=np.empty(count, np.float32),
            normal=np.empty((count, 3), np.float32),
        )
