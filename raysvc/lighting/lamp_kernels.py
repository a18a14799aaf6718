"""Loops over points under lamps."""

import math
from typing import NamedTuple

import numpy as np

from raysvc.geometry.vector_kernels import Vec3, cross, dot, plus, row3, scaled
from raysvc.jit import inlined, kernel
from raysvc.lighting.brdf import (
    MIN_COSINE,
    fresnel_weight,
    ggx_alpha,
    ggx_density_under_disc,
    smith_visibility,
)
from raysvc.lighting.brushed_lobe import brushed_reflection, is_brushed
from raysvc.lighting.triangle_light_kernels import triangle_irradiance
from raysvc.shading.rescattering_kernels import rescattered
from raysvc.shading.surface import Surface
from raysvc.types import Doubles, Floats, Longs

NEAR = 2.0
"""Extents of a cluster up to which its pieces are looked at."""
WIDENED = 0.75
"""By how much of a disc's squared radius the square of a lobe's width grows."""
LOOKED_AT = 32
"""Pieces of a cluster; of more, some stand for those next to them."""


class Discs(NamedTuple):
    """What C clusters of glowing pieces look like from afar."""

    centre: Doubles
    """(C, 3)."""
    normal: Doubles
    """(C, 3) mean of the pieces' unit normals: short where they face different ways."""
    area: Doubles
    """(C,) square metres."""
    radiance: Doubles
    """(C, 3)."""
    extent: Doubles
    """(C,) metres, diagonal of the box around it."""


class Pieces(NamedTuple):
    """E glowing triangles."""

    corner: Doubles
    """(E, 3)."""
    edges: Doubles
    """(E, 2, 3) from there to the other two corners."""
    normal: Doubles
    """(E, 3) unit, to the side that glows."""
    radiance: Doubles
    """(E, 3)."""


class Order(NamedTuple):
    """Which pieces are in which cluster: those of one are next to each other."""

    sums: Doubles
    """(E,) power of the pieces up to each, it included."""
    first: Longs
    """(C + 1,) number of the first piece of each cluster, and how many pieces there are."""


@inlined
def _arriving(
    discs: Discs, k: int, position: Vec3, normal: Vec3, ng: Vec3
) -> tuple[float, Vec3, float, float]:
    """Irradiance at a point from a disc of radiance 1, direction to it, its squared radius as an
    angle if seen straight on, and N.L.

    The form factor of a disc that is not right above a point is approximate, but never more than 1
    (Wallace et al. 1989, equation 9). Of pieces that face all ways a quarter of the area is seen
    from everywhere, as of a convex body (Cauchy).
    """
    away = plus(row3(discs.centre, k), position, -1.0)
    distance2 = max(dot(away, away), 1e-30)
    to_light = scaled(away, 1.0 / math.sqrt(distance2))
    nol = dot(normal, to_light)
    if nol <= 0.0 or dot(ng, to_light) <= 0.0:
        return 0.0, to_light, 0.0, 0.0
    mean = row3(discs.normal, k)
    flat = min(math.sqrt(dot(mean, mean)), 1.0)
    seen = discs.area[k] * (max(-dot(mean, to_light), 0.0) + 0.25 * (1.0 - flat))
    arriving = math.pi * nol * seen / (math.pi * distance2 + seen)
    return arriving, to_light, discs.area[k] / (math.pi * distance2 + discs.area[k]), nol


@inlined
def _near_step(discs: Discs, order: Order, k: int, position: Vec3) -> int:
    """By how many pieces to go on at a time in a cluster that is near, 0 if it is not."""
    away = plus(row3(discs.centre, k), position, -1.0)
    reach = NEAR * discs.extent[k]
    if dot(away, away) > reach * reach:
        return 0
    return int(1 + (order.first[k + 1] - order.first[k] - 1) // LOOKED_AT)


@inlined
def _piece_arriving(
    pieces: Pieces, e: int, position: Vec3, normal: Vec3, ng: Vec3
) -> tuple[float, Vec3, float, float]:
    """As `_arriving`, of one piece, and its irradiance in closed form."""
    corner = plus(row3(pieces.corner, e), position, -1.0)
    first, second = row3(pieces.edges[e], 0), row3(pieces.edges[e], 1)
    away = plus(plus(corner, first, 1.0 / 3.0), second, 1.0 / 3.0)
    distance2 = max(dot(away, away), 1e-30)
    to_light = scaled(away, 1.0 / math.sqrt(distance2))
    if dot(corner, row3(pieces.normal, e)) >= 0.0 or dot(ng, to_light) <= 0.0:
        return 0.0, to_light, 0.0, 0.0
    arriving = triangle_irradiance(
        normal, corner, plus(corner, first, 1.0), plus(corner, second, 1.0)
    )
    across = cross(first, second)
    area = 0.5 * math.sqrt(dot(across, across))
    nol = max(dot(normal, to_light), 1e-4)
    return arriving, to_light, area / (math.pi * distance2 + area), nol


@kernel
def light_from_lamps(
    discs: Discs,
    pieces: Pieces,
    order: Order,
    surface: Surface,
    highlight: Floats,
    radiance: Floats,
) -> None:
    """Fill radiance (N, 3) that points return of all clusters, or of the pieces of those nearby.

    Of the specular lobe it is only a part, `highlight` (N,).
    """
    for i in range(len(surface.normal)):
        position, normal = row3(surface.position, i), row3(surface.normal, i)
        ng, view = row3(surface.geometric_normal, i), row3(surface.to_viewer, i)
        nov = max(dot(normal, view), MIN_COSINE)
        alpha = ggx_alpha(np.float64(surface.roughness[i]))
        shine = float(highlight[i])
        # F = F0 (1 - x) + x: what is weighted by 1 - x, and by x
        red, green, blue = 0.0, 0.0, 0.0
        red_0, green_0, blue_0 = 0.0, 0.0, 0.0
        red_x, green_x, blue_x = 0.0, 0.0, 0.0
        for k in range(len(discs.area)):
            step = _near_step(discs, order, k, position)
            begin, end = order.first[k], order.first[k] + 1
            if step > 0:
                end = order.first[k + 1]
            for e in range(begin, end, max(step, 1)):
                light = row3(discs.radiance, k)
                if step == 0:
                    arriving, to_light, radius2, nol = _arriving(discs, k, position, normal, ng)
                else:
                    arriving, to_light, radius2, nol = _piece_arriving(
                        pieces, e, position, normal, ng
                    )
                    light = scaled(row3(pieces.radiance, e), min(step, end - e))
                if arriving <= 0.0:
                    continue
                half = plus(to_light, view, 1.0)
                half2 = max(dot(half, half), 1e-18)
                voh = min(max(dot(view, half) / math.sqrt(half2), 1e-3), 1.0)
                x = fresnel_weight(voh)
                r, g, b = scaled(light, arriving)
                diffuse = 1.0 - x
                red, green, blue = red + r * diffuse, green + g * diffuse, blue + b * diffuse
                if shine > 0.0:
                    noh = dot(normal, half)
                    sine2 = min(max(1.0 - noh * noh / half2, 0.0), 1.0)
                    # Discs lie side by side like coins: wider lobes close the gaps
                    radius2 /= 4.0 * voh
                    if is_brushed(surface, i):
                        spread2 = (1.0 + WIDENED) * radius2
                        lobe = brushed_reflection(surface, i, to_light, view, spread2) * shine
                    else:
                        wide = math.sqrt(alpha * alpha + WIDENED * radius2)
                        lobe = ggx_density_under_disc(sine2, wide, radius2)
                        lobe *= smith_visibility(nol, nov, alpha) * shine
                    lobe_0, lobe_x = lobe * (1.0 - x), lobe * x
                    red_0, red_x = red_0 + r * lobe_0, red_x + r * lobe_x
                    green_0, green_x = green_0 + g * lobe_0, green_x + g * lobe_x
                    blue_0, blue_x = blue_0 + b * lobe_0, blue_x + b * lobe_x
        metal = float(surface.metallic[i])
        diffused = (1.0 - metal) * (1.0 - float(surface.transmission[i])) / math.pi
        for c in range(3):
            base = float(surface.base_colour[i, c])
            f0 = float(surface.dielectric_f0[i]) * (1.0 - metal) + base * metal
            lit = red if c == 0 else (green if c == 1 else blue)
            lobe_0 = red_0 if c == 0 else (green_0 if c == 1 else blue_0)
            lobe_x = red_x if c == 0 else (green_x if c == 1 else blue_x)
            gain = rescattered(surface, i, f0)
            diffuse = (1.0 - f0) * base * diffused * lit
            radiance[i, c] = diffuse + f0 * lobe_0 * gain + lobe_x * gain


@kernel
def rays_to_pieces(
    discs: Discs,
    pieces: Pieces,
    order: Order,
    surface: Surface,
    point: Longs,
    samples: Doubles,
    directions: Floats,
    distance: Floats,
) -> None:
    """Fill the arrays of `ShadowRays`, for M of the points and samples (M, 2) in 0..1.

    The first number chooses a cluster by how much light it sends to the point, then, with what is
    left of it, a piece by its power, and with what is left again the distance from its corner.
    """
    clusters = len(discs.area)
    light = np.empty(clusters)
    for i in range(len(point)):
        n = point[i]
        position, normal = row3(surface.position, n), row3(surface.normal, n)
        ng = row3(surface.geometric_normal, n)
        total = 0.0
        for k in range(clusters):
            arriving, _, _, _ = _arriving(discs, k, position, normal, ng)
            light[k] = arriving * _luminance(discs, k)
            total += light[k]
        directions[i, 0], directions[i, 1], directions[i, 2] = ng[0], ng[1], ng[2]
        distance[i] = 0.0
        if total <= 0.0:
            continue

        # Cluster, piece, and place on it
        along = samples[i, 0] * total
        k = 0
        while k < clusters - 1 and along >= light[k]:
            along -= light[k]
            k += 1
        begin, end = order.first[k], order.first[k + 1]
        before = order.sums[begin - 1] if begin > 0 else 0.0
        along = min(along / max(light[k], 1e-300), 1.0) * (order.sums[end - 1] - before) + before
        e = min(begin + np.searchsorted(order.sums[begin:end], along, side="right"), end - 1)
        before = order.sums[e - 1] if e > 0 else 0.0
        along = min(max((along - before) / max(order.sums[e] - before, 1e-300), 0.0), 1.0)
        away = (0.0, 0.0, 0.0)
        for _ in range(end - begin):
            root = math.sqrt(along)
            away = plus(row3(pieces.corner, e), position, -1.0)
            away = plus(away, row3(pieces.edges[e], 0), root * (1.0 - samples[i, 1]))
            away = plus(away, row3(pieces.edges[e], 1), root * samples[i, 1])
            if dot(away, row3(pieces.normal, e)) < 0.0:
                break
            # A piece that faces away sends nothing: the next one stands for it
            e = begin + (e + 1 - begin) % (end - begin)
        length = math.sqrt(max(dot(away, away), 1e-30))
        for c in range(3):
            directions[i, c] = away[c] / length
        distance[i] = length


@inlined
def _luminance(discs: Discs, k: int) -> float:
    red, green, blue = row3(discs.radiance, k)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue
