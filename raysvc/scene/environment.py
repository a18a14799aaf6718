"""Light from everywhere else."""

from dataclasses import dataclass

import numpy as np

from raysvc.errors import InvalidEnvironment
from raysvc.types import Floats


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Environment:
    """Radiance from every direction, as a lat-long map.

    Row 0 looks up (+Y), the last row down; the centre column is what is seen looking along -Z, and
    +X is to its right. `radiance` is (H, W, 3) float32, linear Rec.709, finite and not negative, H
    and W >= 1.
    """

    radiance: Floats
    name: str = ""
    warnings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        shape = self.radiance.shape
        if len(shape) != 3 or shape[2] != 3 or 0 in shape or self.radiance.dtype != np.float32:
            raise InvalidEnvironment("needs (H, W, 3) float32 pixels", field="environment")
        if not np.isfinite(self.radiance).all() or self.radiance.min() < 0:
            raise InvalidEnvironment("has NaN, infinite or negative pixels", field="environment")
        self.radiance.setflags(write=False)
