"""Triangles to spans of pixels on scanlines, exactly.

Corners are snapped to 2^-15 pixel and edge functions (Pineda 1988, "A Parallel Algorithm for
Polygon Rasterization") are solved for each row in 64-bit integers, with the top-left rule: pixels
on a shared edge belong to exactly one of its triangles.
"""

from dataclasses import dataclass

import numpy as np

from raysvc.types import Bools, Doubles, Ints, Longs

SUBPIXEL_BITS = 15
"""With coordinates within 2^14 pixels, products of two edge lengths stay below 2^61."""
ONE = 1 << SUBPIXEL_BITS
HALF = ONE // 2


@dataclass(frozen=True, slots=True, eq=False)
class SetUp:
    """G triangles ready to be cut into rows, front side turned to positive area."""

    x: Longs
    """(G, 3) fixed-point pixels."""
    y: Longs
    """(G, 3) fixed-point pixels."""
    nearness: Doubles
    """(G, 3) linear in the picture and greater where nearer: 1 / w, or minus depth."""
    triangle: Ints
    """(G,) which triangle of the scene it is."""
    first_row: Longs
    """(G,) first row whose centre may be inside."""
    last_row: Longs
    """(G,) last such row."""


def set_up(
    corners: Doubles, triangle: Ints, double_sided: Bools, height: int, perspective: bool
) -> SetUp:
    """Snap clipped triangles (G, 3, 4) to fixed point; drop what is edge-on or seen from behind."""
    w = corners[:, :, 2]
    x = np.rint(corners[:, :, 0] / w * ONE).astype(np.int64)
    y = np.rint(corners[:, :, 1] / w * ONE).astype(np.int64)
    nearness = 1.0 / w if perspective else -corners[:, :, 3]
    area = (x[:, 1] - x[:, 0]) * (y[:, 2] - y[:, 0]) - (y[:, 1] - y[:, 0]) * (x[:, 2] - x[:, 0])
    # Counter-clockwise with y up, the front, has negative area where y grows downwards.
    flipped = area < 0
    first = np.maximum((y.min(axis=1) + HALF - 1) >> SUBPIXEL_BITS, 0)
    last = np.minimum((y.max(axis=1) - HALF) >> SUBPIXEL_BITS, height - 1)
    keep = np.flatnonzero((flipped | (double_sided & (area != 0))) & (first <= last))
    order = np.where(flipped[keep, None], np.array([0, 2, 1]), np.array([0, 1, 2]))
    rows = keep[:, None]
    return SetUp(
        x[rows, order],
        y[rows, order],
        nearness[rows, order],
        triangle[keep],
        first[keep],
        last[keep],
    )


@dataclass(frozen=True, slots=True, eq=False)
class Fragments:
    """N places where a triangle covers the centre of a pixel."""

    pixel: Longs
    """(N,) row * width + col."""
    triangle: Ints
    """(N,) which triangle of the scene."""
    key: np.ndarray[tuple[int], np.dtype[np.uint64]]
    """(N,) less is nearer: depth in the upper 32 bits, the triangle in the lower."""


def fragments(work: SetUp, first_row: int, last_row: int, width: int) -> Fragments:
    """Expand set-up triangles to the pixels of rows first_row..last_row (inclusive)."""
    chosen = np.flatnonzero((work.first_row <= last_row) & (work.last_row >= first_row))
    top = np.maximum(work.first_row[chosen], first_row)
    rows_of = np.minimum(work.last_row[chosen], last_row) - top + 1
    span = np.repeat(chosen, rows_of)
    row = _ragged_arange(rows_of) + np.repeat(top, rows_of)

    begin, end = _column_range(work, span, row, width)
    covered = np.flatnonzero(begin <= end)
    span, row, begin, end = span[covered], row[covered], begin[covered], end[covered]

    at_begin, per_column = _nearness_along(work, span, row, begin)
    columns_of = end - begin + 1
    step = _ragged_arange(columns_of)
    nearness = np.repeat(at_begin, columns_of) + np.repeat(per_column, columns_of) * step
    triangle = np.repeat(work.triangle[span], columns_of)
    pixel = np.repeat(row * width + begin, columns_of) + step
    return Fragments(pixel, triangle, _keys(nearness, triangle))


def _ragged_arange(counts: Longs) -> Longs:
    """0..c-1 for every count c, one after the other."""
    ends = np.cumsum(counts)
    total = int(ends[-1]) if len(ends) else 0
    return np.arange(total, dtype=np.int64) - np.repeat(ends - counts, counts)


def _column_range(work: SetUp, span: Longs, row: Longs, width: int) -> tuple[Longs, Longs]:
    """First and last column whose centre is inside all three edges, on one row each."""
    begin = np.zeros(len(span), np.int64)
    end = np.full(len(span), width - 1, np.int64)
    centre_y = row * ONE + HALF
    for k in range(3):
        x0, y0 = work.x[span, k], work.y[span, k]
        dx, dy = work.x[span, (k + 1) % 3] - x0, work.y[span, (k + 1) % 3] - y0
        # Inside is dx (y - y0) - dy (x - x0) >= 0 on top and left edges and > 0 on others.
        top_left = (dy < 0) | ((dy == 0) & (dx > 0))
        room = dx * (centre_y - y0) - dy * (HALF - x0) - np.where(top_left, 0, 1)
        slope = dy * ONE
        # Solve for the last column that slope times column lets stay within the room.
        divisor = np.where(slope == 0, 1, slope)
        quotient = room // divisor
        end = np.where(dy > 0, np.minimum(end, quotient), end)
        # A negative divisor turns the inequality round, and rounding up is negated rounding down.
        begin = np.where(dy < 0, np.maximum(begin, -(room // np.where(dy < 0, -slope, 1))), begin)
        end = np.where((dy == 0) & (room < 0), -1, end)
    return begin, end


def _nearness_along(work: SetUp, span: Longs, row: Longs, column: Longs) -> tuple[Doubles, Doubles]:
    """Nearness at the centre of (row, column), and its change per column."""
    x, y, q = work.x[span] / ONE, work.y[span] / ONE, work.nearness[span]
    x1, y1, q1 = x[:, 1] - x[:, 0], y[:, 1] - y[:, 0], q[:, 1] - q[:, 0]
    x2, y2, q2 = x[:, 2] - x[:, 0], y[:, 2] - y[:, 0], q[:, 2] - q[:, 0]
    area = x1 * y2 - y1 * x2
    per_column = (q1 * y2 - q2 * y1) / area
    per_row = (q2 * x1 - q1 * x2) / area
    there = q[:, 0] + per_column * (column + 0.5 - x[:, 0]) + per_row * (row + 0.5 - y[:, 0])
    return there, per_column


def _keys(nearness: Doubles, triangle: Ints) -> np.ndarray[tuple[int], np.dtype[np.uint64]]:
    """Keys that order like fragments: float bits of nearness upside down, then the triangle."""
    bits = nearness.astype(np.float32).view(np.int32)
    # Negative floats order the other way round: make signed integers that order like floats.
    ordered = np.where(bits < 0, bits ^ np.int32(0x7FFFFFFF), bits).astype(np.int64)
    return ((np.int64(0x7FFFFFFF) - ordered).astype(np.uint64) << np.uint64(32)) | triangle.astype(
        np.uint64
    )
