"""More samples where the picture has edges.

Every sample of a pixel asks by a ray what it shows. On edges, samples that show the same triangle
share one shading, that of the pixel's centre if it is there: coverage is what makes edges jagged,
and shading is what costs (as in hardware's multisampling: Akeley 1993, "RealityEngine Graphics").
Full anti-aliasing shades all.
"""

import numpy as np

from raysvc.accel.base import Hits
from raysvc.frame.background import composite
from raysvc.frame.draft import Draft
from raysvc.frame.points import Points
from raysvc.frame.primary import CHUNK, evaluated, traced
from raysvc.frame.reflections import leaving
from raysvc.frame.shared_rays import beside
from raysvc.parallel import for_chunks
from raysvc.raster.edges import edge_mask
from raysvc.raster.pixel_samples import sample_offsets
from raysvc.tracing.occlusion import tile_of
from raysvc.types import Bools, Floats, Ints, Longs


def antialias(draft: Draft) -> None:
    """Take more samples where the picture has edges, or everywhere, and average them."""
    flagged = _flagged(draft)
    draft.layers["edge"] = flagged.astype(np.float32)
    draft.ledger.edge_fraction = float(flagged.mean())
    pixel = np.flatnonzero(flagged)
    rgba = draft.beauty.reshape(-1, 4)

    def some(begin: int, end: int) -> None:
        part = pixel[begin:end]
        rgba[part] = _sampled(draft, part)

    for_chunks(len(pixel), CHUNK // 8, some, draft.control, "edges")


def _flagged(draft: Draft) -> Bools:
    aa = draft.settings.aa
    if aa == "none" or draft.settings.aa_samples == 1:
        return np.zeros(draft.shape, np.bool_)
    if aa == "full":
        return np.ones(draft.shape, np.bool_)
    layers = draft.layers
    # Where there is nothing both are -1, and so is what follows from them.
    part = layers["object"] * len(draft.prepared.scene.materials) + layers["material"]
    part = np.maximum(part, -1).astype(np.int32)
    return edge_mask(part, layers["depth"], layers["normal"])


def _sampled(draft: Draft, pixel: Longs) -> Floats:
    """Premultiplied RGBA (P, 4), each the mean of a pixel's samples."""
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
        at_centre = draft.front[every[row]]
        known = (at_centre >= 0) & (draft.points.triangle[at_centre] == hits.triangle)
        radiance[known] = draft.radiance[at_centre[known]]
        alpha[known] = draft.points.surface.alpha[at_centre[known]]
        new = np.flatnonzero(~known)
        first, group = _shared(row[new] // samples, hits.triangle[new])
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
    lit = illumination.lit(
        surface, points.footprint, illumination.direct(surface), _visible_at(draft, points)
    )
    return leaving(lit, *beside(draft, points, lit, pixels_per_step))


def _shared(place: Longs, triangle: Ints) -> tuple[Longs, Longs]:
    """Which hits are shaded, and for each of the N hits which of those it takes its colour from.

    Hits of one pixel on one triangle share the first one's.
    """
    key = (place << 32) | triangle
    _, first, group = np.unique(key, return_index=True, return_inverse=True)
    return first, group


def _visible_at(draft: Draft, points: Points) -> Floats:
    """Ambient visibility of samples beside pixel centres: the neighbours' on the same surface."""
    visible = draft.visibility.beside(points.pixel, points.depth, points.surface.normal)
    alone = np.flatnonzero(visible < 0)
    tile = tile_of(points.pixel[alone], draft.camera.width)
    visible[alone] = draft.illumination.occlusion(points.surface.chosen(alone), tile)
    return visible
