"""Loops over points whose microfacets scatter light more than once."""

from raysvc.jit import kernel
from raysvc.lighting.albedo_kernels import lobe_terms
from raysvc.shading.surface import Surface
from raysvc.types import Doubles, Floats


@kernel
def missing_energies(table: Doubles, surface: Surface, missing: Floats) -> None:
    """Write 1 / (A + B) - 1 to `missing` (N,), 0 where a solid of glass is seen from inside."""
    glass = surface.glass
    for i in range(len(surface.normal)):
        if (
            len(glass.solid) > 0
            and glass.solid[i]
            and not glass.entering[i]
            and surface.transmission[i] > 0.0
        ):
            missing[i] = 0.0
            continue
        nov = (
            surface.normal[i, 0] * surface.to_viewer[i, 0]
            + surface.normal[i, 1] * surface.to_viewer[i, 1]
            + surface.normal[i, 2] * surface.to_viewer[i, 2]
        )
        scale, bias = lobe_terms(table, surface, i, nov)
        missing[i] = 1.0 / (scale + bias) - 1.0
