"""Integrals of the lobes of a solid's boundary under constant light."""

import math

from raysvc.geometry.refraction import transmitted_cosine
from raysvc.jit import inlined, kernel
from raysvc.lighting.albedo_kernels import GOLDEN, specular_terms
from raysvc.lighting.brdf import MIN_COSINE, ggx_alpha
from raysvc.lighting.microfacet_reflection import reflection_sample
from raysvc.lighting.microfacet_refraction import boundary_fresnel_weight, refraction_sample
from raysvc.shading.material_table import LEAST_IOR
from raysvc.shading.surface import Surface
from raysvc.types import Doubles, Floats

DENSEST = 4.0
"""Index up to which there are tables; that of germanium."""


@inlined
def critical_cosine(ior: float) -> float:
    """Cosine inside a solid at and below which everything is reflected."""
    return math.sqrt(max(1.0 - 1.0 / (ior * ior), 0.0))


@inlined
def ior_place(ior: float) -> float:
    """Place of an index on its axis, 0..1: its critical cosine, scaled."""
    return min(critical_cosine(ior) / critical_cosine(DENSEST), 1.0)


@inlined
def ior_at(place: float) -> float:
    """Index at a place of its axis."""
    critical = place * critical_cosine(DENSEST)
    return max(1.0 / math.sqrt(1.0 - critical * critical), LEAST_IOR)


@inlined
def inside_place(cosine: float, ior: float) -> float:
    """Place of a cosine inside a solid, 0..1: 0.5 is the critical angle.

    Above, by the cosine of the refracted ray; below, a smooth step's inverse, which is dense at
    both ends, for much happens at the critical angle and at the horizon.
    """
    far = transmitted_cosine(cosine, ior)
    if far > 0.0:
        return 0.5 + 0.5 * far
    part = min(cosine / critical_cosine(ior), 1.0)
    return 0.25 - 0.5 * math.sin(math.asin(1.0 - 2.0 * part) / 3.0)


@inlined
def inside_cosine(place: float, ior: float) -> float:
    """Cosine at a place of its axis."""
    if place > 0.5:
        return transmitted_cosine(2.0 * place - 1.0, 1.0 / ior)
    step = 2.0 * place
    return step * step * (3.0 - 2.0 * step) * critical_cosine(ior)


@kernel
def integrate_outside(roughness: Doubles, samples: int, table: Doubles) -> None:
    """Fill `table` (K, R, C, 1) with T seen from outside, at the lattice of `albedo_kernels`."""
    for k in range(table.shape[0]):
        ior = ior_at(k / (table.shape[0] - 1))
        for i in range(len(roughness)):
            alpha = ggx_alpha(roughness[i])
            for j in range(table.shape[2]):
                root = j / (table.shape[2] - 1)
                nov = max(root * root, MIN_COSINE)
                view = (math.sqrt(max(1.0 - nov * nov, 0.0)), 0.0, nov)
                through = 0.0
                for n in range(samples):
                    turn = math.pi * ((n * GOLDEN) % 1.0)
                    c, s, u = math.cos(turn), math.sin(turn), (n + 0.5) / samples
                    _, weight, voh = refraction_sample(view, 1.0 / ior, alpha, c, s, u)
                    through += weight * (1.0 - boundary_fresnel_weight(voh, 1.0 / ior))
                table[k, i, j, 0] = through / samples


@kernel
def integrate_inside(roughness: Doubles, samples: int, table: Doubles) -> None:
    """Fill `table` (K, R, C, 3) with A, B, T seen from inside, at the same lattice."""
    for k in range(table.shape[0]):
        ior = ior_at(k / (table.shape[0] - 1))
        for i in range(len(roughness)):
            alpha = ggx_alpha(roughness[i])
            for j in range(table.shape[2]):
                nov = max(inside_cosine(j / (table.shape[2] - 1), ior), MIN_COSINE)
                view = (math.sqrt(max(1.0 - nov * nov, 0.0)), 0.0, nov)
                scale, bias, through = 0.0, 0.0, 0.0
                for n in range(samples):
                    turn = math.pi * ((n * GOLDEN) % 1.0)
                    c, s, u = math.cos(turn), math.sin(turn), (n + 0.5) / samples
                    _, mirrored, voh = reflection_sample(view, alpha, c, s, u)
                    _, refracted, _ = refraction_sample(view, ior, alpha, c, s, u)
                    weight = boundary_fresnel_weight(voh, ior)
                    scale += mirrored * (1.0 - weight)
                    bias += mirrored * weight
                    through += refracted * (1.0 - weight)
                table[k, i, j, 0] = scale / samples
                table[k, i, j, 1] = bias / samples
                table[k, i, j, 2] = through / samples


@inlined
def trilinear(table: Doubles, z: float, y: float, x: float, column: int) -> float:
    """Value of a column of `table` (K, R, C, columns) at places 0..1 along its axes."""
    z, y, x = z * (table.shape[0] - 1), y * (table.shape[1] - 1), x * (table.shape[2] - 1)
    k = min(int(z), table.shape[0] - 2)
    i = min(int(y), table.shape[1] - 2)
    j = min(int(x), table.shape[2] - 2)
    total = 0.0
    for dk in range(2):
        for di in range(2):
            for dj in range(2):
                weight = (1.0 - abs(z - k - dk)) * (1.0 - abs(y - i - di)) * (1.0 - abs(x - j - dj))
                total += weight * table[k + dk, i + di, j + dj, column]
    return total


@kernel
def boundary_albedos(
    terms: Doubles,
    outside: Doubles,
    inside: Doubles,
    surface: Surface,
    reflected: Floats,
    transmitted: Floats,
) -> None:
    """Write F0 A + B and transmission c_diff (1 - F0) T to (N, 3) each; `terms` are A, B of the
    outside."""
    for i in range(len(surface.normal)):
        nov = (
            surface.normal[i, 0] * surface.to_viewer[i, 0]
            + surface.normal[i, 1] * surface.to_viewer[i, 1]
            + surface.normal[i, 2] * surface.to_viewer[i, 2]
        )
        nov = min(max(float(nov), 0.0), 1.0)
        roughness, ior = float(surface.roughness[i]), float(surface.glass.ior[i])
        scale, bias = specular_terms(terms, nov, roughness)
        through = scale
        if surface.glass.solid[i]:
            if surface.glass.entering[i]:
                place = math.sqrt(nov)
                through = trilinear(outside, ior_place(ior), roughness, place, 0)
            else:
                place = inside_place(nov, ior)
                scale = trilinear(inside, ior_place(ior), roughness, place, 0)
                bias = trilinear(inside, ior_place(ior), roughness, place, 1)
                through = trilinear(inside, ior_place(ior), roughness, place, 2)
        metal = surface.metallic[i]
        share = surface.transmission[i] * (1.0 - metal) * through
        for c in range(3):
            base = surface.base_colour[i, c]
            f0 = surface.dielectric_f0[i] * (1.0 - metal) + base * metal
            reflected[i, c] = f0 * scale + bias
            transmitted[i, c] = share * base * (1.0 - f0)
