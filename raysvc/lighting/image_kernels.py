"""Light from an environment: the lobes' integrals over points, as fitted sums of round lobes.

What GGX makes of one viewing angle is no round lobe: towards grazing angles it leans, stretches and
is cut off at the horizon. It is close to a sum of a few round ones, between N and a little beyond
R, whose places, widths and weights are tabulated over alpha and N.V (`lobe_fit`). The sum is scaled
by the lobe's exact albedo, so that constant light is exact.
"""

import math

from raysvc.geometry.octahedral_kernels import octahedral_place
from raysvc.geometry.vector_kernels import unit_or
from raysvc.jit import inlined, kernel
from raysvc.lighting.albedo_kernels import diffuse_loss, lobe_terms
from raysvc.lighting.brdf import MIN_COSINE, MIRROR_ROUGHNESS, ggx_alpha
from raysvc.lighting.brushed_lobe import is_brushed
from raysvc.lighting.lobe_level_kernels import level_radiance, round_lobe
from raysvc.lighting.sphere_kernels import map_radiance, narrow_radiance, turned
from raysvc.shading.rescattering_kernels import rescattered
from raysvc.shading.surface import Surface
from raysvc.types import Doubles, Floats, Ints

FINEST_ALPHA = 1.0 / 32.0
"""Of the first level."""
COSINE = 10
"""The level of alpha 1, whose lobe is the cosine lobe of diffuse light."""
GGX_BOX = (3.5 * FINEST_ALPHA) ** 2
"""Steradians of a box as high as GGX of the first level's alpha."""


@inlined
def pixel_sr(surface: Surface, i: int) -> float:
    """Steradians that a pixel sees mirrored at a point."""
    return float(surface.mirrored.pixel_sr[i]) if len(surface.mirrored.pixel_sr) > 0 else 0.0


@inlined
def level_of_alpha(alpha: float) -> float:
    """Level whose lobe is that of GGX with this alpha, seen from straight above."""
    return 2.0 * math.log2(alpha) + COSINE


@inlined
def write_diffuse(
    losses: Doubles,
    surface: Surface,
    i: int,
    nov: float,
    light: tuple[float, float, float],
    strength: float,
    radiance: Floats,
) -> None:
    """Write what point i diffuses to `radiance` (N, 3); `light` is the mean under its lobe."""
    metal = surface.metallic[i]
    diffused = (1.0 - metal) * (1.0 - surface.transmission[i])
    scale = strength * diffused * (1.0 - diffuse_loss(losses, nov))
    f0 = surface.dielectric_f0[i] * (1.0 - metal)
    for c in range(3):
        base = surface.base_colour[i, c]
        radiance[i, c] = base * (1.0 - f0 - base * metal) * scale * light[c]


@inlined
def write_specular(
    terms: Doubles,
    surface: Surface,
    i: int,
    nov: float,
    lit: tuple[float, float, float],
    grazing: tuple[float, float, float],
    strength: float,
    radiance: Floats,
) -> None:
    """Write what point i reflects to `radiance` (N, 3).

    F = F0 (1 - x) + x with Schlick's x: `lit` is the mean weighted by 1 - x, `grazing` by x.
    """
    term_a, term_b = lobe_terms(terms, surface, i, nov)
    metal = surface.metallic[i]
    for c in range(3):
        f0 = surface.dielectric_f0[i] * (1.0 - metal) + surface.base_colour[i, c] * metal
        once = (f0 * term_a * lit[c] + term_b * grazing[c]) * strength
        radiance[i, c] = once * rescattered(surface, i, f0)


@inlined
def _fitted(fits: Floats, a: int, m: int, down: float, right: float, k: int, number: int) -> float:
    """One number of lookup k, between nodes a, m and the next ones, bilinear."""
    result: float = (
        (1.0 - down) * (1.0 - right) * fits[a, m, k, number]
        + (1.0 - down) * right * fits[a, m + 1, k, number]
        + down * (1.0 - right) * fits[a + 1, m, k, number]
        + down * right * fits[a + 1, m + 1, k, number]
    )
    return result


@kernel
def diffuse_light(
    texels: Floats,
    side: int,
    first: int,
    losses: Doubles,
    cos_yaw: float,
    sin_yaw: float,
    strength: float,
    surface: Surface,
    radiance: Floats,
) -> None:
    """Write the diffuse lobe's radiance to `radiance` (N, 3), from the level of the cosine lobe."""
    for i in range(len(surface.normal)):
        nx, ny, nz = turned(surface.normal, i, cos_yaw, sin_yaw)
        vx, vy, vz = turned(surface.to_viewer, i, cos_yaw, sin_yaw)
        nov = nx * vx + ny * vy + nz * vz
        u, v = octahedral_place(nx, ny, nz)
        red, green, blue = level_radiance(texels, side, first, u, v)
        write_diffuse(losses, surface, i, nov, (red, green, blue), strength, radiance)


@kernel
def specular_light(
    sharp: Doubles,
    order: int,
    texels: Floats,
    sides: Ints,
    firsts: Ints,
    raw_map: Floats,
    terms: Doubles,
    fits: Floats,
    whole: Doubles,
    cos_yaw: float,
    sin_yaw: float,
    strength: float,
    surface: Surface,
    radiance: Floats,
) -> None:
    """Write the specular lobe's radiance to rows of `radiance` (N, 3), but for brushed points.

    `whole` are tables of order 1 of the map with its suns, which are read where a pixel sees more
    than a texel of it in a mirror.
    """
    texel_sr = 4.0 * math.pi / (raw_map.shape[0] * raw_map.shape[1])
    for i in range(len(surface.normal)):
        if is_brushed(surface, i):
            continue
        nx, ny, nz = turned(surface.normal, i, cos_yaw, sin_yaw)
        vx, vy, vz = turned(surface.to_viewer, i, cos_yaw, sin_yaw)
        nov = nx * vx + ny * vy + nz * vz
        # R - N: lookups lie on the line through both
        lean = 2.0 * max(nov, MIN_COSINE) - 1.0
        dx, dy, dz = lean * nx - vx, lean * ny - vy, lean * nz - vz
        r_scale, g_scale, b_scale = 0.0, 0.0, 0.0
        r_bias, g_bias, b_bias = 0.0, 0.0, 0.0
        if surface.roughness[i] <= MIRROR_ROUGHNESS:
            r_scale, g_scale, b_scale = map_radiance(raw_map, nx + dx, ny + dy, nz + dz)
            # Between one and two texels the point becomes the pixel's mean
            seen_sr = pixel_sr(surface, i)
            wide = min(seen_sr / texel_sr - 1.0, 1.0)
            if wide > 0.0:
                x, y, z = unit_or((nx + dx, ny + dy, nz + dz), (nx, ny, nz))
                r, g, b = narrow_radiance(whole, 1, x, y, z, seen_sr)
                r_scale += wide * (r - r_scale)
                g_scale += wide * (g - g_scale)
                b_scale += wide * (b - b_scale)
            r_bias, g_bias, b_bias = r_scale, g_scale, b_scale
        else:
            level = level_of_alpha(ggx_alpha(float(surface.roughness[i])))
            seen_sr = pixel_sr(surface, i)
            # The last row is that of alpha 1, the last column that of N.V 1
            row = level + (fits.shape[0] - 1 - COSINE)
            row = min(max(row, 0.0), fits.shape[0] - 1.001)
            column = min(math.sqrt(max(nov, 0.0)), 0.99999) * (fits.shape[1] - 1.0)
            a, m = int(row), int(column)
            down, right = row - a, column - m
            for k in range(fits.shape[2]):
                along = _fitted(fits, a, m, down, right, k, 0)
                wider = _fitted(fits, a, m, down, right, k, 1)
                scale = _fitted(fits, a, m, down, right, k, 2)
                bias = _fitted(fits, a, m, down, right, k, 3)
                r, g, b = round_lobe(
                    sharp,
                    order,
                    texels,
                    sides,
                    firsts,
                    nx + along * dx,
                    ny + along * dy,
                    nz + along * dz,
                    level + wider,
                    GGX_BOX,
                    seen_sr,
                )
                r_scale, g_scale, b_scale = (
                    r_scale + scale * r,
                    g_scale + scale * g,
                    b_scale + scale * b,
                )
                r_bias, g_bias, b_bias = r_bias + bias * r, g_bias + bias * g, b_bias + bias * b

        lit, grazing = (r_scale, g_scale, b_scale), (r_bias, g_bias, b_bias)
        write_specular(terms, surface, i, nov, lit, grazing, strength, radiance)
