"""Loops over points under one light."""

import math

from raysvc.jit import kernel
from raysvc.lighting.brdf import (
    MIN_COSINE,
    MIRROR_ROUGHNESS,
    fresnel_weight,
    ggx_alpha,
    ggx_density_under_disc,
    smith_visibility,
)
from raysvc.lighting.brushed_lobe import brushed_reflection, is_brushed
from raysvc.shading.rescattering_kernels import rescattered
from raysvc.shading.surface import Surface
from raysvc.types import Doubles, Floats


@kernel
def reflect_light(
    surface: Surface,
    to_light: Floats,
    irradiance: Floats,
    angular_radius: float,
    radiance: Floats,
) -> None:
    """Write BRDF x irradiance x N.L of a disc of `angular_radius` radians to `radiance` (N, 3)."""
    for i in range(len(surface.normal)):
        radiance[i, 0] = 0.0
        radiance[i, 1] = 0.0
        radiance[i, 2] = 0.0
        lx, ly, lz = float(to_light[i, 0]), float(to_light[i, 1]), float(to_light[i, 2])
        facing = (
            surface.geometric_normal[i, 0] * lx
            + surface.geometric_normal[i, 1] * ly
            + surface.geometric_normal[i, 2] * lz
        )
        nx, ny, nz = (
            float(surface.normal[i, 0]),
            float(surface.normal[i, 1]),
            float(surface.normal[i, 2]),
        )
        nol = nx * lx + ny * ly + nz * lz
        if facing <= 0.0 or nol <= 0.0:
            continue

        # Half vector, in double precision: narrow lobes live on the seventh digit
        vx, vy, vz = (
            float(surface.to_viewer[i, 0]),
            float(surface.to_viewer[i, 1]),
            float(surface.to_viewer[i, 2]),
        )
        nov = max(nx * vx + ny * vy + nz * vz, MIN_COSINE)
        hx, hy, hz = lx + vx, ly + vy, lz + vz
        h2 = max(hx * hx + hy * hy + hz * hz, 1e-18)
        voh = min(max((vx * hx + vy * hy + vz * hz) / math.sqrt(h2), 1e-3), 1.0)
        cx, cy, cz = ny * hz - nz * hy, nz * hx - nx * hz, nx * hy - ny * hx
        n2 = nx * nx + ny * ny + nz * nz
        sine2 = min((cx * cx + cy * cy + cz * cz) / (h2 * n2), 1.0)

        lobe = 0.0
        if angular_radius == 0.0 or surface.roughness[i] > MIRROR_ROUGHNESS:
            alpha = ggx_alpha(float(surface.roughness[i]))
            # A disc of lights is a disc of half vectors: d_omega_l = 4 V.H d_omega_h
            radius2 = angular_radius * angular_radius / (4.0 * voh)
            if is_brushed(surface, i):
                lobe = brushed_reflection(surface, i, (lx, ly, lz), (vx, vy, vz), radius2)
            else:
                lobe = ggx_density_under_disc(sine2, alpha, radius2)
                lobe *= smith_visibility(nol, nov, alpha)
        weight = fresnel_weight(voh)

        metal = surface.metallic[i]
        diffused = (1.0 - metal) * (1.0 - surface.transmission[i])
        for c in range(3):
            base = surface.base_colour[i, c]
            f0 = surface.dielectric_f0[i] * (1.0 - metal) + base * metal
            fresnel = f0 + (1.0 - f0) * weight
            diffuse = (1.0 - fresnel) * base * diffused / math.pi
            specular = fresnel * lobe * rescattered(surface, i, f0)
            radiance[i, c] = (diffuse + specular) * nol * irradiance[i, c]


@kernel
def directions_to_disc(axes: Doubles, radius: float, samples: Doubles, directions: Floats) -> None:
    """Fill directions (M, 3), unit, to places of a disc that samples (M, 2) in 0..1 stand for.

    `axes` (3, 3) are rows: two across, and the one to the disc's middle; `radius` is in radians.
    """
    for i in range(len(samples)):
        away = math.sin(radius) * math.sqrt(samples[i, 0])
        turn = 2.0 * math.pi * samples[i, 1]
        x, y, z = away * math.cos(turn), away * math.sin(turn), math.sqrt(1.0 - away * away)
        for c in range(3):
            directions[i, c] = x * axes[0, c] + y * axes[1, c] + z * axes[2, c]
