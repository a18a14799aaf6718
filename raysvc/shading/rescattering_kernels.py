"""The factor of specular lobes whose microfacets scatter light more than once."""

from raysvc.jit import inlined
from raysvc.shading.surface import Surface


@inlined
def rescattered(surface: Surface, i: int, f0: float) -> float:
    """How many times as much a specular lobe of reflectance F0 returns: 1 where it is not asked."""
    if len(surface.rescattering.missing) == 0:
        return 1.0
    return 1.0 + f0 * float(surface.rescattering.missing[i])
