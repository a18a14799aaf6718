"""What microfacets of N points scatter more than once (`raysvc.lighting.rescattering`)."""

from typing import NamedTuple

import numpy as np

from raysvc.types import Floats


class Rescattering(NamedTuple):
    """Of all points where multiple scattering is wanted, else of none; see `Surface.rescattering`.

    Attributes
    ----------
    missing
        (N,) float32, 1 / E - 1: how much light a white lobe scatters once too little, as a part of
        what it does scatter
    """

    missing: Floats

    @property
    def size(self) -> int:
        """Number of points."""
        return len(self.missing)

    @staticmethod
    def empty(count: int) -> "Rescattering":
        """Return room for points, to be filled."""
        return Rescattering(np.empty(count, np.float32))
