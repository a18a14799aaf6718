"""The lens's stage: blur what was seen, and what it hides, by how far it is out of focus."""

import numpy as np

from raysvc.frame.background import behind_scene
from raysvc.frame.draft import Draft
from raysvc.lens.coc import coc_px
from raysvc.lens.gather import gather
from raysvc.lens.points import LensPoints
from raysvc.lens.slices import SHARP_PX
from raysvc.lens.spread import spread_points
from raysvc.types import Bools, Floats


def defocus(draft: Draft) -> None:
    """Give the picture a lens, if the camera has one."""
    settings, camera = draft.settings, draft.camera
    if settings.lens == "none" or camera.aperture_radius == 0.0:
        return
    coc = coc_px(camera, draft.layers["depth"])
    draft.layers["coc"] = coc
    draft.ledger.max_coc_px = float(np.abs(coc).max())
    if settings.lens == "gather":
        draft.beauty = gather(draft.beauty, coc, draft.control)
        return
    assert draft.slices is not None
    draft.beauty = spread_points(
        lens_points(draft), settings.bokeh, draft.slices, draft.control, draft.ledger.warnings
    )


def lens_points(draft: Draft) -> LensPoints:
    """All that the lens may show: the picture, layers of what is blended, what is hidden, and the
    background."""
    points, pixels = draft.points, draft.camera.width * draft.camera.height
    beauty = draft.beauty.reshape(-1, 4)
    coc = coc_px(draft.camera, points.depth)
    cover = points.surface.alpha.astype(np.float32)
    rgba = np.concatenate([draft.radiance, np.ones_like(cover)[:, None]], axis=1) * cover[:, None]

    # How much of what comes next is seen in each pixel.
    seen = np.ones(pixels)
    np.multiply.at(seen, points.pixel[~draft.hidden], 1.0 - cover[~draft.hidden])
    shown = np.zeros(pixels, np.bool_)
    first = np.unique(points.pixel, return_index=True)[1]
    shown[points.pixel[first]] = True
    # Where one surface is all that a pixel shows, the picture knows it best: it is anti-aliased.
    whole = first[(cover[first] >= 1.0) & ~draft.hidden[first]]
    rgba[whole] = beauty[points.pixel[whole]]

    far = coc_px(draft.camera, np.float32([np.inf]))[0]
    open_ = (seen > 0.0) | ~shown
    hidden_open = _left_open(draft, cover, pixels)
    behind = np.flatnonzero(open_ | hidden_open)
    background = beauty[behind].copy()
    mixed = np.flatnonzero(shown[behind])
    background[mixed] = behind_scene(draft.prepared, draft.camera, draft.settings, behind[mixed])
    found = LensPoints(draft.shape, points.pixel, coc, rgba, cover).behind(
        LensPoints(
            draft.shape,
            behind,
            np.full(len(behind), far, np.float32),
            background,
            np.ones(len(behind), np.float32),
        )
    )
    return _in_focus_as_seen(found, beauty)


def _left_open(draft: Draft, cover: Floats, pixels: int) -> Bools:
    """(pixels,) bool: those behind which a lens may see, and where what is hidden is not solid."""
    if draft.uncovered is None:
        return np.zeros(pixels, np.bool_)
    solid = np.zeros(pixels, np.bool_)
    solid[draft.points.pixel[draft.hidden & (cover >= 1.0)]] = True
    left: Bools = draft.uncovered & ~solid
    return left


def _in_focus_as_seen(points: LensPoints, beauty: Floats) -> LensPoints:
    """Replace all that is seen in a pixel by the picture, if all of it is in focus."""
    start = np.flatnonzero(np.diff(points.pixel, prepend=-1))
    sharp = np.abs(points.coc_px) < SHARP_PX
    # Points behind what covers all are not seen.
    stops = points.cover >= 1.0
    number = np.arange(len(stops))
    first_stop = np.minimum.reduceat(np.where(stops, number, len(stops)), start)
    blurred = np.minimum.reduceat(np.where(sharp, len(stops), number), start)
    several = (blurred > first_stop) & (first_stop > start)
    if not several.any():
        return points
    dropped = np.zeros(len(stops), np.bool_)
    for begin, end in zip(start[several], first_stop[several], strict=True):
        dropped[begin + 1 : end + 1] = True
    rgba, cover = points.rgba.copy(), points.cover.copy()
    rgba[start[several]] = beauty[points.pixel[start[several]]]
    cover[start[several]] = 1.0
    kept = ~dropped
    return LensPoints(
        points.shape, points.pixel[kept], points.coc_px[kept], rgba[kept], cover[kept]
    )
