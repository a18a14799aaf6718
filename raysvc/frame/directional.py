"""Edges smoothed along themselves, by what samples cover but without shading any.

Samples beside pixel centres ask by rays what they show, and take the colour of the nearest pixel
whose centre shows the same. `raysvc.imaging.directional_kernels` does the rest.
"""

import numpy as np

from raysvc.frame.draft import Draft
from raysvc.frame.edge_candidates import Candidates
from raysvc.frame.points import front
from raysvc.frame.primary import traced
from raysvc.imaging.directional_kernels import compress, smooth_along_edges
from raysvc.parallel import for_chunks
from raysvc.raster.coverage_kernels import find_alike
from raysvc.raster.pixel_samples import sample_offsets
from raysvc.types import Doubles, Ints, Longs

MOST = 8
"""Samples of a pixel, as in the paper; more are not taken."""
SOME = 1 << 12
"""Pixels that are worked on at once."""


def smooth_edges(draft: Draft, candidates: Candidates) -> None:
    """Smooth the picture where there may be edges.

    Of the edges of shadows and mirror images, samples that are not shaded know nothing: there the
    filter has pixel centres alone.
    """
    offsets = sample_offsets(min(draft.settings.aa_samples, MOST))
    picture = draft.beauty.copy()
    flat = picture.reshape(-1, 4)
    compress(flat, False)
    # One sample would be the centre.
    shapes = np.flatnonzero(candidates.shapes if len(offsets) > 1 else [])
    slot = np.full(draft.shape, -1, np.int32)
    slot.reshape(-1)[shapes] = np.arange(len(shapes))
    samples = np.empty((len(shapes), len(offsets), 4), np.float32)
    part = draft.part_of_triangle()

    def cover(begin: int, end: int) -> None:
        samples[begin:end] = flat[_alike(draft, part, shapes[begin:end], offsets)]

    for_chunks(len(shapes), SOME, cover, draft.control, "edges")
    pixel = np.flatnonzero(candidates.shapes | candidates.shadows | candidates.beyond)
    beauty = draft.beauty.reshape(-1, 4)

    def smooth(begin: int, end: int) -> None:
        some = pixel[begin:end]
        smoothed = np.empty((len(some), 4), np.float32)
        smooth_along_edges(picture, slot, samples, offsets, some, smoothed)
        compress(smoothed, True)
        beauty[some] = smoothed

    for_chunks(len(pixel), SOME, smooth, draft.control)


def _alike(draft: Draft, part: Ints, pixel: Longs, offsets: Doubles) -> Longs:
    """(P, S) pixels whose centres show what the samples of pixels (P,) show."""
    scene = draft.prepared.scene
    alike = np.empty((len(pixel), len(offsets)), np.int64)
    find_alike(
        draft.layers["id"],
        scene.positions,
        scene.triangles,
        part,
        pixel,
        _covering(draft, pixel, offsets),
        offsets,
        alike,
    )
    return alike


def _covering(draft: Draft, pixel: Longs, offsets: Doubles) -> Ints:
    """(P, S) triangles that the samples of pixels (P,) show, -1 for none."""
    count = len(pixel) * len(offsets)
    every = np.repeat(pixel, len(offsets))
    within = np.tile(offsets, (len(pixel), 1))
    draft.ledger.count("primary", count)
    ray, _, hits = traced(draft.prepared, draft.camera, every, within)
    alpha = draft.prepared.tables.alpha(hits.triangle, hits.barycentric)
    shown = front(ray, alpha, count)
    triangle = np.full(count, -1, np.int32)
    triangle[shown >= 0] = hits.triangle[shown[shown >= 0]]
    return triangle.reshape(len(pixel), len(offsets))
