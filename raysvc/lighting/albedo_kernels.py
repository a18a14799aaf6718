"""Integrals of the BRDF under constant light."""

import math

import numpy as np

from raysvc.jit import inlined, kernel
from raysvc.lighting.brdf import (
    MIN_COSINE,
    fresnel_weight,
    ggx_alpha,
    shadowing_given_masking,
    visible_normal,
)
from raysvc.lighting.brushed_lobe import (
    brushed_alphas,
    brushed_axes,
    brushed_view,
    is_brushed,
)
from raysvc.lighting.brushed_reflection import brushed_reflection_sample
from raysvc.shading.rescattering_kernels import rescattered
from raysvc.shading.surface import Surface
from raysvc.types import Doubles, Floats

GOLDEN = 0.6180339887498949

BRUSHED_SAMPLES = 128
"""Of a brushed lobe, whose albedo is integrated where it is wanted."""
_PARTS = (np.arange(BRUSHED_SAMPLES) + 0.5) / BRUSHED_SAMPLES
_TURNS = 2.0 * np.pi * ((np.arange(BRUSHED_SAMPLES) * GOLDEN) % 1.0)
_COSINES, _SINES = np.cos(_TURNS), np.sin(_TURNS)


@kernel
def integrate_specular(cosines: Doubles, roughness: Doubles, samples: int, table: Doubles) -> None:
    """Fill `table` (R, C, 2) with A, B of the specular lobe's albedo F0 A + B.

    Visible normals at the points of a golden-ratio lattice; by symmetry half of the turn is enough.
    """
    for i in range(len(roughness)):
        alpha = ggx_alpha(roughness[i])
        for j in range(len(cosines)):
            nov = max(cosines[j], MIN_COSINE)
            view = (math.sqrt(max(1.0 - nov * nov, 0.0)), 0.0, nov)
            scale, bias = 0.0, 0.0
            for k in range(samples):
                turn = math.pi * ((k * GOLDEN) % 1.0)
                u = (k + 0.5) / samples
                h = visible_normal(view, alpha, math.cos(turn), math.sin(turn), u)
                voh = view[0] * h[0] + view[2] * h[2]
                nol = 2.0 * voh * h[2] - nov
                if nol > 0.0:
                    share = shadowing_given_masking(nol, nov, alpha)
                    weight = fresnel_weight(voh)
                    scale += share * (1.0 - weight)
                    bias += share * weight
            table[i, j, 0] = scale / samples
            table[i, j, 1] = bias / samples


@kernel
def integrate_diffuse(cosines: Doubles, samples: int, table: Doubles) -> None:
    """Fill `table` (C,) with the mean of (1 - V.H)^5 over the cosine lobe, at the same lattice."""
    for j in range(len(cosines)):
        nov = max(cosines[j], MIN_COSINE)
        sine = math.sqrt(max(1.0 - nov * nov, 0.0))
        total = 0.0
        for k in range(samples):
            across = math.cos(math.pi * ((k * GOLDEN) % 1.0))
            u = (k + 0.5) / samples
            vol = sine * across * math.sqrt(u) + nov * math.sqrt(1.0 - u)
            total += fresnel_weight(math.sqrt(max(0.5 + 0.5 * vol, 0.0)))
        table[j] = total / samples


@inlined
def specular_terms(table: Doubles, nov: float, roughness: float) -> tuple[float, float]:
    """A, B at a cosine and a roughness: bilinear in `table` over roughness and sqrt(cosine)."""
    y = min(max(roughness, 0.0), 1.0) * (table.shape[0] - 1)
    x = math.sqrt(min(max(nov, 0.0), 1.0)) * (table.shape[1] - 1)
    i, j = min(int(y), table.shape[0] - 2), min(int(x), table.shape[1] - 2)
    v, u = y - i, x - j
    w00, w01, w10, w11 = (1.0 - v) * (1.0 - u), (1.0 - v) * u, v * (1.0 - u), v * u
    return (
        w00 * table[i, j, 0]
        + w01 * table[i, j + 1, 0]
        + w10 * table[i + 1, j, 0]
        + w11 * table[i + 1, j + 1, 0],
        w00 * table[i, j, 1]
        + w01 * table[i, j + 1, 1]
        + w10 * table[i + 1, j, 1]
        + w11 * table[i + 1, j + 1, 1],
    )


@inlined
def brushed_terms(surface: Surface, i: int) -> tuple[float, float]:
    """A, B of a brushed point: tables would need an angle and a strength more."""
    axes = brushed_axes(surface, i)
    view = brushed_view(surface, i, axes)
    along, across = brushed_alphas(surface, i)
    scale, bias = 0.0, 0.0
    for k in range(BRUSHED_SAMPLES):
        _, share, voh = brushed_reflection_sample(
            view, along, across, _COSINES[k], _SINES[k], _PARTS[k]
        )
        weight = fresnel_weight(voh)
        scale += share * (1.0 - weight)
        bias += share * weight
    return scale / BRUSHED_SAMPLES, bias / BRUSHED_SAMPLES


@inlined
def lobe_terms(table: Doubles, surface: Surface, i: int, nov: float) -> tuple[float, float]:
    """A, B of a point's specular lobe; `nov` is its N.V."""
    if is_brushed(surface, i):
        return brushed_terms(surface, i)
    return specular_terms(table, nov, float(surface.roughness[i]))


@inlined
def diffuse_loss(table: Doubles, nov: float) -> float:
    """C at a cosine: linear in `table`, whose axis is sqrt(cosine)."""
    x = math.sqrt(min(max(nov, 0.0), 1.0)) * (table.shape[0] - 1)
    j = min(int(x), table.shape[0] - 2)
    u = x - j
    loss: float = table[j] * (1.0 - u) + table[j + 1] * u
    return loss


@kernel
def specular_albedos(
    table: Doubles,
    surface: Surface,
    albedo: Floats,
) -> None:
    """Write F0 A + B to `albedo` (N, 3)."""
    for i in range(len(surface.normal)):
        nov = (
            surface.normal[i, 0] * surface.to_viewer[i, 0]
            + surface.normal[i, 1] * surface.to_viewer[i, 1]
            + surface.normal[i, 2] * surface.to_viewer[i, 2]
        )
        scale, bias = lobe_terms(table, surface, i, nov)
        metal = surface.metallic[i]
        for c in range(3):
            f0 = surface.dielectric_f0[i] * (1.0 - metal) + surface.base_colour[i, c] * metal
            albedo[i, c] = (f0 * scale + bias) * rescattered(surface, i, f0)


@kernel
def diffuse_albedos(
    table: Doubles,
    surface: Surface,
    albedo: Floats,
) -> None:
    """Write c_diff (1 - transmission) (1 - F0) (1 - C) to `albedo` (N, 3)."""
    for i in range(len(surface.normal)):
        nov = (
            surface.normal[i, 0] * surface.to_viewer[i, 0]
            + surface.normal[i, 1] * surface.to_viewer[i, 1]
            + surface.normal[i, 2] * surface.to_viewer[i, 2]
        )
        kept = 1.0 - diffuse_loss(table, nov)
        metal = surface.metallic[i]
        diffused = (1.0 - metal) * (1.0 - surface.transmission[i])
        for c in range(3):
            base = surface.base_colour[i, c]
            f0 = surface.dielectric_f0[i] * (1.0 - metal) + base * metal
            albedo[i, c] = base * diffused * (1.0 - f0) * kept
