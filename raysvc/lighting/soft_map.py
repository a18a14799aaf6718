"""An environment softened once, for many lookups that each stand for a wide cone."""

import math

import numpy as np

from raysvc.lighting.soft_map_kernels import SoftMap
from raysvc.lighting.zonal import ZonalMap, zonal_coefficients

ROWS, COLUMNS = 64, 128
DEGREE = 40
"""Of what can be left after softening by LEAST."""
LEAST, LARGEST = 0.05, math.pi
"""Steradians to which it is softened at least and at most."""


def soft_map(
    harmonics: ZonalMap, solid_angle: float, turn: tuple[float, float], strength: float
) -> SoftMap:
    """Soften a map for lookups of `solid_angle` steradians; `turn` is its yaw's cosine and sine.

    The kernel is that of von Mises and Fisher with the mean cosine of a cap of the solid angle.
    """
    sharpness = 4.0 * math.pi / min(max(solid_angle, LEAST), LARGEST)
    zonal = zonal_coefficients(lambda cosine: np.exp(sharpness * (cosine - 1.0)), DEGREE)
    softened = np.maximum(harmonics.filtered(zonal[None], ROWS, COLUMNS)[0], 0.0) * strength
    radiance = softened.astype(np.float32)
    radiance.setflags(write=False)
    return SoftMap(radiance, *turn)


def solid_angle_of_rays(count: int) -> float:
    """Steradians around the normal for which each of so many cosine-weighted rays stands."""
    return math.pi / max(count, 1)
