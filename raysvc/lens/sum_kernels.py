"""Kernels that turn drawn edges into pictures: running sums, mirrored borders, resampling."""

import numpy as np

from raysvc.jit import kernel
from raysvc.lens.sources import CHANNELS
from raysvc.types import Doubles, Floats, Longs


@kernel
def sum_along_rows(deltas: Longs) -> None:
    """Replace first differences along rows (rows, columns, CHANNELS) by their sums."""
    rows, columns, _ = deltas.shape
    running = np.zeros(CHANNELS, np.int64)
    for y in range(rows):
        running[:] = 0
        for x in range(columns):
            for c in range(CHANNELS):
                running[c] += deltas[y, x, c]
                deltas[y, x, c] = running[c]


@kernel
def sum_along_columns(deltas: Longs) -> None:
    """Replace first differences along columns (rows, columns, CHANNELS) by their sums."""
    rows, columns, _ = deltas.shape
    for y in range(1, rows):
        for x in range(columns):
            for c in range(CHANNELS):
                deltas[y, x, c] += deltas[y - 1, x, c]


@kernel
def fold(
    sums: Longs, unit: Doubles, height: int, above: int, left: int, first: int, out: Floats
) -> None:
    """Add what was drawn to rows of a picture, mirrored at its borders.

    What was spread beyond a border comes back: nothing is lost, and an even picture stays even.

    sums: (rows, columns, CHANNELS) int64, whose first row and column are row `above` and column
    `left` of the picture, perhaps beyond it; added to. unit: (CHANNELS,) value of a fixed point
    step. height: of the picture. out: (R, W, CHANNELS) float32, rows first..first+R, added to.
    """
    rows, width, _ = out.shape
    columns = sums.shape[1]
    for y in range(first, first + rows):
        line = sums[y - above]
        for beyond in (-1 - y, 2 * height - 1 - y):
            if above <= beyond < above + len(sums) and not 0 <= beyond < height:
                other = sums[beyond - above]
                for x in range(columns):
                    for c in range(CHANNELS):
                        line[x, c] += other[x, c]
        for x in range(left, min(left + columns, 0)):
            for c in range(CHANNELS):
                line[-1 - x - left, c] += line[x - left, c]
        for x in range(max(left, width), left + columns):
            for c in range(CHANNELS):
                line[2 * width - 1 - x - left, c] += line[x - left, c]
        for x in range(max(left, 0), min(left + columns, width)):
            for c in range(CHANNELS):
                out[y - first, x, c] += np.float32(line[x - left, c] * unit[c])


@kernel
def enlarge(
    coarse: Floats, top: int, height: int, level: int, first: int, begin: int, end: int, out: Floats
) -> None:
    """Add rows of a picture 2^level times as large, bilinearly.

    coarse: (rows, W / 2^level rounded up, CHANNELS) float32, whose first row is row `top` of a
    picture of `height` rows. out: (R, W, CHANNELS) float32, rows first..first+R of the large
    picture; only columns begin..end are looked at.
    """
    rows, _, _ = out.shape
    last_column = coarse.shape[1] - 1
    # Places in units of half a pixel of the large picture, so that they are whole numbers
    bits, half = level + 1, 1 << level
    unit = np.float32(1.0 / (1 << bits))
    between = np.empty(coarse.shape[1:], np.float32)
    flat = between.reshape(-1)
    from_ = max((2 * begin + 1 - half) >> bits, 0) * CHANNELS
    to_ = min(((2 * end - 1 - half) >> bits) + 2, last_column + 1) * CHANNELS
    for y in range(rows):
        # Down the columns first, in one run without branches
        place = 2 * (first + y) + 1 - half
        up = place >> bits
        lower_part = np.float32(place - (up << bits)) * unit
        upper_part = np.float32(1.0) - lower_part
        upper = coarse[max(up, 0) - top].reshape(-1)
        lower = coarse[min(up + 1, height - 1) - top].reshape(-1)
        for i in range(from_, to_):
            flat[i] = upper_part * upper[i] + lower_part * lower[i]
        for x in range(begin, end):
            place = 2 * x + 1 - half
            column = place >> bits
            right_part = np.float32(place - (column << bits)) * unit
            left_part = np.float32(1.0) - right_part
            one, two = max(column, 0) * CHANNELS, min(column + 1, last_column) * CHANNELS
            for c in range(CHANNELS):
                out[y, x, c] += left_part * flat[one + c] + right_part * flat[two + c]
