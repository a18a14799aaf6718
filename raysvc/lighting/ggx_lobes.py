"""Round lobes whose sums are GGX lobes: GGX seen from straight above, and rougher than rough."""

from functools import lru_cache, partial

import numpy as np

from raysvc.lighting.image_kernels import COSINE, FINEST_ALPHA
from raysvc.lighting.lobe_levels import DEGREE, LobeFamily
from raysvc.lighting.zonal import zonal_coefficients
from raysvc.types import Doubles

BEYOND_COSINE = (0.5, 0.12)
"""N.V for which the last levels are the lobe of alpha 1 without its Fresnel term."""
SIDES = (208, 160, 128, 96, 72, 56, 48, 48, 48, 48, 48, 48, 48)


@lru_cache(maxsize=1)
def ggx_lobes() -> LobeFamily:
    """Lobes of alpha 1/32 to 1, then almost hemispheres."""
    alphas = FINEST_ALPHA * 2.0 ** (0.5 * np.arange(COSINE + 1))
    zonal = [zonal_coefficients(partial(from_above, alpha=a), DEGREE) for a in alphas]
    zonal += [zonal_coefficients(partial(roughest, nov=n), DEGREE) for n in BEYOND_COSINE]
    return LobeFamily(tuple(zonal), SIDES)


def cosine_lobe() -> Doubles:
    """Coefficients of the lobe of diffuse light."""
    return ggx_lobes().zonal[COSINE]


def from_above(cosine: Doubles, alpha: float) -> Doubles:
    """GGX's D of the half vector times N.L, without masking."""
    half2 = 0.5 + 0.5 * cosine
    lobe: Doubles = np.maximum(cosine, 0.0) / (half2 * (alpha * alpha - 1.0) + 1.0) ** 2
    return lobe


def roughest(cosine: Doubles, nov: float) -> Doubles:
    """Lobe of alpha 1 about N: D is constant, V is 1 / (2 (N.L + N.V))."""
    above = np.maximum(cosine, 0.0)
    lobe: Doubles = above / (above + nov)
    return lobe
