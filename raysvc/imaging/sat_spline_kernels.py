"""Lookups in summed-area tables of order 1, 2 and 3, in an image that repeats in both axes.

A box convolved n times with itself is a B-spline filter. Its n-th derivative is n + 1 points, and
so the filtered image is a few points of the image integrated n times (Heckbert 1986). Of texels
that are constant, that integral is a spline between the entries of the table: S(i + t) is the sum
of n + 1 entries from i on, weighted by the B-spline of degree n at t. So fractional places and
widths are exact at every order. (Entries of lower orders, S_n(x + t) = sum of S_(n-k)(x) t^k / k!,
give the same from as many reads, but in n + 1 tables.)

A lookup is a weighted sum over rows of weighted sums over columns. Elements are read one by one: a
view of a texel would count references, atomically.
"""

import numpy as np

from raysvc.jit import inlined, kernel
from raysvc.types import Doubles

Colour = tuple[float, float, float]
BoxEnd = tuple[int, float, float, float]
"""An entry's number, weights of it and the next one, whole periods before it."""
TentPoint = tuple[int, float, float, float]
"""An entry's number, weights of it and the next two."""
QuadraticPoint = tuple[int, float, float, float, float]
"""An entry's number, weights of it and the next three."""


@inlined
def _box_end(x: float, length: int, weight: float) -> BoxEnd:
    periods = np.floor(x / length)
    x -= length * periods
    i = min(int(x), length - 1)
    t = x - i
    return i, weight * (1.0 - t), weight * t, weight * periods


@inlined
def _box_row(
    tables: Doubles, which: int, row: int, left: BoxEnd, right: BoxEnd, periods: float
) -> Colour:
    """RGB between two columns of one row of entries."""
    i, i0, i1, _ = left
    j, j0, j1, _ = right
    red = i0 * tables[which, row, i, 0] + i1 * tables[which, row, i + 1, 0]
    green = i0 * tables[which, row, i, 1] + i1 * tables[which, row, i + 1, 1]
    blue = i0 * tables[which, row, i, 2] + i1 * tables[which, row, i + 1, 2]
    red += j0 * tables[which, row, j, 0] + j1 * tables[which, row, j + 1, 0]
    green += j0 * tables[which, row, j, 1] + j1 * tables[which, row, j + 1, 1]
    blue += j0 * tables[which, row, j, 2] + j1 * tables[which, row, j + 1, 2]
    if periods != 0.0:
        last = tables.shape[2] - 1
        red += periods * tables[which, row, last, 0]
        green += periods * tables[which, row, last, 1]
        blue += periods * tables[which, row, last, 2]
    return red, green, blue


@inlined
def box_mean_rgb(
    tables: Doubles, which: int, row: float, column: float, half_rows: float, half_columns: float
) -> Colour:
    """RGB mean over a box of any size and place, in texels from the image's corner.

    Parameters
    ----------
    tables, which
        (K, H+1, W+1, 3) as `summed_area_table` makes them, and which of the K
    row, column, half_rows, half_columns
        the box's centre, and half of its height and width, which must be positive
    """
    height, width = tables.shape[1] - 1, tables.shape[2] - 1
    left = _box_end(column - half_columns, width, -0.5 / half_columns)
    right = _box_end(column + half_columns, width, 0.5 / half_columns)
    top = _box_end(row - half_rows, height, -0.5 / half_rows)
    bottom = _box_end(row + half_rows, height, 0.5 / half_rows)
    # Beyond its edge the table goes on as S(x + W) = S(x) + S(W)
    across, down = left[3] + right[3], top[3] + bottom[3]
    r0, g0, b0 = _box_row(tables, which, top[0], left, right, across)
    r1, g1, b1 = _box_row(tables, which, top[0] + 1, left, right, across)
    r2, g2, b2 = _box_row(tables, which, bottom[0], left, right, across)
    r3, g3, b3 = _box_row(tables, which, bottom[0] + 1, left, right, across)
    red = top[1] * r0 + top[2] * r1 + bottom[1] * r2 + bottom[2] * r3
    green = top[1] * g0 + top[2] * g1 + bottom[1] * g2 + bottom[2] * g3
    blue = top[1] * b0 + top[2] * b1 + bottom[1] * b2 + bottom[2] * b3
    if down != 0.0:
        r0, g0, b0 = _box_row(tables, which, height, left, right, across)
        red, green, blue = red + down * r0, green + down * g0, blue + down * b0
    return red, green, blue


@inlined
def _tent_point(x: float, length: int, weight: float) -> TentPoint:
    x -= length * np.floor(x / length)
    i = min(int(x), length - 1)
    t = x - i
    late = 0.5 * t * t
    early = late - t + 0.5
    return i, weight * early, weight * (1.0 - early - late), weight * late


@inlined
def _tent_at(tables: Doubles, which: int, row: int, at: TentPoint) -> Colour:
    i, a, b, c = at
    return (
        a * tables[which, row, i, 0]
        + b * tables[which, row, i + 1, 0]
        + c * tables[which, row, i + 2, 0],
        a * tables[which, row, i, 1]
        + b * tables[which, row, i + 1, 1]
        + c * tables[which, row, i + 2, 1],
        a * tables[which, row, i, 2]
        + b * tables[which, row, i + 1, 2]
        + c * tables[which, row, i + 2, 2],
    )


@inlined
def _tent_row(
    tables: Doubles, which: int, row: int, left: TentPoint, middle: TentPoint, right: TentPoint
) -> Colour:
    """RGB of one row of entries."""
    r0, g0, b0 = _tent_at(tables, which, row, left)
    r1, g1, b1 = _tent_at(tables, which, row, middle)
    r2, g2, b2 = _tent_at(tables, which, row, right)
    return r0 + r1 + r2, g0 + g1 + g2, b0 + b1 + b2


@inlined
def tent_mean_rgb(
    tables: Doubles, which: int, row: float, column: float, half_rows: float, half_columns: float
) -> Colour:
    """RGB mean under a tent, a box convolved with itself, of any size and place.

    Takes what `box_mean_rgb` takes, but tables (K, H+3, W+3, 3) as `integrated` makes them for
    order 2; the halves are those of the box: the tent reaches twice as far.
    """
    height, width = tables.shape[1] - 3, tables.shape[2] - 3
    tall, wide = 2.0 * half_rows, 2.0 * half_columns
    share = 1.0 / (wide * wide)
    left = _tent_point(column - wide, width, share)
    middle = _tent_point(column, width, -2.0 * share)
    right = _tent_point(column + wide, width, share)
    # The last row holds what depends on the column only, the last column what on the row only
    red, green, blue = _tent_row(tables, which, height + 2, left, middle, right)
    red += tables[which, height + 2, width + 2, 0]
    green += tables[which, height + 2, width + 2, 1]
    blue += tables[which, height + 2, width + 2, 2]
    share = 1.0 / (tall * tall)
    for k in range(3):
        weight = -2.0 * share if k == 1 else share
        i, w0, w1, w2 = _tent_point(row + (k - 1) * tall, height, weight)
        for n in range(3):
            weight = w0 if n == 0 else w1 if n == 1 else w2
            r, g, b = _tent_row(tables, which, i + n, left, middle, right)
            red += weight * (r + tables[which, i + n, width + 2, 0])
            green += weight * (g + tables[which, i + n, width + 2, 1])
            blue += weight * (b + tables[which, i + n, width + 2, 2])
    return red, green, blue


@inlined
def _quadratic_point(x: float, length: int, weight: float) -> QuadraticPoint:
    x -= length * np.floor(x / length)
    i = min(int(x), length - 1)
    t = x - i
    s = 1.0 - t
    weight *= 1.0 / 6.0
    early, late = s * s * s, t * t * t
    second = 3.0 * late - 6.0 * t * t + 4.0
    third = 3.0 * early - 6.0 * s * s + 4.0
    return i, weight * early, weight * second, weight * third, weight * late


@inlined
def _quadratic_at(tables: Doubles, which: int, row: int, at: QuadraticPoint) -> Colour:
    i, a, b, c, d = at
    return (
        a * tables[which, row, i, 0]
        + b * tables[which, row, i + 1, 0]
        + c * tables[which, row, i + 2, 0]
        + d * tables[which, row, i + 3, 0],
        a * tables[which, row, i, 1]
        + b * tables[which, row, i + 1, 1]
        + c * tables[which, row, i + 2, 1]
        + d * tables[which, row, i + 3, 1],
        a * tables[which, row, i, 2]
        + b * tables[which, row, i + 1, 2]
        + c * tables[which, row, i + 2, 2]
        + d * tables[which, row, i + 3, 2],
    )


@inlined
def _quadratic_row(
    tables: Doubles,
    which: int,
    row: int,
    points: tuple[QuadraticPoint, QuadraticPoint, QuadraticPoint, QuadraticPoint],
) -> Colour:
    """RGB of one row of entries."""
    r0, g0, b0 = _quadratic_at(tables, which, row, points[0])
    r1, g1, b1 = _quadratic_at(tables, which, row, points[1])
    r2, g2, b2 = _quadratic_at(tables, which, row, points[2])
    r3, g3, b3 = _quadratic_at(tables, which, row, points[3])
    return r0 + r1 + r2 + r3, g0 + g1 + g2 + g3, b0 + b1 + b2 + b3


@inlined
def quadratic_mean_rgb(
    tables: Doubles, which: int, row: float, column: float, half_rows: float, half_columns: float
) -> Colour:
    """RGB mean under a quadratic B-spline, three boxes convolved, of any size and place.

    Takes what `box_mean_rgb` takes, but tables (K, H+4, W+4, 3) as `integrated` makes them for
    order 3; the halves are those of the box: the filter reaches three times as far.
    """
    height, width = tables.shape[1] - 4, tables.shape[2] - 4
    tall, wide = 2.0 * half_rows, 2.0 * half_columns
    share = 1.0 / (wide * wide * wide)
    across = (
        _quadratic_point(column - 1.5 * wide, width, -share),
        _quadratic_point(column - 0.5 * wide, width, 3.0 * share),
        _quadratic_point(column + 0.5 * wide, width, -3.0 * share),
        _quadratic_point(column + 1.5 * wide, width, share),
    )
    red, green, blue = _quadratic_row(tables, which, height + 3, across)
    red += tables[which, height + 3, width + 3, 0]
    green += tables[which, height + 3, width + 3, 1]
    blue += tables[which, height + 3, width + 3, 2]
    share = 1.0 / (tall * tall * tall)
    for k in range(4):
        weight = share if k == 0 or k == 3 else 3.0 * share
        weight = weight if k % 2 else -weight
        i, w0, w1, w2, w3 = _quadratic_point(row + (k - 1.5) * tall, height, weight)
        for n in range(4):
            weight = w0 if n == 0 else w1 if n == 1 else w2 if n == 2 else w3
            r, g, b = _quadratic_row(tables, which, i + n, across)
            red += weight * (r + tables[which, i + n, width + 3, 0])
            green += weight * (g + tables[which, i + n, width + 3, 1])
            blue += weight * (b + tables[which, i + n, width + 3, 2])
    return red, green, blue


@kernel
def read_means(
    tables: Doubles, order: int, filters: Doubles, means: Doubles, begin: int, end: int
) -> None:
    """Write means (N, 3) under filters begin..end (N, 4): row, column, half rows, half columns."""
    for n in range(begin, end):
        row, column, half_rows, half_columns = (
            filters[n, 0],
            filters[n, 1],
            filters[n, 2],
            filters[n, 3],
        )
        if order == 1:
            colour = box_mean_rgb(tables, 0, row, column, half_rows, half_columns)
        elif order == 2:
            colour = tent_mean_rgb(tables, 0, row, column, half_rows, half_columns)
        else:
            colour = quadratic_mean_rgb(tables, 0, row, column, half_rows, half_columns)
        means[n, 0], means[n, 1], means[n, 2] = colour
