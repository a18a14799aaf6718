"""The mirror lobe of brushed surfaces (KHR_materials_anisotropy), as scalar functions for kernels.

    alpha_t = mix(alpha, 1, strength^2)         alpha_b = alpha
    D = 1 / (pi alpha_t alpha_b (H.T^2 / alpha_t^2 + H.B^2 / alpha_b^2 + H.N^2)^2)
    G: Smith's, with roots |(alpha_t T.X, alpha_b B.X, N.X)|

Burley 2012, "Physically Based Shading at Disney", appendix B; Heitz 2014. Directions are unit, in
axes T, B, N of the surface: T is `Brushed.tangent`. With equal alphas it is the lobe of `brdf`.
"""

import math

from raysvc.geometry.vector_kernels import Vec3, cross, dot, row3, unit_or
from raysvc.jit import inlined
from raysvc.lighting.brdf import MIN_COSINE, ggx_alpha
from raysvc.shading.surface import Surface

Axes = tuple[Vec3, Vec3, Vec3]
"""Tangent, bitangent and normal in the world."""


@inlined
def is_brushed(surface: Surface, i: int) -> bool:
    """Has a point a direction in which it is brushed?"""
    return len(surface.brushed.strength) > 0 and surface.brushed.strength[i] > 0.0


@inlined
def brushed_alphas(surface: Surface, i: int) -> tuple[float, float]:
    """alpha_t, alpha_b of a brushed point."""
    across = ggx_alpha(float(surface.roughness[i]))
    strength = float(surface.brushed.strength[i])
    return across + (1.0 - across) * strength * strength, across


@inlined
def brushed_axes(surface: Surface, i: int) -> Axes:
    """Axes of a brushed point, orthonormal in double precision."""
    normal = unit_or(row3(surface.normal, i), (0.0, 0.0, 1.0))
    bitangent = unit_or(cross(normal, row3(surface.brushed.tangent, i)), (0.0, 0.0, 0.0))
    return cross(bitangent, normal), bitangent, normal


@inlined
def placed_in(axes: Axes, direction: Vec3) -> Vec3:
    """Direction of the world in some axes."""
    return dot(direction, axes[0]), dot(direction, axes[1]), dot(direction, axes[2])


@inlined
def brushed_density(half: Vec3, along: float, across: float) -> float:
    """D of a unit half vector: microfacet normals per steradian and projected area."""
    t, b = half[0] / along, half[1] / across
    square = t * t + b * b + half[2] * half[2]
    return 1.0 / (math.pi * along * across * square * square)


@inlined
def brushed_root(direction: Vec3, along: float, across: float) -> float:
    """Root in Smith's terms, as `brdf.smith_root`."""
    t, b = along * direction[0], across * direction[1]
    return math.sqrt(t * t + b * b + direction[2] * direction[2])


@inlined
def brushed_visibility(view: Vec3, light: Vec3, along: float, across: float) -> float:
    """V: height-correlated masking and shadowing G2, divided by 4 N.L N.V."""
    lit = light[2] * brushed_root(view, along, across)
    return 0.5 / max(lit + view[2] * brushed_root(light, along, across), 1e-12)


@inlined
def brushed_masking(view: Vec3, along: float, across: float) -> float:
    """G1: the share of microfacets that the viewer sees."""
    return 2.0 * view[2] / (view[2] + brushed_root(view, along, across))


@inlined
def brushed_shadowing(view: Vec3, light: Vec3, along: float, across: float) -> float:
    """G2 / G1, as `brdf.shadowing_given_masking`."""
    root_v, root_l = brushed_root(view, along, across), brushed_root(light, along, across)
    return light[2] * (view[2] + root_v) / max(light[2] * root_v + view[2] * root_l, 1e-12)


@inlined
def brushed_reflection(
    surface: Surface, i: int, to_light: Vec3, view: Vec3, spread2: float
) -> float:
    """D V of a brushed point, for unit directions of the world, N.L positive.

    D is that of a disc of half vectors whose squared radius in the plane of slopes is `spread2`: it
    adds to both squared alphas, which is exact in the middle of a round lobe's highlight and keeps
    the lobe's energy.
    """
    axes = brushed_axes(surface, i)
    along, across = brushed_alphas(surface, i)
    v, at = placed_in(axes, view), placed_in(axes, to_light)
    v = (v[0], v[1], max(v[2], MIN_COSINE))
    h = unit_or((v[0] + at[0], v[1] + at[1], v[2] + at[2]), (0.0, 0.0, 1.0))
    wide, narrow = math.sqrt(along * along + spread2), math.sqrt(across * across + spread2)
    return brushed_density(h, wide, narrow) * brushed_visibility(v, at, along, across)


@inlined
def brushed_view(surface: Surface, i: int, axes: Axes) -> Vec3:
    """The viewer's direction in a brushed point's axes, not below them."""
    x, y, z = placed_in(axes, row3(surface.to_viewer, i))
    return unit_or((x, y, max(z, MIN_COSINE)), (0.0, 0.0, 1.0))
