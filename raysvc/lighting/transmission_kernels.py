"""Rays that go on behind glass, one to a point."""

import math

import numpy as np

from raysvc.geometry.basis_kernels import basis
from raysvc.geometry.refraction import refracted
from raysvc.geometry.vector_kernels import dot, plus, row3, scaled, unit_or
from raysvc.jit import kernel
from raysvc.lighting.brdf import (
    MIN_COSINE,
    MIRROR_ROUGHNESS,
    ggx_alpha,
)
from raysvc.lighting.microfacet_refraction import (
    boundary_fresnel_weight,
    refraction_lobe,
    refraction_sample,
)
from raysvc.lighting.thin_transmission import thin_lobe, thin_sample
from raysvc.shading.surface import Surface
from raysvc.types import Doubles, Floats


@kernel
def transmitted_rays(
    surface: Surface,
    eta: Floats,
    samples: Doubles,
    directions: Floats,
    weight: Floats,
    half_width: Floats,
) -> None:
    """Fill directions (N, 3), unit, weight and half_width (N,) of rays through N points of glass.

    Parameters
    ----------
    surface
        N points, with their glass
    eta
        (N,) as `Glass.eta` has it
    samples
        (N, 2) in 0..1: which of the microfacets that the viewer sees lets each ray through; (0, 2)
        for the ray through the smooth surface
    directions, weight
        light from `directions` counts `weight` times in the mean of what comes through; nothing at
        total reflection, where the direction is straight on
    half_width
        radians, of a cone of solid angle 1 / density; as wide as the lobe's middle for the smooth
        ray, and 0 in the mirror limit
    """
    for n in range(len(directions)):
        normal, view = row3(surface.normal, n), row3(surface.to_viewer, n)
        alpha = ggx_alpha(np.float64(surface.roughness[n]))
        rough = surface.roughness[n] > MIRROR_ROUGHNESS
        bends = surface.glass.solid[n] and eta[n] != 1.0
        towards = scaled(view, -1.0)
        weight[n], half_width[n] = 1.0, 0.0
        if len(samples) == 0 or not rough:
            if rough:
                half_width[n] = 2.0 * alpha
            if bends:
                through, far = refracted(view, normal, np.float64(eta[n]))
                weight[n] = 1.0 if far > 0.0 else 0.0
                towards = through if far > 0.0 else towards
        else:
            tangent, bitangent = basis(normal)
            nov = max(dot(normal, view), MIN_COSINE)
            local = unit_or((dot(view, tangent), dot(view, bitangent), nov), (0.0, 0.0, 1.0))
            turn = 2.0 * math.pi * samples[n, 0]
            c, s, u = math.cos(turn), math.sin(turn), samples[n, 1]
            if bends:
                light, share, voh = refraction_sample(local, np.float64(eta[n]), alpha, c, s, u)
                _, density, _ = refraction_lobe(local, light, np.float64(eta[n]), alpha)
                fresnel = boundary_fresnel_weight(voh, np.float64(eta[n]))
            else:
                light, share, voh = thin_sample(local, alpha, c, s, u)
                _, density, _ = thin_lobe(local, light, alpha)
                fresnel = boundary_fresnel_weight(voh, 1.0)
            weight[n] = 0.0
            if share > 0.0 and density > 0.0:
                weight[n] = share * (1.0 - fresnel)
                half_width[n] = 1.0 / math.sqrt(math.pi * density)
                towards = plus(
                    plus(scaled(tangent, light[0]), bitangent, light[1]), normal, light[2]
                )
        towards = unit_or(towards, scaled(normal, -1.0))
        below = dot(towards, row3(surface.geometric_normal, n))
        if below > 0.0:
            weight[n] = 0.0
            towards = plus(towards, row3(surface.geometric_normal, n), -2.0 * below)
        for k in range(3):
            directions[n, k] = towards[k]
