"""Samples of pixels: found by rays, shaded, and averaged.

Coverage is what makes edges jagged, and shading is what costs. Samples of a pixel that show the
same triangle can therefore share one shading, that of the pixel's centre if it shows it too (as in
hardware's multisampling: Akeley 1993, "RealityEngine Graphics"). What comes straight from lights
they do not share: each asks for itself, and so shadows get smooth edges as well.
"""

from typing import NamedTuple

import numpy as np

from raysvc import records
from raysvc.accel.base import Hits
from raysvc.frame.background import composite
from raysvc.frame.draft import Draft
from raysvc.frame.points import Points, front
from raysvc.frame.primary import evaluated, traced
from raysvc.frame.reflections import leaving
from raysvc.frame.shared_rays import beside
from raysvc.frame.sharing_kernels import share_by_triangle
from raysvc.lighting.ambient import Ambient
from raysvc.lighting.sun import LUMINANCE
from raysvc.raster.edge_kernels import DEPTH_BEND, SAME_NORMAL, SHADED
from raysvc.raster.pixel_samples import sample_offsets
from raysvc.shading.footprint import Footprint
from raysvc.shading.surface import Surface
from raysvc.tracing.neighbours import BESIDE
from raysvc.tracing.occlusion import tile_of
from raysvc.tracing.tile_pattern import place_in_tile, tile_points
from raysvc.types import Bools, Doubles, Floats, Ints, Longs

LEAST_SHADOW = 0.05
"""Of a point's light, in its shadow's absence, that a shadow must take away to be looked at."""


class Found(NamedTuple):
    """N hits of rays through P pixels; those of one ray are in order of distance."""

    place: Longs
    """(N,) which of the pixels."""
    ray: Longs
    """(N,) place * samples + number of the sample."""
    directions: Floats
    """(N, 3) unit."""
    t: Floats
    triangle: Ints
    barycentric: Floats
    position: Floats
    """(N, 3)."""


class Sharing(NamedTuple):
    """The surfaces that N hits share: R of them."""

    group: Longs
    """(N,) which one."""
    surface: Surface
    """Of R points."""
    centre: Longs
    """(R,) which of the draft's points it is, -1 for those that are not."""
    points: Points
    """Those that are not."""


def shaded_each(draft: Draft, pixel: Longs) -> Floats:
    """Premultiplied RGBA (P, 4) of pixels (P,), each the mean of samples that are all shaded."""
    found = _find(draft, pixel, slice(None))
    # Together the samples stand for the pixel, each for its part of it.
    step = float(draft.settings.aa_samples) ** -0.5
    points = _evaluated(draft, pixel, found, step)
    asked = _places(draft, points.pixel, found.ray)
    radiance = _shaded(draft, points, _direct_at(draft, points, asked), step, asked)
    return _mean(draft, pixel, found.ray, radiance, points.surface.alpha)


def shared_at_edges(draft: Draft, pixel: Longs) -> tuple[Bools, Floats]:
    """Which of pixels (P,) hold an edge, and the premultiplied RGBA (E, 4) of those E.

    Half of the samples are asked first. Where all of them show the surface of the pixel's centre in
    the same light there is no edge, and the others are spared (after Whitted 1980, "An Improved
    Illumination Model for Shaded Display", who asked the corners of pixels).
    """
    half, rest = slice(0, None, 2), slice(1, None, 2)
    found = _find(draft, pixel, half)
    sharing = _share(draft, pixel, found)
    direct = _direct(draft, pixel, found, sharing, 0)
    torn = _is_torn(draft, pixel, found, sharing, direct)

    edge = pixel[torn]
    kept = np.flatnonzero(torn[found.place])
    place = (np.cumsum(torn) - 1)[found.place[kept]]
    ray = found.ray[kept] + (place - found.place[kept]) * draft.settings.aa_samples
    found = records.chosen(found, kept)._replace(place=place, ray=ray)
    found = records.joined([found, _find(draft, edge, rest)])
    sharing = _share(draft, edge, found)
    direct = np.concatenate([direct[kept], _direct(draft, edge, found, sharing, len(kept))])
    radiance = _undirected(draft, sharing)[sharing.group] + direct
    return torn, _mean(draft, edge, found.ray, radiance, _alpha(draft, found, sharing))


def _find(draft: Draft, pixel: Longs, some: slice) -> Found:
    """Send rays through some of the samples of pixels (P,)."""
    samples = draft.settings.aa_samples
    number = np.arange(samples)[some]
    every = np.repeat(pixel, len(number))
    within = np.tile(sample_offsets(samples)[some], (len(pixel), 1))
    draft.ledger.count("primary", len(every))
    row, directions, hits = traced(draft.prepared, draft.camera, every, within)
    place, sample = np.divmod(row, max(len(number), 1))
    return Found(
        place,
        place * samples + number[sample],
        directions,
        hits.t,
        hits.triangle,
        hits.barycentric,
        draft.prepared.tables.position(hits.triangle, hits.barycentric),
    )


def _evaluated(draft: Draft, pixel: Longs, found: Found, pixels_per_step: float) -> Points:
    return evaluated(
        draft.prepared,
        draft.camera,
        pixel[found.place],
        found.directions,
        Hits(found.t, found.triangle, found.barycentric),
        draft.settings.texture_filter,
        pixels_per_step,
    )


def _share(draft: Draft, pixel: Longs, found: Found) -> Sharing:
    """Let hits of one pixel on one triangle share a surface."""
    group, older = np.empty((2, len(found.place)), np.int64)
    newest = np.full(len(pixel), -1, np.int64)
    count = share_by_triangle(found.place, found.triangle, newest, older, group)
    first = np.empty(count, np.int64)
    first[group[::-1]] = np.arange(len(group))[::-1]

    centre = draft.front[pixel[found.place[first]]]
    known = (centre >= 0) & (draft.points.triangle[centre] == found.triangle[first])
    points = _evaluated(draft, pixel, records.chosen(found, first[~known]), 1.0)
    surface = records.joined([records.chosen(draft.points.surface, centre[known]), points.surface])
    order = np.argsort(np.concatenate([np.flatnonzero(known), np.flatnonzero(~known)]))
    return Sharing(group, records.chosen(surface, order), np.where(known, centre, -1), points)


def _direct(draft: Draft, pixel: Longs, found: Found, sharing: Sharing, begin: int) -> Floats:
    """(N - begin, 3) radiance that hits from number `begin` on return of lights, each by itself."""
    surface = records.chosen(sharing.surface, sharing.group[begin:])
    points = Points(
        pixel[found.place[begin:]],
        found.triangle[begin:],
        found.t[begin:] * (found.directions[begin:] @ draft.camera.forward.astype(np.float32)),
        Footprint.points(surface.size),
        surface._replace(position=found.position[begin:]),
    )
    direct = _direct_at(draft, points, _places(draft, points.pixel, found.ray[begin:]))
    direct[surface.unlit] = 0.0
    return direct


def _places(draft: Draft, pixel: Longs, ray: Longs) -> Doubles:
    """(N, 2) places in 0..1 of a lobe or of a light that samples in pixels (N,) ask.

    Those of one pixel, told apart by `ray` (N,), ask different ones: one distribution of rays
    serves the pixel and what its points ask (Cook et al. 1984, "Distributed Ray Tracing").
    """
    samples = draft.settings.aa_samples
    pattern = tile_points(draft.settings.seed)
    place = place_in_tile(pixel, draft.camera.width)
    asked: Doubles = pattern[(place * samples + ray % samples) % len(pattern)]
    return asked


def _direct_at(draft: Draft, points: Points, asked: Doubles) -> Floats:
    """(N, 3) radiance that points beside pixel centres return of lights, which are asked there."""
    direct = draft.illumination.direct.punctual(points.surface)
    for shadow in draft.shadows:
        direct += shadow.at(points, asked)
    return direct


def _is_torn(draft: Draft, pixel: Longs, found: Found, sharing: Sharing, direct: Floats) -> Bools:
    """(P,) bool: what the hits in pixels (P,) show is not one surface in one light."""
    scene, points, samples = draft.prepared.scene, draft.points, draft.settings.aa_samples
    alpha = _alpha(draft, found, sharing)
    shown = front(found.ray, alpha, len(pixel) * samples).reshape(len(pixel), samples)[:, ::2]
    centre = np.broadcast_to(draft.front[pixel][:, None], shown.shape)
    torn = (shown >= 0) != (centre >= 0)

    both = np.nonzero((shown >= 0) & (centre >= 0))
    hit, middle = shown[both], centre[both]
    one, other = found.triangle[hit], points.triangle[middle]
    differs = scene.object_of_triangle[one] != scene.object_of_triangle[other]
    differs |= scene.material_of_triangle[one] != scene.material_of_triangle[other]
    normal = sharing.surface.normal[sharing.group[hit]]
    differs |= np.einsum("nk,nk->n", normal, points.surface.normal[middle]) < SAME_NORMAL
    apart = found.position[hit] - points.surface.position[middle]
    height = np.einsum("nk,nk->n", apart, points.surface.geometric_normal[middle])
    differs |= np.abs(height) > DEPTH_BEND * points.depth[middle]

    luminance = LUMINANCE.astype(np.float32)
    light = direct[hit] @ luminance, _own_direct(draft, middle) @ luminance
    most, least = np.maximum(*light), np.minimum(*light)
    whole = draft.radiance[middle] @ luminance + most - light[1]
    differs |= (least < SHADED * most) & (most - least > LEAST_SHADOW * whole)
    torn[both] |= differs
    any_of: Bools = torn.any(axis=1)
    return any_of


def _own_direct(draft: Draft, index: Longs) -> Floats:
    """(M, 3) part of the radiance of the draft's points (M,) that comes straight from lights."""
    unlit = draft.points.surface.unlit[index, None]
    return np.where(unlit, np.float32(0.0), draft.direct[index])


def _undirected(draft: Draft, sharing: Sharing) -> Floats:
    """(R, 3) radiance of shared surfaces, without what comes straight from lights."""
    known = sharing.centre >= 0
    radiance = np.empty((len(known), 3), np.float32)
    centre = sharing.centre[known]
    radiance[known] = np.maximum(draft.radiance[centre] - _own_direct(draft, centre), 0.0)
    nothing = np.zeros((sharing.points.surface.size, 3), np.float32)
    radiance[~known] = _shaded(draft, sharing.points, nothing, 1.0)
    return radiance


def _alpha(draft: Draft, found: Found, sharing: Sharing) -> Floats:
    """(N,) how much hits cover; of blended triangles, each at its own place."""
    alpha = sharing.surface.alpha[sharing.group]
    blended = np.flatnonzero(draft.prepared.tables.blended[found.triangle])
    alpha[blended] = draft.prepared.tables.alpha(
        found.triangle[blended], found.barycentric[blended]
    )
    return alpha


def _mean(draft: Draft, pixel: Longs, ray: Longs, radiance: Floats, alpha: Floats) -> Floats:
    """Premultiplied RGBA (P, 4) of pixels (P,) whose hits have radiance (N, 3) and alpha (N,)."""
    samples = draft.settings.aa_samples
    every = np.repeat(pixel, samples)
    rgba = composite(draft.prepared, draft.camera, draft.settings, every, ray, radiance, alpha)
    mean: Floats = rgba.reshape(len(pixel), samples, 4).mean(axis=1, dtype=np.float32)
    return mean


def _shaded(
    draft: Draft,
    points: Points,
    direct: Floats,
    pixels_per_step: float,
    asked: Doubles | None = None,
) -> Floats:
    """(N, 3) radiance of points beside pixel centres that return `direct` (N, 3) of lights."""
    lit = draft.illumination.lit(
        points.surface, points.footprint, direct, _ambient_at(draft, points)
    )
    return leaving(lit, *beside(draft, points, lit, pixels_per_step, asked))


def _ambient_at(draft: Draft, points: Points) -> Ambient:
    """What arrives at samples beside pixel centres: as at their neighbours on the same surface."""
    columns = draft.neighbours.mean(
        draft.ambient, BESIDE, points.pixel, points.depth, points.surface.normal
    )
    alone = np.flatnonzero(np.isnan(columns[:, 0]))
    tile = tile_of(points.pixel[alone], draft.camera.width)
    columns[alone] = draft.illumination.ambient(points.surface.chosen(alone), tile).columns()
    return Ambient.of_columns(columns)
