"""Values, densities and samples of the brushed lobe, as `microfacet_reflection` has them of the
round one.

Directions are unit, in the axes of `brushed_lobe`.
"""

from raysvc.geometry.vector_kernels import Vec3, dot, scaled, unit_or
from raysvc.jit import inlined
from raysvc.lighting.brdf import MIN_COSINE, stretched_visible_normal
from raysvc.lighting.brushed_lobe import (
    brushed_density,
    brushed_masking,
    brushed_shadowing,
    brushed_visibility,
)


@inlined
def brushed_reflection_lobe(
    view: Vec3, light: Vec3, along: float, across: float
) -> tuple[float, float, float]:
    """The lobe, its density when visible normals are sampled (both per steradian), and V.H.

    0, 0, 1 unless both directions are above the surface.
    """
    if light[2] <= 0.0 or view[2] <= 0.0:
        return 0.0, 0.0, 1.0
    seen = (view[0], view[1], max(view[2], MIN_COSINE))
    half = _half(seen, light)
    density = brushed_density(half, along, across)
    lobe = brushed_visibility(seen, light, along, across) * density
    drawn_as = brushed_masking(seen, along, across) * density / (4.0 * seen[2])
    return lobe, drawn_as, dot(seen, half)


@inlined
def brushed_reflection_density(view: Vec3, light: Vec3, along: float, across: float) -> float:
    """Of `brushed_reflection_lobe` the density alone, of directions that are above the surface."""
    seen = (view[0], view[1], max(view[2], MIN_COSINE))
    density = brushed_density(_half(seen, light), along, across)
    return brushed_masking(seen, along, across) * density / (4.0 * seen[2])


@inlined
def _half(view: Vec3, light: Vec3) -> Vec3:
    return unit_or((view[0] + light[0], view[1] + light[1], view[2] + light[2]), (0.0, 0.0, 1.0))


@inlined
def brushed_reflection_sample(
    view: Vec3, along: float, across: float, cos_turn: float, sin_turn: float, u: float
) -> tuple[Vec3, float, float]:
    """Direction of light out of the lobe, N.L f / pdf, and V.H; see `brdf.visible_normal`.

    The weight is 0 where the direction is below the surface.
    """
    seen = (view[0], view[1], max(view[2], MIN_COSINE))
    half = stretched_visible_normal(seen, along, across, cos_turn, sin_turn, u)
    voh = dot(seen, half)
    mirrored = scaled(half, 2.0 * voh)
    light = (mirrored[0] - seen[0], mirrored[1] - seen[1], mirrored[2] - seen[2])
    weight = brushed_shadowing(seen, light, along, across) if light[2] > 0.0 else 0.0
    return light, weight, voh
