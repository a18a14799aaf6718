"""Kernels of drawing boxes, of order 1 to 3: corners only, before running sums along both axes.

Sums are 64-bit whole numbers. They wrap, which does no harm as long as the final value fits; they
do not depend on the order of addition; and what is drawn cancels to exactly nothing beyond its box,
so that no streak is left however large the numbers are.

A box of order n is a box of width w folded n times with itself (Heckbert 1986, "Filtering by
repeated integration"): (n + 1)^2 numbers with the signs and sizes of binomial coefficients. They
cancel exactly if w and the density are whole numbers. A width in between is drawn as two boxes of
the next odd widths, mixed so that the variance is the one that was asked for.
"""

import math

import numpy as np

from raysvc.jit import inlined, kernel
from raysvc.lens.aperture import SUBPIXEL_BITS
from raysvc.lens.aperture_kernels import ONE, add_span
from raysvc.lens.sources import CHANNELS, Sources
from raysvc.types import Doubles, Floats, Longs

SIDE_PER_DIAMETER = math.sqrt(3.0) / 2.0
"""A square of this side has the variance of a disc of diameter 1: side^2 / 12 = diameter^2 / 16."""


def half_side_px(coc_px: Floats) -> Doubles:
    """Half the side that `draw_boxes` gives to squares of diameters (...), on 1/64 pixel."""
    half: Doubles = np.floor(np.abs(coc_px) * (0.5 * SIDE_PER_DIAMETER * ONE) + 0.5) / ONE
    return half


@kernel
def draw_boxes(
    sources: Sources,
    scale: Doubles,
    reach: int,
    left: int,
    first: int,
    last: int,
    deltas: Longs,
) -> None:
    """Add boxes of order 1 over rows first..last, which may lie beyond the picture.

    Edges lie on 1/64 pixel: of pixels that a box covers in part, the part is exact. Boxes that go
    beyond the rows are cut off there. Parameters as of `draw_apertures`; deltas: (rows + 2,
    columns, CHANNELS), first differences along rows and columns.
    """
    height = len(sources.begin)
    density = np.zeros(CHANNELS, np.int64)
    weighted = np.zeros(CHANNELS, np.int64)
    flat = deltas.reshape(-1)
    columns = deltas.shape[1]
    least, most = 0, (last - first) << SUBPIXEL_BITS
    for y in range(max(0, first - reach), min(height, last + reach)):
        for i in range(sources.begin[y], sources.end[y]):
            half = int(abs(sources.size_px[i]) * (0.5 * SIDE_PER_DIAMETER * ONE) + 0.5)
            middle = ((y - first) << SUBPIXEL_BITS) + ONE // 2
            top, bottom = max(middle - half, least), min(middle + half, most)
            if top >= bottom:
                continue
            middle = ((int(sources.column[i]) - left) << SUBPIXEL_BITS) + ONE // 2
            share = 1.0 / (4.0 * half * half)
            for c in range(CHANNELS):
                density[c] = int(sources.values[i, c] * scale[c] * share)
            for edge in range(2):
                at = top if edge == 0 else bottom
                sign = 1 if edge == 0 else -1
                later = at & (ONE - 1)
                for step in range(2):
                    weight = sign * (later if step == 1 else ONE - later)
                    if weight == 0:
                        continue
                    for c in range(CHANNELS):
                        weighted[c] = density[c] * weight
                    line = ((at >> SUBPIXEL_BITS) + step) * columns
                    add_span(flat, line, weighted, middle - half, middle + half)


@inlined
def odd_width(diameter_px: float, order: int) -> tuple[int, float]:
    """The odd width w, and how much of the box of width w + 2 makes up the variance.

    `order` boxes of whole width w have the variance order (w^2 - 1) / 12, a disc d^2 / 16.
    """
    square = 0.75 * diameter_px * diameter_px / order + 1.0
    width = int(math.sqrt(square))
    width -= 1 - width % 2
    # Rounding may have put the root of a square just below it.
    if (width + 2) * (width + 2) <= square:
        width += 2
    return width, (square - width * width) / (4.0 * width + 4.0)


@kernel
def draw_smooth_boxes(
    sources: Sources,
    order: int,
    scale: Doubles,
    reach: int,
    left: int,
    first: int,
    last: int,
    deltas: Longs,
) -> None:
    """Add boxes of order 2 or 3 that begin and end within rows first..last.

    Those that a row needs are all drawn if `first` lies 2 reach or more above it. Parameters as of
    `draw_boxes`; deltas: (rows, columns, CHANNELS), `order`-fold differences.
    """
    height = len(sources.begin)
    density = np.zeros(CHANNELS, np.int64)
    sign = np.zeros(order + 1, np.int64)
    sign[0] = 1
    for i in range(1, order + 1):
        sign[i] = -sign[i - 1] * (order + 1 - i) // i
    for y in range(max(0, first + reach), min(height, last - reach)):
        for i in range(sources.begin[y], sources.end[y]):
            width, wider = odd_width(abs(sources.size_px[i]), order)
            for w, part in ((width, 1.0 - wider), (width + 2, wider)):
                if part <= 0.0:
                    continue
                share = part / float(w) ** (2 * order)
                for c in range(CHANNELS):
                    density[c] = math.floor(sources.values[i, c] * scale[c] * share + 0.5)
                half = order * (w - 1) // 2
                for j in range(order + 1):
                    line = deltas[y - first - half + j * w]
                    start = sources.column[i] - left - half
                    for k in range(order + 1):
                        times = sign[j] * sign[k]
                        corner = line[start + k * w]
                        for c in range(CHANNELS):
                            corner[c] += times * density[c]
