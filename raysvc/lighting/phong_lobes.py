"""Phong's lobes, powers of the cosine (Phong 1975): round and without tails."""

from functools import lru_cache, partial

import numpy as np

from raysvc.lighting.lobe_levels import DEGREE, LobeFamily
from raysvc.lighting.phong_kernels import NARROWEST
from raysvc.lighting.zonal import zonal_coefficients
from raysvc.types import Doubles

SIDES = (240, 192, 144, 112, 80, 64, 48, 48, 48, 48, 48)


@lru_cache(maxsize=1)
def phong_lobes() -> LobeFamily:
    """Lobes of exponent 1024 to 1."""
    exponents = NARROWEST * 0.5 ** np.arange(len(SIDES))
    zonal = [zonal_coefficients(partial(power, exponent=n), DEGREE) for n in exponents]
    return LobeFamily(tuple(zonal), SIDES)


def power(cosine: Doubles, exponent: float) -> Doubles:
    """The lobe, not normalised."""
    lobe: Doubles = np.maximum(cosine, 0.0) ** exponent
    return lobe
