"""Kernels of drawing apertures: of every row of a shape its two edges, before one running sum.

As in `raysvc.lens.box_kernels` sums are 64-bit whole numbers that may wrap.
"""

import numpy as np

from raysvc.jit import inlined, kernel
from raysvc.lens.aperture import STEPS_PER_PX, SUBPIXEL_BITS, Stamps
from raysvc.lens.sources import CHANNELS, Sources
from raysvc.types import Doubles, Longs

ONE = 1 << SUBPIXEL_BITS


@kernel
def draw_apertures(
    sources: Sources,
    stamps: Stamps,
    scale: Doubles,
    reach: int,
    left: int,
    first: int,
    last: int,
    deltas: Longs,
) -> None:
    """Add what sources spread over rows first..last, which may lie beyond the picture.

    scale: (CHANNELS,) fixed point steps per unit. reach: rows that a shape goes from its centre.
    left: column of the picture, perhaps beyond it, of the first of deltas: (rows, columns,
    CHANNELS) int64, first differences along rows, added to.
    """
    height = len(sources.begin)
    density = np.zeros(CHANNELS, np.int64)
    flat = deltas.reshape(-1)
    columns = deltas.shape[1]
    for y in range(max(0, first - reach), min(height, last + reach)):
        for i in range(sources.begin[y], sources.end[y]):
            size = sources.size_px[i]
            q = int(abs(size) * STEPS_PER_PX + 0.5)
            if size < 0.0:
                q += stamps.flipped
            share = 1.0 / (stamps.area_px[q] * ONE)
            for c in range(CHANNELS):
                density[c] = int(sources.values[i, c] * scale[c] * share)
            top = y + stamps.first[q]
            middle = (int(sources.column[i]) - left) << SUBPIXEL_BITS
            for row in range(max(top, first), min(top + stamps.rows[q], last)):
                begin = middle + stamps.begin[q, row - top]
                end = middle + stamps.end[q, row - top]
                add_span(flat, (row - first) * columns, density, begin, end)


@inlined
def add_span(flat: Longs, line: int, density: Longs, begin: int, end: int) -> None:
    """Add ONE times `density` (CHANNELS,) from `begin` to `end`, in 1/ONE pixel, on a line.

    flat: all pixels after each other, `line` that of column 0. Of an edge within a pixel that pixel
    gets what is covered of it, and the next one the rest: together they are exact.
    """
    at = (line + (begin >> SUBPIXEL_BITS)) * CHANNELS
    edge = flat[at : at + 2 * CHANNELS]
    later = begin & (ONE - 1)
    for c in range(CHANNELS):
        edge[c] += density[c] * (ONE - later)
    for c in range(CHANNELS):
        edge[CHANNELS + c] += density[c] * later
    at = (line + (end >> SUBPIXEL_BITS)) * CHANNELS
    edge = flat[at : at + 2 * CHANNELS]
    later = end & (ONE - 1)
    for c in range(CHANNELS):
        edge[c] -= density[c] * (ONE - later)
    for c in range(CHANNELS):
        edge[CHANNELS + c] -= density[c] * later
