"""Light from an environment: the lobes' integrals over points, by filtered importance sampling.

A lobe is cut into equally likely parts. Each part is one lookup: a box around the part's direction,
of the solid angle that the part has (Krivanek and Colbert 2008, with boxes of a summed-area table
for mip levels). The sum is normalised by the sum of weights and scaled by the lobe's exact albedo,
so that constant light is exact.
"""

import math

from raysvc.jit import inlined, kernel
from raysvc.lighting.albedo_kernels import diffuse_loss, specular_terms
from raysvc.lighting.brdf import (
    MIN_COSINE,
    MIRROR_ROUGHNESS,
    fresnel_weight,
    ggx_alpha,
    ggx_density,
    masking,
    shadowing_given_masking,
    visible_normal,
)
from raysvc.lighting.sphere_kernels import map_radiance, mean_radiance
from raysvc.shading.surface import Surface
from raysvc.types import Doubles, Floats

MAX_SOLID_ANGLE = 3.5
"""Of a lookup, in steradians."""

FRAME_BLEND_BEGIN = 0.5
FRAME_BLEND_END = 0.87
"""Between these |N.y| a lobe's frame turns from the parallels of Y to those of X."""

MIN_WEIGHT = 1e-6
"""Of a direction below the horizon: nothing, unless the whole lobe is there."""


@inlined
def _turned(vectors: Floats, i: int, cos_yaw: float, sin_yaw: float) -> tuple[float, float, float]:
    """Row i of world vectors (N, 3) in the map's frame."""
    x, y, z = float(vectors[i, 0]), float(vectors[i, 1]), float(vectors[i, 2])
    return cos_yaw * x - sin_yaw * z, y, sin_yaw * x + cos_yaw * z


@inlined
def _frame_share(ny: float) -> float:
    """Share of the frame along the parallels of Y, smooth from 1 to 0.

    No frame is smooth on the whole sphere; lookups in two frames are blended, over a wide band, for
    a lobe of few lookups looks different in each.
    """
    t = min(max((FRAME_BLEND_END - abs(ny)) / (FRAME_BLEND_END - FRAME_BLEND_BEGIN), 0.0), 1.0)
    return t * t * (3.0 - 2.0 * t)


@inlined
def _tangent(nx: float, ny: float, nz: float, around: int) -> tuple[float, float, float]:
    """Unit tangent along the parallels of a cylinder: around Y (0) or X (1)."""
    if around == 0:
        scale = 1.0 / math.sqrt(max(nx * nx + nz * nz, 1e-12))
        return nz * scale, 0.0, -nx * scale
    scale = 1.0 / math.sqrt(max(ny * ny + nz * nz, 1e-12))
    return 0.0, -nz * scale, ny * scale


@inlined
def _lifted(
    lx: float,
    ly: float,
    lz: float,
    nx: float,
    ny: float,
    nz: float,
    nol: float,
    lift: float,
    solid_angle: float,
) -> tuple[float, float, float]:
    """Unit direction L, raised towards N as far as its box would reach below the horizon.

    `lift` is the height over the horizon that a box is given, in units of half its own height.
    """
    low = lift * 0.5 * math.sqrt(solid_angle)
    if nol >= low:
        return lx, ly, lz
    # Shorten the part along the surface so that N.L is `low`
    low = min(low, 0.999)
    shrink = math.sqrt((1.0 - low * low) / max(1.0 - nol * nol, 1e-12))
    up = low - nol * shrink
    return lx * shrink + nx * up, ly * shrink + ny * up, lz * shrink + nz * up


@kernel
def diffuse_light(
    sharp: Doubles,
    soft: Doubles,
    losses: Doubles,
    pattern: Doubles,
    lift: float,
    cos_yaw: float,
    sin_yaw: float,
    strength: float,
    surface: Surface,
    radiance: Floats,
) -> None:
    """Write the diffuse lobe's radiance to `radiance` (N, 3)."""
    samples = len(pattern)
    for i in range(len(surface.normal)):
        nx, ny, nz = _turned(surface.normal, i, cos_yaw, sin_yaw)
        vx, vy, vz = _turned(surface.to_viewer, i, cos_yaw, sin_yaw)
        nov = nx * vx + ny * vy + nz * vz
        red, green, blue, total = 0.0, 0.0, 0.0, 0.0
        for around in range(2):
            share = _frame_share(ny)
            if around == 1:
                share = 1.0 - share
            if share <= 0.0:
                continue
            tx, ty, tz = _tangent(nx, ny, nz, around)
            bx, by, bz = ny * tz - nz * ty, nz * tx - nx * tz, nx * ty - ny * tx
            for k in range(samples):
                radius, up = math.sqrt(pattern[k, 2]), math.sqrt(1.0 - pattern[k, 2])
                a, b = radius * pattern[k, 0], radius * pattern[k, 1]
                lx = a * tx + b * bx + up * nx
                ly = a * ty + b * by + up * ny
                lz = a * tz + b * bz + up * nz
                voh = math.sqrt(max(0.5 + 0.5 * (lx * vx + ly * vy + lz * vz), 0.0))
                weight = share * (1.0 - fresnel_weight(voh))
                angle = min(pattern[k, 3] * math.pi / up, MAX_SOLID_ANGLE)
                lx, ly, lz = _lifted(lx, ly, lz, nx, ny, nz, up, lift, angle)
                r, g, bl = mean_radiance(sharp, soft, lx, ly, lz, angle)
                red += weight * r
                green += weight * g
                blue += weight * bl
                total += weight
        metal = surface.metallic[i]
        diffused = (1.0 - metal) * (1.0 - surface.transmission[i])
        scale = strength * diffused * (1.0 - diffuse_loss(losses, nov)) / max(total, 1e-12)
        f0 = surface.dielectric_f0[i] * (1.0 - metal)
        for c in range(3):
            light = red if c == 0 else (green if c == 1 else blue)
            base = surface.base_colour[i, c]
            radiance[i, c] = base * (1.0 - f0 - base * metal) * scale * light


@kernel
def specular_light(
    sharp: Doubles,
    soft: Doubles,
    raw_map: Floats,
    terms: Doubles,
    pattern: Doubles,
    lift: float,
    cos_yaw: float,
    sin_yaw: float,
    strength: float,
    surface: Surface,
    radiance: Floats,
) -> None:
    """Write the specular lobe's radiance to `radiance` (N, 3)."""
    samples = len(pattern)
    for i in range(len(surface.normal)):
        nx, ny, nz = _turned(surface.normal, i, cos_yaw, sin_yaw)
        vx, vy, vz = _turned(surface.to_viewer, i, cos_yaw, sin_yaw)
        nov = nx * vx + ny * vy + nz * vz
        # F = F0 (1 - x) + x: light weighted by 1 - x is `scale`, by x is `bias`
        r_scale, g_scale, b_scale, scale = 0.0, 0.0, 0.0, 1e-30
        r_bias, g_bias, b_bias, bias = 0.0, 0.0, 0.0, 1e-30
        if surface.roughness[i] <= MIRROR_ROUGHNESS:
            lx, ly, lz = 2.0 * nov * nx - vx, 2.0 * nov * ny - vy, 2.0 * nov * nz - vz
            r_scale, g_scale, b_scale = map_radiance(raw_map, lx, ly, lz)
            r_bias, g_bias, b_bias = r_scale, g_scale, b_scale
            scale, bias = 1.0, 1.0
        else:
            alpha = ggx_alpha(float(surface.roughness[i]))
            cos_v = max(nov, MIN_COSINE)
            for around in range(2):
                share = _frame_share(ny)
                if around == 1:
                    share = 1.0 - share
                if share <= 0.0:
                    continue
                tx, ty, tz = _tangent(nx, ny, nz, around)
                bx, by, bz = ny * tz - nz * ty, nz * tx - nx * tz, nx * ty - ny * tx
                va, vb = vx * tx + vy * ty + vz * tz, vx * bx + vy * by + vz * bz
                length = 1.0 / math.sqrt(va * va + vb * vb + cos_v * cos_v)
                va, vb, vn = va * length, vb * length, cos_v * length
                for k in range(samples):
                    ha, hb, hn = visible_normal(
                        (va, vb, vn),
                        alpha,
                        pattern[k, 0],
                        pattern[k, 1],
                        pattern[k, 2] * (1.0 - alpha) + pattern[k, 4] * alpha,
                    )
                    voh = max(va * ha + vb * hb + vn * hn, 1e-6)
                    la, lb, ln = 2.0 * voh * ha - va, 2.0 * voh * hb - vb, 2.0 * voh * hn - vn
                    weight = share * MIN_WEIGHT
                    if ln > 0.0:
                        weight = share * max(shadowing_given_masking(ln, vn, alpha), MIN_WEIGHT)
                    sine2 = ha * ha + hb * hb
                    pdf = masking(vn, alpha) * ggx_density(sine2, alpha) / (4.0 * vn)
                    size = pattern[k, 3] * (1.0 - alpha) + pattern[k, 5] * alpha
                    angle = min(size / pdf, MAX_SOLID_ANGLE)
                    lx, ly, lz = _lifted(
                        la * tx + lb * bx + ln * nx,
                        la * ty + lb * by + ln * ny,
                        la * tz + lb * bz + ln * nz,
                        nx,
                        ny,
                        nz,
                        ln,
                        lift,
                        angle,
                    )
                    r, g, b = mean_radiance(sharp, soft, lx, ly, lz, angle)
                    x = fresnel_weight(voh)
                    wx, w1 = weight * x, weight * (1.0 - x)
                    r_scale, g_scale, b_scale = r_scale + w1 * r, g_scale + w1 * g, b_scale + w1 * b
                    r_bias, g_bias, b_bias = r_bias + wx * r, g_bias + wx * g, b_bias + wx * b
                    scale, bias = scale + w1, bias + wx

        term_a, term_b = specular_terms(terms, nov, float(surface.roughness[i]))
        metal = surface.metallic[i]
        for c in range(3):
            f0 = surface.dielectric_f0[i] * (1.0 - metal) + surface.base_colour[i, c] * metal
            lit = r_scale if c == 0 else (g_scale if c == 1 else b_scale)
            grazing = r_bias if c == 0 else (g_bias if c == 1 else b_bias)
            mean = (f0 * lit + grazing) / (f0 * scale + bias)
            radiance[i, c] = mean * (f0 * term_a + term_b) * strength
