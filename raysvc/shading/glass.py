"""What rays that go through N points need to know (KHR_materials_transmission, _volume, _ior)."""

from typing import NamedTuple

import numpy as np

from raysvc.types import Bools, Floats


class Glass(NamedTuple):
    """Has a meaning where `Surface.transmission` is not 0; see `Surface.glass`.

    Outside of every solid the index of refraction is 1: solids inside of one another are taken as
    if air were between them.

    Attributes
    ----------
    solid
        (N,) bool: the triangle bounds a volume, at which rays are refracted; else it is a sheet
        without thickness, through which they go straight
    entering
        (N,) bool: the viewer is on the front of the triangle, hence outside of the solid
    ior
        (N,) float32 index of refraction of the solid, at least LEAST_IOR
    absorption
        (N, 3) float32 of the solid, per metre: of what goes a distance d inside, exp(-absorption d)
        is left
    """

    solid: Bools
    entering: Bools
    ior: Floats
    absorption: Floats

    @property
    def size(self) -> int:
        """Number of points."""
        return len(self.solid)

    @property
    def eta(self) -> Floats:
        """(N,) float32 index on the viewer's side of a solid's boundary over that behind it."""
        eta: Floats = np.where(self.entering, np.float32(1.0) / self.ior, self.ior)
        return eta

    @staticmethod
    def empty(count: int) -> "Glass":
        """Return room for points, to be filled."""
        return Glass(
            solid=np.empty(count, np.bool_),
            entering=np.empty(count, np.bool_),
            ior=np.empty(count, np.float32),
            absorption=np.empty((count, 3), np.float32),
        )
