"""Depth of field by filter spreading: every point becomes a shape as large as its blur.

After Kosloff, Tao and Barsky, "Depth of field postprocessing for layered scenes using constant-time
rectangle spreading" (Graphics Interface 2009): of a shape only its edges are written down, and
running sums draw all of them at once.
"""

import math
from collections.abc import MutableSequence
from dataclasses import replace

import numpy as np

from raysvc.lens.bokeh import Bokeh, Pen
from raysvc.lens.compose_kernels import lay_behind, lay_focus_behind, make_whole
from raysvc.lens.guess import guessed_behind
from raysvc.lens.points import LensPoints
from raysvc.lens.slice_kernels import columns_of
from raysvc.lens.slices import SHARP_PX, Slices, slices_for
from raysvc.lens.sorting import Sorted, largest_values, sort
from raysvc.lens.sources import CHANNELS, Sources
from raysvc.lens.sum_kernels import enlarge, fold
from raysvc.parallel import Control, for_chunks
from raysvc.types import Floats

LARGEST_VALUE = 2.0**40
"""Brighter pixels are limited to it, so that fixed point still resolves 1e-5 beside them."""
LEAST_COVER = 0.01
"""However large a blur is, it covers this much, so that there is something to divide by."""
ROWS = 96
"""That are drawn at once: enough that few shapes are drawn twice, few enough for a cache."""
EVEN = Bokeh()


def spread(
    rgba: Floats,
    coc_px: Floats,
    bokeh: Bokeh = EVEN,
    layers: int | None = None,
    control: Control | None = None,
    warnings: MutableSequence[str] | None = None,
) -> Floats:
    """Blur a picture as a lens would, given every pixel's circle of confusion.

    What the foreground hides is guessed from around it (`raysvc.lens.guess`).

    Parameters
    ----------
    rgba
        (H, W, 4) float32, linear, premultiplied
    coc_px
        (H, W) float32, signed diameter in pixels, negative nearer than the focus (`lens.coc_px`)
    bokeh
        what a point becomes
    layers
        slices out of focus; see `slices_for`
    control
        threads and stopping; the result is the same to the bit with any number of threads
    warnings
        is told if pixels had to be limited

    Returns
    -------
    (H, W, 4) float32; `rgba` itself if nothing is blurred. Pixels in focus, with circles no larger
    than a pixel, keep their bits unless something nearer is blurred over them.

    Raises InvalidInput if the shapes do not match or a circle of confusion is not finite.
    """
    control = control or Control()
    points = LensPoints.of_picture(rgba, coc_px)
    if (np.abs(points.coc_px) < SHARP_PX).all():
        return rgba
    slices = slices_of(points, layers)
    points = guessed_behind(limited(points, control, warnings), slices)
    return spread_points(points, bokeh, slices, control)


def spread_points(
    points: LensPoints,
    bokeh: Bokeh,
    slices: Slices,
    control: Control,
    warnings: MutableSequence[str] | None = None,
) -> Floats:
    """(H, W, 4) float32 premultiplied: what a lens makes of points, shown and hidden."""
    points = limited(points, control, warnings)
    points = within_reach(points, min(points.shape) / bokeh.half_per_diameter)
    ordered = sort(points, slices, control)
    pen = bokeh.pen(ordered.largest_px)
    picture = np.zeros((*points.shape, 4), np.float32)

    def work(begin: int, end: int) -> None:
        _strip(ordered, slices, pen, begin, picture[begin:end])

    for_chunks(points.shape[0], ROWS, work, control)
    return picture


def slices_of(points: LensPoints, layers: int | None) -> Slices:
    """Return the slices into which points fall."""
    least, largest = points.coc_px.min(initial=0.0), points.coc_px.max(initial=0.0)
    return slices_for(float(least), float(largest), layers)


def within_reach(points: LensPoints, largest_px: float) -> LensPoints:
    """Return points with diameters limited to `largest_px`, with which they cover all the picture.

    What is limited covers as much less as it is smaller: the rest would fall beside the picture.
    """
    size = np.abs(points.coc_px)
    if size.max(initial=0.0) <= largest_px:
        return points
    largest = np.float32(largest_px)
    part = (largest / np.maximum(size, largest)).astype(np.float32)
    share = np.maximum(part * part, np.float32(LEAST_COVER))
    return replace(
        points,
        coc_px=points.coc_px * part,
        rgba=points.rgba * share[:, None],
        cover=points.cover * share,
    )


def limited(
    points: LensPoints, control: Control, warnings: MutableSequence[str] | None = None
) -> LensPoints:
    """Return points with NaN as 0 and the rest within +-LARGEST_VALUE."""
    if largest_values(points.rgba, control).max() <= LARGEST_VALUE:
        return points
    broken = ~(np.abs(points.rgba) <= LARGEST_VALUE).all(axis=1)
    if warnings is not None:
        count = len(np.unique(points.pixel[broken]))
        warnings.append(f"lens: {count} pixels were not finite or brighter than 2^40")
    clean = np.nan_to_num(points.rgba, nan=0.0, posinf=LARGEST_VALUE, neginf=-LARGEST_VALUE)
    largest = np.float32(LARGEST_VALUE)
    return replace(points, rgba=np.clip(clean, -largest, largest))


def _strip(ordered: Sorted, slices: Slices, pen: Pen, first: int, picture: Floats) -> None:
    """Draw rows first.. of the picture, (R, W, 4) zeros: slice by slice from front to back."""
    rows, width, _ = picture.shape
    open_, open_before = np.ones((2, rows, width), np.float32)
    sums = np.zeros((rows, width, CHANNELS), np.float32)
    for k in range(slices.count):
        if k == slices.sharp:
            lay_focus_behind(ordered.focus[first : first + rows], picture, open_, open_before)
            continue
        for hidden in (0, 1):
            drawn = [
                _draw(ordered, ordered.sources[k, hidden, level], level, pen, first, sums)
                for level in range(ordered.levels)
                if (k, hidden, level) in ordered.sources
            ]
            lay_behind(sums, any(drawn), hidden == 1, picture, open_, open_before)
    make_whole(picture, open_)


def _draw(
    ordered: Sorted, sources: Sources, level: int, pen: Pen, first: int, sums: Floats
) -> bool:
    """Add what sources spread to rows first.. of a picture, (R, W, CHANNELS); False for nothing."""
    rows, width, _ = sums.shape
    height, edge = len(sources.begin), 1 << level
    begin, end = first, first + rows
    if level > 0:
        begin = max(math.floor((first + 0.5) / edge - 0.5), 0)
        end = min(math.floor((first + rows - 0.5) / edge - 0.5) + 2, height)
    top, bottom = pen.rows(begin, end, height)
    left, right = columns_of(sources, max(0, top - pen.reach), min(height, bottom + pen.reach))
    if left >= right:
        return False
    left, right = left - pen.reach, right + pen.reach
    deltas = np.zeros((bottom - top + 2, right - left + 2, CHANNELS), np.int64)
    pen.draw(sources, ordered.scale, top, bottom, left, deltas)
    unit = 1.0 / ordered.scale
    if level == 0:
        fold(deltas, unit, height, top, left, begin, sums)
        return True
    coarse = np.zeros((end - begin, -(-width // edge), CHANNELS), np.float32)
    fold(deltas, unit, height, top, left, begin, coarse)
    within = max((left - 1) * edge, 0), min((right + 1) * edge, width)
    enlarge(coarse, begin, height, level, first, *within, sums)
    return True
