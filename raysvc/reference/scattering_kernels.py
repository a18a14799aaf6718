"""glTF's materials for paths: their value, a random direction, and that direction's density.

The formulas are those of `raysvc.lighting`: brdf, microfacet_reflection, microfacet_refraction,
thin_transmission, clearcoat. A direction is drawn from one of the lobes, by the odds of
`choice_kernels`: reflections and refractions at visible normals, or the cosine.

A shading normal tilts the formula's hemispheres against the triangle. What would be reflected below
the triangle, or go through to above it, is mirrored at the triangle, as are mirror and occlusion
rays (`raysvc.tracing`): no light is lost, and none leaks. Where both normals agree nothing is.
"""

import math

import numpy as np

from raysvc.geometry.basis_kernels import basis
from raysvc.geometry.vector_kernels import Vec3, dot, plus, row3, scaled, unit_or
from raysvc.jit import inlined, kernel
from raysvc.lighting.brdf import MIN_COSINE, ggx_alpha
from raysvc.lighting.brushed_lobe import brushed_alphas, brushed_axes, is_brushed
from raysvc.lighting.brushed_reflection import brushed_reflection_lobe, brushed_reflection_sample
from raysvc.lighting.microfacet_reflection import reflection_lobe, reflection_sample
from raysvc.lighting.microfacet_refraction import (
    boundary_fresnel_weight,
    refraction_lobe,
    refraction_sample,
)
from raysvc.lighting.thin_transmission import thin_lobe, thin_sample
from raysvc.reference.choice_kernels import COAT, DIFFUSE, MIRROR, THROUGH, coat_of
from raysvc.reference.weight_kernels import mis_weight
from raysvc.shading.rescattering_kernels import rescattered
from raysvc.shading.surface import Surface
from raysvc.types import Doubles, Floats

Axes = tuple[Vec3, Vec3, Vec3]
"""Tangent, bitangent and normal in the world."""
Answer = tuple[float, float, float, float]
"""RGB of BRDF or BTDF times cosine, and the density of the direction per steradian."""


@inlined
def axes_of(normals: Floats, n: int) -> Axes:
    """Axes about a normal; in double precision, for narrow lobes live on the seventh digit."""
    normal = row3(normals, n)
    normal = scaled(normal, 1.0 / math.sqrt(dot(normal, normal)))
    tangent, bitangent = basis(normal)
    return tangent, bitangent, normal


@inlined
def axes_under_coat(surface: Surface, n: int) -> Axes:
    """Axes of the surface itself: those in which it is brushed, if it is."""
    if is_brushed(surface, n):
        return brushed_axes(surface, n)
    return axes_of(surface.normal, n)


@inlined
def local(axes: Axes, direction: Vec3) -> Vec3:
    """Direction of the world in some axes."""
    return dot(direction, axes[0]), dot(direction, axes[1]), dot(direction, axes[2])


@inlined
def view_in(axes: Axes, surface: Surface, n: int) -> Vec3:
    """The viewer's direction in some axes, not below them."""
    x, y, z = local(axes, row3(surface.to_viewer, n))
    return unit_or((x, y, max(z, MIN_COSINE)), (0.0, 0.0, 1.0))


@inlined
def eta_of(surface: Surface, n: int) -> float:
    """Index on the viewer's side over that behind the boundary of a solid; 1 if there is none."""
    if len(surface.glass.solid) == 0 or not surface.glass.solid[n] or surface.transmission[n] == 0:
        return 1.0
    ior = np.float64(surface.glass.ior[n])
    return 1.0 / ior if surface.glass.entering[n] else ior


@inlined
def answer(surface: Surface, choice: Doubles, n: int, light: Vec3) -> Answer:
    """Value and density of a material for light from a unit direction of the world."""
    red, green, blue, density = 0.0, 0.0, 0.0, 0.0
    across = row3(surface.geometric_normal, n)
    above = dot(across, light)
    if above == 0.0 or (above < 0.0 and choice[n, THROUGH] == 0.0):
        return red, green, blue, density
    axes = axes_under_coat(surface, n)
    view = view_in(axes, surface, n)
    alpha = ggx_alpha(np.float64(surface.roughness[n]))
    eta = eta_of(surface, n)
    coat = coat_of(surface, n)
    metal = np.float64(surface.metallic[n])
    dielectric = np.float64(surface.dielectric_f0[n]) * (1.0 - metal)
    through = np.float64(surface.transmission[n])
    for mirrored in range(2):
        # The direction itself, and the one across the triangle that is mirrored to it
        towards = light if mirrored == 0 else plus(light, across, -2.0 * above)
        at = local(axes, towards)
        if above > 0.0 and coat > 0.0:
            coat_axes = axes_of(surface.coat.normal, n)
            coat_view, place = view_in(coat_axes, surface, n), local(coat_axes, towards)
            coat_alpha = ggx_alpha(np.float64(surface.coat.roughness[n]))
            lobe, drawn_as, _ = reflection_lobe(coat_view, place, coat_alpha)
            value = coat * lobe * place[2]
            red, green, blue = red + value, green + value, blue + value
            density += choice[n, COAT] * drawn_as
        if (above > 0.0) != (at[2] > 0.0):
            continue
        lobe, drawn_as, voh = 0.0, 0.0, 1.0
        diffuse, cosine = 0.0, abs(at[2])
        if above > 0.0:
            if is_brushed(surface, n):
                along, narrow = brushed_alphas(surface, n)
                lobe, drawn_as, voh = brushed_reflection_lobe(view, at, along, narrow)
            else:
                lobe, drawn_as, voh = reflection_lobe(view, at, alpha)
            diffuse = (1.0 - metal) * (1.0 - through) / math.pi
            density += choice[n, MIRROR] * drawn_as + choice[n, DIFFUSE] * cosine / math.pi
        else:
            if eta == 1.0:
                lobe, drawn_as, voh = thin_lobe(view, at, alpha)
            else:
                lobe, drawn_as, voh = refraction_lobe(view, at, eta, alpha)
            density += choice[n, THROUGH] * drawn_as
        weight = boundary_fresnel_weight(voh, eta)
        for c in range(3):
            base = np.float64(surface.base_colour[n, c])
            f0 = dielectric + base * metal
            fresnel = f0 + (1.0 - f0) * weight
            if above > 0.0:
                gain = rescattered(surface, n, f0)
                value = (1.0 - fresnel) * base * diffuse + fresnel * lobe * gain
            else:
                value = (1.0 - fresnel) * base * (1.0 - metal) * through * lobe
            value *= cosine * (1.0 - coat)
            red += value if c == 0 else 0.0
            green += value if c == 1 else 0.0
            blue += value if c == 2 else 0.0
    return red, green, blue, density


@inlined
def drawn(surface: Surface, choice: Doubles, n: int, pick: float, u: float, v: float) -> Vec3:
    """Unit direction of the world out of a lobe; zero where the formula sends nothing."""
    turn = 2.0 * math.pi * v
    cos_turn, sin_turn = math.cos(turn), math.sin(turn)
    goes_through = False
    if pick < choice[n, COAT]:
        axes = axes_of(surface.coat.normal, n)
        alpha = ggx_alpha(np.float64(surface.coat.roughness[n]))
        view = view_in(axes, surface, n)
        at, weight, _ = reflection_sample(view, alpha, cos_turn, sin_turn, u)
    else:
        axes = axes_under_coat(surface, n)
        alpha = ggx_alpha(np.float64(surface.roughness[n]))
        view = view_in(axes, surface, n)
        pick -= choice[n, COAT]
        if pick < choice[n, MIRROR] and is_brushed(surface, n):
            along, narrow = brushed_alphas(surface, n)
            at, weight, _ = brushed_reflection_sample(view, along, narrow, cos_turn, sin_turn, u)
        elif pick < choice[n, MIRROR]:
            at, weight, _ = reflection_sample(view, alpha, cos_turn, sin_turn, u)
        elif pick < choice[n, MIRROR] + choice[n, DIFFUSE]:
            radius = math.sqrt(u)
            at, weight = (radius * cos_turn, radius * sin_turn, math.sqrt(1.0 - u)), 1.0
        else:
            goes_through = True
            eta = eta_of(surface, n)
            if eta == 1.0:
                at, weight, _ = thin_sample(view, alpha, cos_turn, sin_turn, u)
            else:
                at, weight, _ = refraction_sample(view, eta, alpha, cos_turn, sin_turn, u)
    if weight == 0.0:
        return 0.0, 0.0, 0.0
    direction = plus(plus(scaled(axes[0], at[0]), axes[1], at[1]), axes[2], at[2])
    across = row3(surface.geometric_normal, n)
    above = dot(across, direction)
    if (above < 0.0) != goes_through:
        direction = plus(direction, across, -2.0 * above)
    return unit_or(direction, (0.0, 0.0, 0.0))


@kernel
def reflect_samples(
    surface: Surface,
    choice: Doubles,
    to_light: Floats,
    radiance: Floats,
    density: Doubles,
    throughput: Floats,
    contribution: Floats,
) -> None:
    """Write what paths gain from light that comes to their ends, if nothing is in its way.

    Parameters
    ----------
    surface, choice, throughput
        N points, the odds of their lobes, and what part of their light (N, 3) the pixel sees
    to_light, radiance, density
        unit directions (N, 3); radiance over the density with which each was drawn (N, 3), and that
        density per steradian (N,); inf for a light without size, which is not found in another way
    contribution
        (N, 3) throughput times BRDF or BTDF, cosine and radiance, weighted against finding the same
        light by `scatter`
    """
    for n in range(len(surface.normal)):
        red, green, blue, found = 0.0, 0.0, 0.0, 0.0
        if radiance[n, 0] > 0.0 or radiance[n, 1] > 0.0 or radiance[n, 2] > 0.0:
            red, green, blue, found = answer(surface, choice, n, row3(to_light, n))
        weight = mis_weight(density[n], found)
        contribution[n, 0] = throughput[n, 0] * radiance[n, 0] * red * weight
        contribution[n, 1] = throughput[n, 1] * radiance[n, 1] * green * weight
        contribution[n, 2] = throughput[n, 2] * radiance[n, 2] * blue * weight


@kernel
def scatter(
    surface: Surface,
    choice: Doubles,
    place: Doubles,
    pick: Doubles,
    directions: Floats,
    throughput: Floats,
    density: Doubles,
) -> None:
    """Send paths on from N points.

    Parameters
    ----------
    surface, choice
        N points, and the odds of their lobes
    place, pick
        (N, 2) and (N,) random numbers in 0..1
    directions, density
        filled: unit directions (N, 3), and their densities per steradian (N,); 0 where a path ends
    throughput
        (N, 3), multiplied by BRDF or BTDF times cosine over the density
    """
    for n in range(len(surface.normal)):
        direction = drawn(surface, choice, n, pick[n], place[n, 0], place[n, 1])
        red, green, blue, found = answer(surface, choice, n, direction)
        density[n] = found
        share = 1.0 / found if found > 0.0 else 0.0
        throughput[n, 0] *= red * share
        throughput[n, 1] *= green * share
        throughput[n, 2] *= blue * share
        for k in range(3):
            directions[n, k] = direction[k]
