"""Rays into the specular lobe of a surface, one to a point."""

import math

import numpy as np

from raysvc.geometry.basis_kernels import basis
from raysvc.geometry.vector_kernels import dot, plus, row3, scaled, unit_or
from raysvc.jit import kernel
from raysvc.lighting.brdf import (
    MIN_COSINE,
    MIRROR_ROUGHNESS,
    fresnel_weight,
    ggx_alpha,
    ggx_density,
    masking,
    shadowing_given_masking,
    stretched_visible_normal,
    visible_normal,
)
from raysvc.lighting.brushed_lobe import (
    brushed_alphas,
    brushed_axes,
    brushed_density,
    brushed_masking,
    brushed_shadowing,
    brushed_view,
    is_brushed,
    placed_in,
)
from raysvc.shading.surface import Surface
from raysvc.types import Doubles, Floats


@kernel
def lobe_rays(
    surface: Surface, samples: Doubles, directions: Floats, weight: Floats, half_width: Floats
) -> None:
    """Fill directions (N, 3), unit, weight and half_width (N,) from samples (N, 2) in 0..1.

    Light that comes from `directions` counts `weight` times in the mean of what the lobe reflects:
    G2 / G1 times Fresnel's factor, and nothing for directions below the triangle, which are turned
    up. `half_width`, in radians, is that of a cone of solid angle 1 / density: about 2 alpha in the
    middle of the lobe, more in its tail. In the mirror limit a ray is the mirror's, without width.
    """
    for n in range(len(samples)):
        normal, ng = row3(surface.normal, n), row3(surface.geometric_normal, n)
        view = row3(surface.to_viewer, n)
        nov = max(dot(normal, view), MIN_COSINE)
        weight[n], half_width[n] = 1.0, 0.0
        alpha = ggx_alpha(np.float64(surface.roughness[n]))
        half = normal
        if is_brushed(surface, n):
            axes, (along, across) = brushed_axes(surface, n), brushed_alphas(surface, n)
            local = brushed_view(surface, n, axes)
            turn = 2.0 * math.pi * samples[n, 0]
            h = stretched_visible_normal(
                local, along, across, math.cos(turn), math.sin(turn), samples[n, 1]
            )
            half = plus(plus(scaled(axes[0], h[0]), axes[1], h[1]), axes[2], h[2])
            density = brushed_masking(local, along, across) * brushed_density(h, along, across)
            half_width[n] = math.sqrt(4.0 * local[2] / (math.pi * density))
        elif surface.roughness[n] > MIRROR_ROUGHNESS:
            tangent, bitangent = basis(normal)
            local = unit_or((dot(view, tangent), dot(view, bitangent), nov), (0.0, 0.0, 1.0))
            turn = 2.0 * math.pi * samples[n, 0]
            h = visible_normal(local, alpha, math.cos(turn), math.sin(turn), samples[n, 1])
            half = plus(plus(scaled(tangent, h[0]), bitangent, h[1]), normal, h[2])
            density = masking(local[2], alpha) * ggx_density(h[0] * h[0] + h[1] * h[1], alpha)
            half_width[n] = math.sqrt(4.0 * local[2] / (math.pi * density))
        voh = dot(view, half)
        towards = plus(scaled(half, 2.0 * voh), view, -1.0)
        if surface.roughness[n] > MIRROR_ROUGHNESS:
            nol = dot(towards, normal)
            weight[n] = 0.0
            if nol > 0.0:
                metal = surface.metallic[n]
                base = (
                    surface.base_colour[n, 0]
                    + surface.base_colour[n, 1]
                    + surface.base_colour[n, 2]
                ) / 3.0
                f0 = surface.dielectric_f0[n] * (1.0 - metal) + base * metal
                fresnel = f0 + (1.0 - f0) * fresnel_weight(voh)
                if is_brushed(surface, n):
                    light = placed_in(axes, towards)
                    shadowing = brushed_shadowing(local, light, along, across)
                else:
                    shadowing = shadowing_given_masking(nol, nov, alpha)
                weight[n] = fresnel * shadowing
        below = dot(towards, ng)
        if below < 0.0:
            towards = plus(towards, ng, -2.0 * below)
            if surface.roughness[n] > MIRROR_ROUGHNESS:
                weight[n] = 0.0
        towards = unit_or(towards, normal)
        for k in range(3):
            directions[n, k] = towards[k]
