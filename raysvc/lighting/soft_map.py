"""An environment softened once, for many lookups that each stand for a wide cone."""

import math

import numpy as np

from raysvc.lighting.soft_map_kernels import SoftMap, soften_map
from raysvc.lighting.sphere_table import SphereTable

ROWS, COLUMNS = 64, 128
LARGEST = 1.0
"""Steradians to which it is softened at most."""


def soft_map(
    table: SphereTable, solid_angle: float, turn: tuple[float, float], strength: float
) -> SoftMap:
    """Soften a map for lookups of `solid_angle` steradians; `turn` is its yaw's cosine and sine."""
    radiance = np.empty((ROWS, COLUMNS, 3), np.float32)
    soften_map(table.sharp, table.soft, min(solid_angle, LARGEST), strength, radiance)
    radiance.setflags(write=False)
    return SoftMap(radiance, *turn)


def solid_angle_of_rays(count: int) -> float:
    """Steradians around the normal for which each of so many cosine-weighted rays stands."""
    return math.pi / max(count, 1)
