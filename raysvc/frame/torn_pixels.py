"""Pixels that hold a silhouette: what is in front is blurred otherwise than what is behind.

An anti-aliased picture has them mixed. The lens needs them apart: how much of the pixel is in
front, and what colour either has.
"""

from typing import NamedTuple

import numpy as np

from raysvc.frame.draft import Draft
from raysvc.frame.points import front
from raysvc.frame.primary import CHUNK, traced
from raysvc.lens.coc import coc_px
from raysvc.lens.silhouette_kernels import STEP_PX
from raysvc.parallel import map_chunks
from raysvc.raster.pixel_samples import sample_offsets
from raysvc.types import Bools, Floats, Longs


class Torn(NamedTuple):
    """P pixels with a silhouette."""

    pixel: Longs
    """(P,) ascending."""
    before: Floats
    """(P,) part of each that something covers that is nearer than its centre ..."""
    coc_px: Floats
    """(P,) ... with this mean diameter; 0 where there is nothing."""
    own: Floats
    """(P,) part that is no farther than its centre, including what is before."""


def silhouette_pixels(draft: Draft) -> Bools:
    """(H * W,) bool: pixels that were anti-aliased across a silhouette."""
    coc, edge = draft.layers["coc"], draft.layers["edge"]
    padded = np.pad(coc, 1, mode="edge")
    height, width = coc.shape
    least, most = coc.copy(), coc.copy()
    for dy in range(3):
        for dx in range(3):
            beside = padded[dy : dy + height, dx : dx + width]
            np.minimum(least, beside, out=least)
            np.maximum(most, beside, out=most)
    mixed: Bools = (edge > 0) & (most - least >= STEP_PX)
    return mixed.reshape(-1)


def torn_pixels(draft: Draft, pixel: Longs) -> Torn:
    """Ask the samples of pixels (P,) by which they were anti-aliased how deep what they show is."""
    offsets = sample_offsets(draft.settings.aa_samples)
    samples = len(offsets)
    centre = draft.layers["coc"].reshape(-1)

    def some(begin: int, end: int) -> tuple[Floats, Floats, Floats]:
        part = pixel[begin:end]
        every = np.repeat(part, samples)
        within = np.tile(offsets, (len(part), 1))
        draft.ledger.count("primary", len(every))
        ray, directions, hits = traced(draft.prepared, draft.camera, every, within)
        alpha = draft.prepared.tables.alpha(hits.triangle, hits.barycentric)
        first = front(ray, alpha, len(every))
        depth = np.full(len(every), np.inf, np.float32)
        met = first >= 0
        along = directions @ draft.camera.forward.astype(np.float32)
        depth[met] = (hits.t * along)[first[met]]
        coc = coc_px(draft.camera, depth).reshape(len(part), samples)
        behind = coc - centre[part, None]
        nearer = behind <= -STEP_PX
        count = nearer.sum(axis=1)
        mean = np.where(nearer, coc, np.float32(0.0)).sum(axis=1) / np.maximum(count, 1)
        own = (behind < STEP_PX).mean(axis=1)
        return (
            (count / samples).astype(np.float32),
            mean.astype(np.float32),
            own.astype(np.float32),
        )

    parts = map_chunks(len(pixel), CHUNK // samples, some, draft.control)
    if not parts:
        nothing = np.zeros(0, np.float32)
        return Torn(pixel, nothing, nothing, nothing)
    before, coc, own = (np.concatenate(columns) for columns in zip(*parts, strict=True))
    return Torn(pixel, before, coc, own)
