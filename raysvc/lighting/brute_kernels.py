"""Light from an environment by brute force: many points of the map for each lobe, unfiltered.

The truth that filters are compared with in a picture (`ibl: brute`). Lookups lie at the same
lattice for all points, so that neighbours differ smoothly.
"""

import math

from raysvc.geometry.basis_kernels import basis
from raysvc.jit import kernel
from raysvc.lighting.albedo_kernels import GOLDEN
from raysvc.lighting.brdf import (
    MIN_COSINE,
    fresnel_weight,
    ggx_alpha,
    shadowing_given_masking,
    stretched_visible_normal,
)
from raysvc.lighting.brushed_lobe import (
    brushed_alphas,
    brushed_axes,
    brushed_shadowing,
    is_brushed,
)
from raysvc.lighting.image_kernels import write_diffuse, write_specular
from raysvc.lighting.sphere_kernels import map_radiance, turned
from raysvc.shading.surface import Surface
from raysvc.types import Doubles, Floats


@kernel
def brute_diffuse(
    rest: Floats,
    lookups: int,
    losses: Doubles,
    cos_yaw: float,
    sin_yaw: float,
    strength: float,
    surface: Surface,
    radiance: Floats,
) -> None:
    """Write the diffuse lobe's radiance to `radiance` (N, 3), from the map (H, W, 3)."""
    for i in range(len(surface.normal)):
        nx, ny, nz = turned(surface.normal, i, cos_yaw, sin_yaw)
        vx, vy, vz = turned(surface.to_viewer, i, cos_yaw, sin_yaw)
        (tx, ty, tz), (bx, by, bz) = basis((nx, ny, nz))
        red, green, blue, total = 0.0, 0.0, 0.0, 0.0
        for k in range(lookups):
            turn, u = 2.0 * math.pi * ((k * GOLDEN) % 1.0), (k + 0.5) / lookups
            a, b = math.sqrt(u) * math.cos(turn), math.sqrt(u) * math.sin(turn)
            c = math.sqrt(1.0 - u)
            lx = a * tx + b * bx + c * nx
            ly = a * ty + b * by + c * ny
            lz = a * tz + b * bz + c * nz
            voh = math.sqrt(max(0.5 + 0.5 * (lx * vx + ly * vy + lz * vz), 0.0))
            weight = 1.0 - fresnel_weight(voh)
            r, g, bl = map_radiance(rest, lx, ly, lz)
            red, green, blue = red + weight * r, green + weight * g, blue + weight * bl
            total += weight
        nov = nx * vx + ny * vy + nz * vz
        light = red / total, green / total, blue / total
        write_diffuse(losses, surface, i, nov, light, strength, radiance)


@kernel
def brute_specular(
    rest: Floats,
    lookups: int,
    terms: Doubles,
    cos_yaw: float,
    sin_yaw: float,
    strength: float,
    surface: Surface,
    radiance: Floats,
) -> None:
    """Write the specular lobe's radiance to `radiance` (N, 3), from the map (H, W, 3)."""
    for i in range(len(surface.normal)):
        nx, ny, nz = turned(surface.normal, i, cos_yaw, sin_yaw)
        vx, vy, vz = turned(surface.to_viewer, i, cos_yaw, sin_yaw)
        nov = nx * vx + ny * vy + nz * vz
        (tx, ty, tz), (bx, by, bz) = basis((nx, ny, nz))
        alpha = ggx_alpha(float(surface.roughness[i]))
        along, across, brushed = alpha, alpha, is_brushed(surface, i)
        if brushed:
            along, across = brushed_alphas(surface, i)
            (tx, ty, tz), (bx, by, bz), _ = brushed_axes(surface, i)
            tx, tz = cos_yaw * tx - sin_yaw * tz, sin_yaw * tx + cos_yaw * tz
            bx, bz = cos_yaw * bx - sin_yaw * bz, sin_yaw * bx + cos_yaw * bz
        va, vb, vn = vx * tx + vy * ty + vz * tz, vx * bx + vy * by + vz * bz, max(nov, MIN_COSINE)
        length = 1.0 / math.sqrt(va * va + vb * vb + vn * vn)
        va, vb, vn = va * length, vb * length, vn * length
        r_scale, g_scale, b_scale, scale = 0.0, 0.0, 0.0, 1e-30
        r_bias, g_bias, b_bias, bias = 0.0, 0.0, 0.0, 1e-30
        for k in range(lookups):
            turn, u = 2.0 * math.pi * ((k * GOLDEN) % 1.0), (k + 0.5) / lookups
            h = stretched_visible_normal(
                (va, vb, vn), along, across, math.cos(turn), math.sin(turn), u
            )
            voh = va * h[0] + vb * h[1] + vn * h[2]
            la, lb, ln = 2.0 * voh * h[0] - va, 2.0 * voh * h[1] - vb, 2.0 * voh * h[2] - vn
            if ln <= 0.0:
                continue
            r, g, b = map_radiance(
                rest,
                la * tx + lb * bx + ln * nx,
                la * ty + lb * by + ln * ny,
                la * tz + lb * bz + ln * nz,
            )
            x = fresnel_weight(voh)
            if brushed:
                weight = brushed_shadowing((va, vb, vn), (la, lb, ln), along, across)
            else:
                weight = shadowing_given_masking(ln, vn, alpha)
            wx, w1 = weight * x, weight * (1.0 - x)
            r_scale, g_scale, b_scale = r_scale + w1 * r, g_scale + w1 * g, b_scale + w1 * b
            r_bias, g_bias, b_bias = r_bias + wx * r, g_bias + wx * g, b_bias + wx * b
            scale, bias = scale + w1, bias + wx
        lit = r_scale / scale, g_scale / scale, b_scale / scale
        grazing = r_bias / bias, g_bias / bias, b_bias / bias
        write_specular(terms, surface, i, nov, lit, grazing, strength, radiance)
