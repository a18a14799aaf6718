"""Light from an environment under the lobes of brushed surfaces.

With an angle and a strength more than a round one, such a lobe has too many sides for a table of
fits. So directions are mirrored about its visible normals, at the same lattice for all points, and
each looks the environment up under a power of the cosine as wide as the part of the lobe that it
stands for (Krivanek and Colbert 2008, "Real-time Shading with Filtered Importance Sampling").
"""

import math

from raysvc.geometry.vector_kernels import plus, scaled
from raysvc.jit import kernel
from raysvc.lighting.brdf import fresnel_weight
from raysvc.lighting.brushed_lobe import brushed_alphas, brushed_axes, brushed_view, is_brushed
from raysvc.lighting.brushed_reflection import brushed_reflection_density, brushed_reflection_sample
from raysvc.lighting.image_kernels import pixel_sr, write_specular
from raysvc.lighting.lobe_level_kernels import round_lobe
from raysvc.lighting.phong_kernels import BOX, level_of_solid_angle
from raysvc.shading.surface import Surface
from raysvc.types import Doubles, Floats, Ints

OVERLAP = 2.0
"""Solid angle of a lookup over that of its part of the lobe: less shows its neighbours apart."""
NARROWED = 0.5
"""Part of the variance of lookups that is taken out of the lattice, for they add it to the lobe.

Chosen with OVERLAP for the least error over five maps; all of it would cut the lobe's tails off."""


@kernel
def brushed_light(
    sharp: Doubles,
    order: int,
    texels: Floats,
    sides: Ints,
    firsts: Ints,
    terms: Doubles,
    lattice: Doubles,
    cos_yaw: float,
    sin_yaw: float,
    strength: float,
    surface: Surface,
    radiance: Floats,
) -> None:
    """Write the specular lobe's radiance to rows of `radiance` (N, 3) of points that are brushed.

    Levels are those of powers of the cosine; lattice (K, 2) that of `brushed_lattice`.
    """
    lookups = len(lattice)
    # Of a lookup over that of a disc of microfacets, both across the lobe where it is round
    variance = NARROWED * OVERLAP * math.pi / (4.0 * lookups)
    for i in range(len(surface.normal)):
        if not is_brushed(surface, i):
            continue
        axes = brushed_axes(surface, i)
        view = brushed_view(surface, i, axes)
        along, across = brushed_alphas(surface, i)
        high = math.sqrt(max(1.0 - variance * across / along, 0.0))
        wide = math.sqrt(max(1.0 - variance * along / across, 0.0))
        r_scale, g_scale, b_scale, scale = 0.0, 0.0, 0.0, 1e-30
        r_bias, g_bias, b_bias, bias = 0.0, 0.0, 0.0, 1e-30
        for k in range(lookups):
            a, b = lattice[k, 0] * high, lattice[k, 1] * wide
            u = a * a + b * b
            part = 1.0 / math.sqrt(max(u, 1e-12))
            light, share, voh = brushed_reflection_sample(
                view, along, across, a * part, b * part, u
            )
            if share <= 0.0:
                continue
            density = brushed_reflection_density(view, light, along, across)
            x, y, z = plus(plus(scaled(axes[0], light[0]), axes[1], light[1]), axes[2], light[2])
            r, g, b = round_lobe(
                sharp,
                order,
                texels,
                sides,
                firsts,
                cos_yaw * x - sin_yaw * z,
                y,
                sin_yaw * x + cos_yaw * z,
                level_of_solid_angle(OVERLAP / (lookups * density)),
                BOX,
                pixel_sr(surface, i),
            )
            weight = fresnel_weight(voh)
            w1, wx = share * (1.0 - weight), share * weight
            r_scale, g_scale, b_scale = r_scale + w1 * r, g_scale + w1 * g, b_scale + w1 * b
            r_bias, g_bias, b_bias = r_bias + wx * r, g_bias + wx * g, b_bias + wx * b
            scale, bias = scale + w1, bias + wx
        lit = r_scale / scale, g_scale / scale, b_scale / scale
        grazing = r_bias / bias, g_bias / bias, b_bias / bias
        write_specular(terms, surface, i, view[2], lit, grazing, strength, radiance)
