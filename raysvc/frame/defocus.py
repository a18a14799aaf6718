"""The lens's stage: blur what was seen, and what it hides, by how far it is out of focus."""

import numpy as np

from raysvc.frame.accumulate import through_lens
from raysvc.frame.background import behind_scene
from raysvc.frame.draft import Draft
from raysvc.frame.primary import CHUNK
from raysvc.frame.torn_pixels import silhouette_pixels, torn_pixels
from raysvc.lens.coc import background_coc_px, coc_px
from raysvc.lens.gather import gather
from raysvc.lens.points import LensPoints
from raysvc.lens.slices import SHARP_PX
from raysvc.lens.spread import spread_points
from raysvc.parallel import map_chunks
from raysvc.types import Bools, Floats, Longs


def defocus(draft: Draft) -> None:
    """Give the picture a lens, if the camera has one."""
    settings, camera = draft.settings, draft.camera
    if settings.lens == "none" or camera.aperture_radius == 0.0:
        return
    coc = coc_px(camera, draft.layers["depth"])
    draft.layers["coc"] = coc
    draft.ledger.max_coc_px = float(np.abs(coc).max())
    if settings.lens == "accumulate":
        draft.beauty = through_lens(draft)
        return
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
    points, beauty = draft.points, draft.beauty.reshape(-1, 4)
    pixels = len(beauty)
    cover = points.surface.alpha.astype(np.float32)
    colour = np.concatenate([draft.radiance, np.ones_like(cover)[:, None]], axis=1)

    # How much of what comes next is seen in each pixel.
    seen = np.ones(pixels)
    shown = ~draft.hidden
    np.multiply.at(seen, points.pixel[shown], 1.0 - cover[shown])
    first = np.unique(points.pixel, return_index=True)[1]
    first = first[shown[first]]
    empty = np.ones(pixels, np.bool_)
    empty[points.pixel[first]] = False
    solid = np.zeros(pixels, np.bool_)
    solid[points.pixel[draft.hidden & (cover >= 1.0)]] = True
    assert draft.uncovered is not None
    behind = np.flatnonzero((seen > 0.0) | (draft.uncovered & ~solid))
    scene = LensPoints(
        draft.shape,
        points.pixel,
        coc_px(draft.camera, points.depth),
        colour * cover[:, None],
        cover,
    )
    seen_behind = map_chunks(
        len(behind),
        CHUNK,
        lambda begin, end: behind_scene(
            draft.prepared, draft.camera, draft.settings, behind[begin:end]
        ),
        draft.control,
    )
    background = LensPoints(
        draft.shape,
        behind,
        np.full(len(behind), background_coc_px(draft.camera), np.float32),
        np.concatenate([np.zeros((0, 4), np.float32), *seen_behind]),
        np.ones(len(behind), np.float32),
    )
    found = scene.behind(background)
    whole = np.zeros(pixels, np.bool_)
    whole[points.pixel[first[cover[first] >= 1.0]]] = True
    return _in_focus_as_seen(_anti_aliased(draft, found, whole | empty), beauty)


def _anti_aliased(draft: Draft, points: LensPoints, one: Bools) -> LensPoints:
    """Give points the picture's colours in pixels that show `one` (H * W,) surface, if any.

    The picture is anti-aliased. Where that has mixed what is blurred differently the points keep
    their own, cover what the silhouette leaves them, and what is before a pixel's centre gets a
    point of its own. Pixels whose centre is in focus stay as they are if nothing is before it.
    """
    beauty = draft.beauty.reshape(-1, 4)
    mixed = silhouette_pixels(draft)
    start = np.flatnonzero(np.diff(points.pixel, prepend=-1))
    in_focus = np.abs(points.coc_px[start]) < SHARP_PX
    pixel = points.pixel[start]
    place = np.flatnonzero(one[pixel] & mixed[pixel])
    found = torn_pixels(draft, pixel[place])
    before = found.before > 0.0
    # In focus, only what is blurred over it changes a pixel.
    split = np.zeros(len(start), np.bool_)
    split[place] = before | ~in_focus[place]
    taken = one[pixel] & ~split
    rgba, cover = points.rgba.copy(), points.cover.copy()
    rgba[start[taken]] = beauty[pixel[taken]]

    number = start[place]
    # What is before the pixel's centre has what of the picture's colour is left for it.
    rest = beauty[found.pixel] - (1.0 - found.before)[:, None] * rgba[number]
    near = LensPoints(
        points.shape,
        found.pixel[before],
        found.coc_px[before],
        np.maximum(rest[before], 0.0),
        found.before[before],
    )
    own = np.where(before | ~split[place] | (found.own <= 0.0), np.float32(1.0), found.own)
    rgba[number] *= own[:, None]
    cover[number] = own
    return near.behind(LensPoints(points.shape, points.pixel, points.coc_px, rgba, cover))


def _in_focus_as_seen(points: LensPoints, beauty: Floats) -> LensPoints:
    """Replace all that is seen in a pixel by the picture, if all of it is in focus."""
    start = np.flatnonzero(np.diff(points.pixel, prepend=-1))
    number = np.arange(len(points.pixel))
    end = len(number)
    # Points behind what covers all are not seen.
    last = np.minimum.reduceat(np.where(points.cover >= 1.0, number, end), start)
    sharp = np.abs(points.coc_px) < SHARP_PX
    blurred = np.minimum.reduceat(np.where(sharp, end, number), start)
    several = np.flatnonzero((blurred > last) & (last > start) & (last < end))
    if not len(several):
        return points
    rgba, cover = points.rgba.copy(), points.cover.copy()
    rgba[start[several]] = beauty[points.pixel[start[several]]]
    cover[start[several]] = 1.0
    kept = np.ones(len(number), np.bool_)
    kept[_between(start[several] + 1, last[several] + 1)] = False
    return LensPoints(
        points.shape, points.pixel[kept], points.coc_px[kept], rgba[kept], cover[kept]
    )


def _between(begin: Longs, end: Longs) -> Longs:
    """All numbers of the ranges begin..end, one after the other."""
    count = end - begin
    step = np.arange(int(count.sum())) - np.repeat(np.cumsum(count) - count, count)
    numbers: Longs = np.repeat(begin, count) + step
    return numbers
