"""glTF's BRDF for paths: its value, a random direction, and that direction's density.

The formula is that of `raysvc.lighting.brdf`. Directions are drawn from a mixture of its two lobes:
reflections at visible normals for the specular one, the cosine for the diffuse one, in proportion
to what either reflects of constant light.

A shading normal tilts the formula's hemisphere below the triangle. What would go there is mirrored
at the triangle, as are mirror and occlusion rays (`raysvc.tracing`): no light is lost and none
leaks through. Where both normals agree nothing is mirrored.
"""

import math

import numpy as np

from raysvc.geometry.basis_kernels import basis
from raysvc.geometry.vector_kernels import Vec3, dot, plus, row3, scaled, unit_or
from raysvc.jit import inlined, kernel
from raysvc.lighting.albedo_kernels import specular_terms
from raysvc.lighting.brdf import (
    MIN_COSINE,
    fresnel_weight,
    ggx_alpha,
    ggx_density,
    masking,
    smith_visibility,
    visible_normal,
)
from raysvc.reference.weight_kernels import mis_weight
from raysvc.shading.surface import Surface
from raysvc.types import Doubles, Floats

RED, GREEN, BLUE = 0.2126, 0.7152, 0.0722
"""Luminance of linear Rec.709."""

Axes = tuple[Vec3, Vec3, Vec3, Vec3]
"""Tangent, bitangent and shading normal in the world; the view in these axes, not below them."""
Lobes = tuple[float, float, float]
"""GGX alpha; share of the specular lobe among drawn directions; Schlick's F0 of the dielectric."""
Answer = tuple[float, float, float, float]
"""RGB of BRDF times cosine, and the density of the direction per steradian."""


@inlined
def axes_of(surface: Surface, n: int) -> Axes:
    """Axes about the shading normal; in double precision, for narrow lobes live on digit seven."""
    normal = row3(surface.normal, n)
    normal = scaled(normal, 1.0 / math.sqrt(dot(normal, normal)))
    tangent, bitangent = basis(normal)
    view = row3(surface.to_viewer, n)
    upright = max(dot(view, normal), MIN_COSINE)
    seen = unit_or((dot(view, tangent), dot(view, bitangent), upright), (0.0, 0.0, 1.0))
    return tangent, bitangent, normal, seen


@inlined
def lobes_of(surface: Surface, n: int, cosine: float, terms: Doubles) -> Lobes:
    """What both lobes need to know; `terms` are those of `albedo.AlbedoTables.specular`."""
    roughness, metal = np.float64(surface.roughness[n]), np.float64(surface.metallic[n])
    base = (
        RED * surface.base_colour[n, 0]
        + GREEN * surface.base_colour[n, 1]
        + BLUE * surface.base_colour[n, 2]
    )
    dielectric = np.float64(surface.dielectric_f0[n])
    scale, bias = specular_terms(terms, cosine, roughness)
    specular = (dielectric * (1.0 - metal) + base * metal) * scale + bias
    diffuse = base * (1.0 - metal) * (1.0 - specular)
    return ggx_alpha(roughness), specular / max(specular + diffuse, 1e-12), dielectric


@inlined
def _local(axes: Axes, direction: Vec3) -> Vec3:
    return dot(direction, axes[0]), dot(direction, axes[1]), dot(direction, axes[2])


@inlined
def answer(surface: Surface, n: int, axes: Axes, lobes: Lobes, light: Vec3) -> Answer:
    """BRDF times cosine towards a unit direction of the world, and that direction's density.

    Nothing for directions below the triangle.
    """
    red, green, blue, density = 0.0, 0.0, 0.0, 0.0
    across = row3(surface.geometric_normal, n)
    above = dot(across, light)
    if above <= 0.0:
        return red, green, blue, density
    alpha, share, dielectric = lobes
    view = axes[3]
    metal = np.float64(surface.metallic[n])
    for mirrored in range(2):
        # The direction itself, and the one below the triangle that is mirrored to it
        towards = light if mirrored == 0 else plus(light, across, -2.0 * above)
        x, y, z = _local(axes, towards)
        if z <= 0.0:
            continue
        hx, hy, hz = x + view[0], y + view[1], z + view[2]
        h2 = max(hx * hx + hy * hy + hz * hz, 1e-18)
        voh = min((hx * view[0] + hy * view[1] + hz * view[2]) / math.sqrt(h2), 1.0)
        weight = fresnel_weight(voh)
        normals = ggx_density((hx * hx + hy * hy) / h2, alpha)
        lobe = normals * smith_visibility(z, view[2], alpha) * z
        for c in range(3):
            base = np.float64(surface.base_colour[n, c])
            f0 = dielectric * (1.0 - metal) + base * metal
            fresnel = f0 + (1.0 - f0) * weight
            value = (1.0 - fresnel) * base * (1.0 - metal) * z / math.pi + fresnel * lobe
            red += value if c == 0 else 0.0
            green += value if c == 1 else 0.0
            blue += value if c == 2 else 0.0
        density += share * masking(view[2], alpha) * normals / (4.0 * view[2])
        density += (1.0 - share) * z / math.pi
    return red, green, blue, density


@inlined
def drawn(
    surface: Surface, n: int, axes: Axes, lobes: Lobes, pick: float, u: float, v: float
) -> Vec3:
    """Unit direction of the world, above the triangle; zero where the formula sends nothing."""
    alpha, share, _ = lobes
    view = axes[3]
    turn = 2.0 * math.pi * v
    cos_turn, sin_turn = math.cos(turn), math.sin(turn)
    if pick < share:
        h = visible_normal(view, alpha, cos_turn, sin_turn, u)
        twice = 2.0 * dot(view, h)
        x, y, z = twice * h[0] - view[0], twice * h[1] - view[1], twice * h[2] - view[2]
        if z <= 0.0:
            return 0.0, 0.0, 0.0
    else:
        radius = math.sqrt(u)
        x, y, z = radius * cos_turn, radius * sin_turn, math.sqrt(1.0 - u)
    direction = plus(plus(scaled(axes[0], x), axes[1], y), axes[2], z)
    across = row3(surface.geometric_normal, n)
    above = dot(across, direction)
    if above < 0.0:
        direction = plus(direction, across, -2.0 * above)
    return unit_or(direction, (0.0, 0.0, 0.0))


@kernel
def reflect_samples(
    terms: Doubles,
    surface: Surface,
    to_light: Floats,
    radiance: Floats,
    density: Doubles,
    throughput: Floats,
    contribution: Floats,
) -> None:
    """Write what paths gain from light that comes to their ends, if nothing is in its way.

    Parameters
    ----------
    surface, throughput
        N points, and what part of their light (N, 3) the pixel sees
    to_light, radiance, density
        unit directions (N, 3); radiance over the density with which each was drawn (N, 3), and that
        density per steradian (N,); inf for a light without size, which is not found in another way
    contribution
        (N, 3) throughput times BRDF, cosine and radiance, weighted against finding the same light
        by `scatter`
    """
    for n in range(len(surface.normal)):
        contribution[n, 0] = 0.0
        contribution[n, 1] = 0.0
        contribution[n, 2] = 0.0
        if radiance[n, 0] == 0.0 and radiance[n, 1] == 0.0 and radiance[n, 2] == 0.0:
            continue
        axes = axes_of(surface, n)
        lobes = lobes_of(surface, n, axes[3][2], terms)
        red, green, blue, found = answer(surface, n, axes, lobes, row3(to_light, n))
        weight = mis_weight(density[n], found)
        contribution[n, 0] = throughput[n, 0] * radiance[n, 0] * red * weight
        contribution[n, 1] = throughput[n, 1] * radiance[n, 1] * green * weight
        contribution[n, 2] = throughput[n, 2] * radiance[n, 2] * blue * weight


@kernel
def scatter(
    terms: Doubles,
    surface: Surface,
    place: Doubles,
    pick: Doubles,
    directions: Floats,
    throughput: Floats,
    density: Doubles,
) -> None:
    """Send paths on from N points.

    Parameters
    ----------
    place, pick
        (N, 2) and (N,) random numbers in 0..1
    directions, density
        filled: unit directions (N, 3), and their densities per steradian (N,); 0 where a path ends
    throughput
        (N, 3), multiplied by BRDF times cosine over the density
    """
    for n in range(len(surface.normal)):
        axes = axes_of(surface, n)
        lobes = lobes_of(surface, n, axes[3][2], terms)
        direction = drawn(surface, n, axes, lobes, pick[n], place[n, 0], place[n, 1])
        red, green, blue, found = answer(surface, n, axes, lobes, direction)
        density[n] = found
        share = 1.0 / found if found > 0.0 else 0.0
        throughput[n, 0] *= red * share
        throughput[n, 1] *= green * share
        throughput[n, 2] *= blue * share
        for k in range(3):
            directions[n, k] = direction[k]
