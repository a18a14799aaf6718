"""Smooth edges: more samples, or none, for the pixels of a picture."""

from collections.abc import Callable
from typing import Final

import numpy as np

from raysvc.frame.accumulate import through_pinhole
from raysvc.frame.directional import smooth_edges
from raysvc.frame.draft import Draft
from raysvc.frame.edge_candidates import edge_candidates
from raysvc.frame.primary import CHUNK
from raysvc.frame.samples import shaded_each, shared_at_edges
from raysvc.parallel import for_chunks
from raysvc.types import Bools, Longs

SOME = CHUNK // 8
"""Pixels that are worked on at once."""


def antialias(draft: Draft) -> None:
    """Smooth the picture as the settings say, and note which pixels that was for."""
    settings = draft.settings
    # One sample is the pixel's centre, which is there already.
    shades_none = settings.aa in ("edges", "full") and not settings.shades_samples
    mask = METHODS["none" if shades_none else settings.aa](draft)
    draft.layers["edge"] = mask.astype(np.float32)
    draft.ledger.edge_fraction = float(mask.mean())


def _none(draft: Draft) -> Bools:
    return np.zeros(draft.shape, np.bool_)


def _full(draft: Draft) -> Bools:
    """Take all samples of all pixels, and shade each."""
    _shade_each(draft, np.arange(draft.camera.width * draft.camera.height), "edges")
    return np.ones(draft.shape, np.bool_)


def _accumulate(draft: Draft) -> Bools:
    """Take the mean of whole pictures."""
    draft.beauty = through_pinhole(draft)
    return np.ones(draft.shape, np.bool_)


def _edges(draft: Draft) -> Bools:
    """Take more samples where there are edges that can be seen, and shade what they do not share.

    Samples that show the edges of a mirror image share nothing: one shading shows one thing.
    """
    shapes, shadows, beyond = edge_candidates(draft)
    mask = beyond.copy()
    _shade_each(draft, np.flatnonzero(beyond), "")
    pixel = np.flatnonzero((shapes | shadows) & ~beyond)
    flagged, rgba = mask.reshape(-1), draft.beauty.reshape(-1, 4)

    def some(begin: int, end: int) -> None:
        part = pixel[begin:end]
        torn, mean = shared_at_edges(draft, part)
        flagged[part] = torn
        rgba[part[torn]] = mean

    for_chunks(len(pixel), SOME, some, draft.control, "edges")
    return mask


def _directional(draft: Draft) -> Bools:
    """Smooth edges along themselves, by samples that are not shaded."""
    candidates = edge_candidates(draft)
    smooth_edges(draft, candidates)
    mask: Bools = candidates.shapes | candidates.shadows | candidates.beyond
    return mask


def _shade_each(draft: Draft, pixel: Longs, stage: str) -> None:
    rgba = draft.beauty.reshape(-1, 4)

    def some(begin: int, end: int) -> None:
        part = pixel[begin:end]
        rgba[part] = shaded_each(draft, part)

    for_chunks(len(pixel), SOME, some, draft.control, stage)


METHODS: Final[dict[str, Callable[[Draft], Bools]]] = {
    "none": _none,
    "edges": _edges,
    "directional": _directional,
    "full": _full,
    "accumulate": _accumulate,
}
"""Each smooths the picture and says which pixels (H, W) it was for."""
