"""Sort points into slices and resolutions, to be spread."""

import math
from dataclasses import dataclass

import numpy as np

from raysvc.lens.points import LensPoints
from raysvc.lens.slice_kernels import FULL_PX, Membership, collect, join, largest_of, merge
from raysvc.lens.slices import Slices
from raysvc.lens.sources import CHANNELS, COVER, Sources
from raysvc.parallel import Control, for_chunks
from raysvc.types import Doubles, Floats, Longs

ROWS = 32
POINTS = 1 << 16
SUM_BITS = 62
HEADROOM_BITS = 7
"""Shapes of all sizes around a point weigh at most about 2 ln(picture's side), less than 2^6, and
there may be something hidden as well."""


@dataclass(frozen=True, slots=True, eq=False)
class Sorted:
    """All points of a picture (H, W)."""

    shape: tuple[int, int]
    sources: dict[tuple[int, int, int], Sources]
    """By slice, whether they are hidden, and level, where there are any."""
    focus: Floats
    """(H, W, 5) what is in focus: premultiplied colour, and how much it covers."""
    levels: int
    """How many resolutions there are."""
    scale: Doubles
    """(CHANNELS,) fixed point steps per unit."""
    largest_px: float
    """Diameter that no source exceeds at its level."""


def levels_for(largest_px: float) -> int:
    """How many resolutions it takes to spread diameters up to `largest_px`."""
    return 1 + max(0, math.floor(math.log2(max(largest_px, 1.0) / FULL_PX)) + 1)


def sort(points: LensPoints, slices: Slices, control: Control) -> Sorted:
    """Sort points; the result does not depend on the number of threads."""
    height, width = points.shape
    row_start = np.searchsorted(points.pixel, np.arange(height + 1) * width)
    largest = float(np.abs(points.coc_px).max(initial=0.0))
    levels = levels_for(largest)
    count = len(points.pixel)
    parts = Membership(
        np.empty(count, np.uint8),
        np.empty(count, np.float32),
        np.empty(count, np.float32),
        np.empty(count, np.uint8),
        np.empty(count, np.uint8),
    )
    counts = np.zeros((slices.count, 2, levels, height), np.int64)

    def find(begin: int, end: int) -> None:
        join(
            row_start,
            points.pixel,
            points.coc_px,
            points.cover,
            slices.fade_begin,
            slices.fade_end,
            slices.sharp,
            begin,
            end,
            parts,
            counts,
        )

    for_chunks(height, ROWS, find, control)
    ends = np.cumsum(counts.reshape(-1)).reshape(counts.shape)
    starts = ends - counts
    total = int(ends[-1, -1, -1, -1])
    every = _room(starts[0, 0, 0], total)
    focus = np.zeros((height, width, 5), np.float32)
    place = starts.copy()

    def write(begin: int, end: int) -> None:
        collect(
            row_start,
            points.pixel,
            points.coc_px,
            points.rgba,
            points.cover,
            parts,
            slices.sharp,
            begin,
            end,
            place,
            every,
            focus,
        )

    for_chunks(height, ROWS, write, control)
    sources = {}
    for k, hidden, level in np.argwhere(counts.any(axis=3)).tolist():
        of = k, hidden, level
        fine = every._replace(begin=starts[of], end=ends[of])
        sources[of] = fine if level == 0 else _merged(fine, level, width, control)
    top = levels - 1
    return Sorted(
        (height, width),
        sources,
        focus,
        levels,
        _scales(largest_values(points.rgba, control)),
        min(largest, max(FULL_PX, largest / (1 << top))),
    )


def _room(begin: Longs, count: int) -> Sources:
    return Sources(
        begin,
        begin.copy(),
        np.empty(count, np.int32),
        np.empty(count, np.float32),
        np.empty((count, CHANNELS), np.float32),
    )


def _merged(fine: Sources, level: int, width: int, control: Control) -> Sources:
    """Points of several pixels as one each."""
    edge = 1 << level
    height, columns = -(-len(fine.begin) // edge), -(-width // edge)
    most = np.add.reduceat(fine.end - fine.begin, np.arange(0, len(fine.begin), edge))
    most = np.minimum(most, columns)
    out = _room(np.cumsum(most) - most, int(most.sum()))

    def work(begin: int, end: int) -> None:
        merge(fine, level, width, begin, end, out)

    for_chunks(height, ROWS, work, control)
    return out


def largest_values(rgba: Floats, control: Control) -> Floats:
    """(4,) greatest magnitudes of rgba (N, 4); inf for what is not a number."""
    parts: dict[int, Floats] = {}

    def work(begin: int, end: int) -> None:
        parts[begin] = np.zeros(4, np.float32)
        largest_of(rgba, begin, end, parts[begin])

    for_chunks(len(rgba), POINTS, work, control)
    largest: Floats = np.max([np.zeros(4, np.float32), *parts.values()], axis=0)
    return largest


def _scales(largest: Floats) -> Doubles:
    """(CHANNELS,) the largest powers of two at which no sum of colours up to (4,) overflows."""
    bounds = np.ones(CHANNELS)
    bounds[:COVER] = np.where(largest > 0, largest, 1.0)
    _, exponent = np.frexp(bounds)
    scales: Doubles = np.ldexp(1.0, SUM_BITS - HEADROOM_BITS - exponent)
    return scales
