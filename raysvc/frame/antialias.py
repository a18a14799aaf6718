"""More samples where the picture has edges, or smoother edges without any.

`edges` looks for pixels next to which something else is seen, directly or in a mirror, and which
then differ in the picture. Every sample of these asks by a ray what it shows. Samples that show the
same triangle share one shading, that of the pixel's centre if it is there: coverage is what makes
edges jagged, and shading is what costs (as in hardware's multisampling: Akeley 1993, "RealityEngine
Graphics"). Only where the edge is in a mirror each sample traces its own reflection.

`full` shades all samples of all pixels; `directional` filters the picture along its edges.
"""

import numpy as np

from raysvc.accel.base import Hits
from raysvc.frame.background import composite
from raysvc.frame.draft import Draft
from raysvc.frame.points import Points
from raysvc.frame.primary import CHUNK, evaluated, traced
from raysvc.frame.reflections import leaving
from raysvc.frame.shared_rays import beside
from raysvc.imaging.directional_kernels import contrasts, smooth_along_edges
from raysvc.lighting.ambient import Ambient
from raysvc.parallel import for_chunks
from raysvc.raster.edges import edge_mask
from raysvc.raster.pixel_samples import sample_offsets
from raysvc.tracing.neighbours import BESIDE
from raysvc.tracing.occlusion import tile_of
from raysvc.types import Bools, Floats, Ints, Longs

LEAST_CONTRAST = 0.1
"""Of a pixel to its neighbours, in light compressed to 0..1; less cannot be seen to be jagged."""


def antialias(draft: Draft) -> None:
    """Take more samples where the picture has edges, or everywhere, and average them."""
    flagged, mirrored = _flagged(draft)
    draft.layers["edge"] = flagged.astype(np.float32)
    draft.ledger.edge_fraction = float(flagged.mean())
    if draft.settings.aa == "directional":
        picture = draft.beauty
        draft.beauty = np.empty_like(picture)
        smooth_along_edges(picture, flagged, draft.beauty)
        return
    pixel = np.flatnonzero(flagged)
    rgba = draft.beauty.reshape(-1, 4)

    def some(begin: int, end: int) -> None:
        part = pixel[begin:end]
        rgba[part] = _sampled(draft, part, mirrored.reshape(-1)[part])

    for_chunks(len(pixel), CHUNK // 8, some, draft.control, "edges")


def _flagged(draft: Draft) -> tuple[Bools, Bools]:
    """(H, W) pixels that are anti-aliased, and (H, W) those with an edge in a mirror."""
    aa = draft.settings.aa
    nowhere = np.zeros(draft.shape, np.bool_)
    if aa == "none" or (aa != "directional" and draft.settings.aa_samples == 1):
        return nowhere, nowhere
    if aa == "full":
        return np.ones(draft.shape, np.bool_), nowhere
    layers, reflection = draft.layers, draft.reflection
    seen = edge_mask(_part(draft, layers["id"]), layers["depth"], layers["normal"])
    mirrored = edge_mask(
        _part(draft, draft.picture(reflection.triangle, -1)),
        draft.picture(reflection.distance, np.inf),
        draft.picture(reflection.normal, 0.0),
    )
    contrast = np.empty(draft.shape, np.float32)
    contrasts(draft.beauty, contrast)
    shows = contrast > LEAST_CONTRAST
    return (seen | mirrored) & shows, mirrored & shows


def _part(draft: Draft, triangle: Ints) -> Ints:
    """(H, W) int32 number of the object and material of triangles (H, W), -1 for none."""
    scene = draft.prepared.scene
    if not len(scene.triangles):
        return triangle
    number = scene.object_of_triangle * len(scene.materials) + scene.material_of_triangle
    return np.where(triangle >= 0, number[triangle], -1).astype(np.int32)


def _sampled(draft: Draft, pixel: Longs, mirrored: Bools) -> Floats:
    """Premultiplied RGBA (P, 4), each the mean of a pixel's samples.

    Those with an edge in a mirror, mirrored (P,), share no shading.
    """
    samples = draft.settings.aa_samples
    every = np.repeat(pixel, samples)
    within = np.tile(sample_offsets(samples), (len(pixel), 1))
    draft.ledger.count("primary", len(every))
    row, directions, hits = traced(draft.prepared, draft.camera, every, within)

    # Where samples share a shading it stands for the pixel, else for their part of it
    pixels_per_step = samples**-0.5 if draft.settings.aa == "full" else 1.0
    radiance = np.empty((len(row), 3), np.float32)
    alpha = np.empty(len(row), np.float32)
    new = np.arange(len(row))
    first = group = new
    if draft.settings.aa == "edges":
        place, at_centre = row // samples, draft.front[every[row]]
        alone = mirrored[place]
        known = (at_centre >= 0) & (draft.points.triangle[at_centre] == hits.triangle) & ~alone
        radiance[known] = draft.radiance[at_centre[known]]
        alpha[known] = draft.points.surface.alpha[at_centre[known]]
        new = np.flatnonzero(~known)
        place = np.where(alone, len(pixel) + row, place)
        first, group = _shared(place[new], hits.triangle[new])
    chosen = new[first]
    points = evaluated(
        draft.prepared,
        draft.camera,
        every[row[chosen]],
        directions[chosen],
        Hits(hits.t[chosen], hits.triangle[chosen], hits.barycentric[chosen]),
        draft.settings.texture_filter,
        pixels_per_step,
    )
    radiance[new] = _shaded(draft, points, pixels_per_step)[group]
    alpha[new] = points.surface.alpha[group]

    rgba = composite(draft.prepared, draft.camera, draft.settings, every, row, radiance, alpha)
    mean: Floats = rgba.reshape(len(pixel), samples, 4).mean(axis=1, dtype=np.float32)
    return mean


def _shaded(draft: Draft, points: Points, pixels_per_step: float) -> Floats:
    """(N, 3) radiance of points beside pixel centres."""
    surface, illumination = points.surface, draft.illumination
    direct = illumination.direct.punctual(surface)
    for shadow in draft.shadows:
        direct += shadow.at(points)
    lit = illumination.lit(surface, points.footprint, direct, _ambient_at(draft, points))
    return leaving(lit, *beside(draft, points, lit, pixels_per_step))


def _shared(place: Longs, triangle: Ints) -> tuple[Longs, Longs]:
    """Which hits are shaded, and for each of the N hits which of those it takes its colour from.

    Hits of one pixel on one triangle share the first one's.
    """
    key = (place << 32) | triangle
    _, first, group = np.unique(key, return_index=True, return_inverse=True)
    return first, group


def _ambient_at(draft: Draft, points: Points) -> Ambient:
    """What arrives at samples beside pixel centres: as at their neighbours on the same surface."""
    columns = draft.neighbours.mean(
        draft.ambient, BESIDE, points.pixel, points.depth, points.surface.normal
    )
    alone = np.flatnonzero(np.isnan(columns[:, 0]))
    tile = tile_of(points.pixel[alone], draft.camera.width)
    columns[alone] = draft.illumination.ambient(points.surface.chosen(alone), tile).columns()
    return Ambient.of_columns(columns)
