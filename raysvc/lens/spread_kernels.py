"""Kernels of spreading: a square is its corners before two running sums.

Four corners of one number each, or of 2 x 2 if the edges lie within pixels. Sums are 64-bit whole
numbers. They wrap, which does no harm as long as the final value fits; they do not depend on the
order of addition; and the deltas of a square add up to exactly nothing along every row and column,
so that no streak is left beyond it however large the numbers are.
"""

from raysvc.jit import inlined, kernel
from raysvc.types import Floats, Longs


@inlined
def add_box(deltas: Longs, density: int, x0: float, x1: float, y0: float, y1: float) -> None:
    """Add `density` (int64) over [x0, x1) x [y0, y1), pixel coordinates, to second differences."""
    left, right, top, bottom = int(x0), int(x1), int(y0), int(y1)

    # A first split shares the density among the two columns of each edge, so that the four cancel.
    c0 = int(density * (left + 1 - x0))
    c1 = density - c0
    c2 = -int(density * (right + 1 - x1))
    c3 = -density - c2

    # The second shares each column among two rows; the last entry closes the row.
    share = top + 1 - y0
    t0, t1, t2 = int(c0 * share), int(c1 * share), int(c2 * share)
    t3 = -(t0 + t1 + t2)
    share = bottom + 1 - y1
    b0, b1, b2 = int(c0 * share), int(c1 * share), int(c2 * share)
    b3 = -(b0 + b1 + b2)

    deltas[top, left] += t0
    deltas[top, left + 1] += t1
    deltas[top, right] += t2
    deltas[top, right + 1] += t3
    deltas[top + 1, left] += c0 - t0
    deltas[top + 1, left + 1] += c1 - t1
    deltas[top + 1, right] += c2 - t2
    deltas[top + 1, right + 1] += c3 - t3
    deltas[bottom, left] -= b0
    deltas[bottom, left + 1] -= b1
    deltas[bottom, right] -= b2
    deltas[bottom, right + 1] -= b3
    deltas[bottom + 1, left] -= c0 - b0
    deltas[bottom + 1, left + 1] -= c1 - b1
    deltas[bottom + 1, right] -= c2 - b2
    deltas[bottom + 1, right + 1] -= c3 - b3


@inlined
def piece(begin: float, end: float, size: float, which: int) -> tuple[float, float]:
    """Part of [begin, end) within 0..size: 0 directly, 1 mirrored at 0, 2 mirrored at size."""
    if which == 0:
        return max(begin, 0.0), min(end, size)
    if which == 1:
        return 0.0, -begin
    return 2.0 * size - end, size


@kernel
def add_squares(
    values: Floats, membership: Floats, side: Floats, scale: float, deltas: Longs
) -> None:
    """Spread every pixel into a square around it, as second differences.

    values, membership, side: (H, W) float32; side at most 2 min(H, W); membership 0 skips a pixel.
    scale: fixed point steps per unit. deltas: (H + 2, W + 2) int64, added to. What would fall
    outside of the picture is mirrored at its border: nothing is lost, a constant stays constant.
    """
    height, width = values.shape
    for y in range(height):
        for x in range(width):
            share = membership[y, x]
            if share == 0.0:
                continue
            extent = float(side[y, x])
            density = int(scale * values[y, x] * share / (extent * extent))
            if density == 0:
                continue
            half = 0.5 * extent
            x0, x1, y0, y1 = x + 0.5 - half, x + 0.5 + half, y + 0.5 - half, y + 0.5 + half
            if x0 >= 0.0 and x1 <= width and y0 >= 0.0 and y1 <= height:
                add_box(deltas, density, x0, x1, y0, y1)
                continue
            for i in range(3):
                begin_y, end_y = piece(y0, y1, float(height), i)
                if begin_y >= end_y:
                    continue
                for j in range(3):
                    begin_x, end_x = piece(x0, x1, float(width), j)
                    if begin_x < end_x:
                        add_box(deltas, density, begin_x, end_x, begin_y, end_y)


@kernel
def integrate(deltas: Longs, scale: float, column: Longs, out: Floats) -> None:
    """Sum second differences (H + 2, W + 2) int64 along both axes into out (H, W) float32.

    deltas: zero on return, ready for another picture. column: (W,) int64 zeros, working space.
    """
    height, width = out.shape
    unit = 1.0 / scale
    for y in range(height):
        running = 0
        for x in range(width):
            running += deltas[y, x]
            column[x] += running
            out[y, x] = column[x] * unit
        deltas[y] = 0
    deltas[height:] = 0


@kernel
def lay_over(
    sums: Floats, gain: float, first: int, last: int, picture: Floats, known: Floats
) -> None:
    """Lay rows first..last of a spread slice over what is behind it.

    sums: (4 or 5, H, W) float32: premultiplied colour, alpha, weight; when four, weight is alpha.
    picture: (H, W, 4) float32 and known: (H, W) float32, changed in place: what is behind, and how
    much is known of it (0 nothing, 1 all). The slice covers by its weight, up to 1. Where less than
    all is known behind, the missing part is left out and the rest made up to one.
    gain: knowledge per weight.
    """
    width = picture.shape[1]
    for y in range(first, last):
        for x in range(width):
            w = sums[-1, y, x]
            if w <= 0.0:
                continue
            cover = min(w, 1.0)
            rest = (1.0 - cover) * known[y, x]
            front_share = cover / (w * (cover + rest))
            back_share = rest / (cover + rest)
            for c in range(4):
                picture[y, x, c] = sums[c, y, x] * front_share + picture[y, x, c] * back_share
            known[y, x] = max(known[y, x], min(1.0, gain * w))
