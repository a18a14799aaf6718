"""Lookups in summed-area tables (Crow 1984)."""

from raysvc.jit import inlined, kernel
from raysvc.types import Doubles, Floats


@inlined
def corner(table: Floats | Doubles, row: float, column: float, channel: int) -> float:
    """Sum above and left of a fractional position, which must lie within the image.

    Bilinear in the table: exact for an image of constant texels.
    """
    i = min(int(row), table.shape[0] - 2)
    j = min(int(column), table.shape[1] - 2)
    v, u = row - i, column - j
    above = table[i, j, channel] * (1.0 - u) + table[i, j + 1, channel] * u
    below = table[i + 1, j, channel] * (1.0 - u) + table[i + 1, j + 1, channel] * u
    result: float = above * (1.0 - v) + below * v
    return result


@kernel
def sum_boxes(table: Floats | Doubles, boxes: Doubles, sums: Doubles) -> None:
    """Write to `sums` (N, C) what `boxes` (N, 4) of top, left, bottom, right hold of the image."""
    height, width, channels = table.shape[0] - 1.0, table.shape[1] - 1.0, table.shape[2]
    for n in range(len(boxes)):
        top = min(max(boxes[n, 0], 0.0), height)
        left = min(max(boxes[n, 1], 0.0), width)
        bottom = min(max(boxes[n, 2], 0.0), height)
        right = min(max(boxes[n, 3], 0.0), width)
        for c in range(channels):
            sums[n, c] = (
                corner(table, bottom, right, c)
                - corner(table, top, right, c)
                - corner(table, bottom, left, c)
                + corner(table, top, left, c)
            )


@inlined
def _corner_rgb(
    tables: Doubles, which: int, row: float, column: float
) -> tuple[float, float, float]:
    """RGB sums above and left of a fractional position within the image."""
    i = min(int(row), tables.shape[1] - 2)
    j = min(int(column), tables.shape[2] - 2)
    v, u = row - i, column - j
    w00, w01, w10, w11 = (1.0 - v) * (1.0 - u), (1.0 - v) * u, v * (1.0 - u), v * u
    # Plain element reads: a view of a texel would count references, atomically
    return (
        w00 * tables[which, i, j, 0]
        + w01 * tables[which, i, j + 1, 0]
        + w10 * tables[which, i + 1, j, 0]
        + w11 * tables[which, i + 1, j + 1, 0],
        w00 * tables[which, i, j, 1]
        + w01 * tables[which, i, j + 1, 1]
        + w10 * tables[which, i + 1, j, 1]
        + w11 * tables[which, i + 1, j + 1, 1],
        w00 * tables[which, i, j, 2]
        + w01 * tables[which, i, j + 1, 2]
        + w10 * tables[which, i + 1, j, 2]
        + w11 * tables[which, i + 1, j + 1, 2],
    )


@inlined
def _column_rgb(
    tables: Doubles, which: int, top: float, bottom: float, column: float
) -> tuple[float, float, float]:
    """RGB sums left of a fractional column, between two fractional rows."""
    red, green, blue = _corner_rgb(tables, which, bottom, column)
    r, g, b = _corner_rgb(tables, which, top, column)
    return red - r, green - g, blue - b


@inlined
def periodic_box_rgb(
    tables: Doubles, which: int, top: float, bottom: float, left: float, wide: float
) -> tuple[float, float, float]:
    """RGB sum over a box of an image that repeats from left to right, S(x + W) = S(x) + S(W).

    Parameters
    ----------
    tables, which
        (K, H+1, W+1, 3), and which of the K tables
    top, bottom
        rows within 0..H
    left, wide
        left edge, within -W..2W, and width within 0..W, in texels
    """
    width = tables.shape[2] - 1.0
    if left < 0.0:
        left += width
    elif left >= width:
        left -= width
    right = left + wide
    red, green, blue = _column_rgb(tables, which, top, bottom, min(left, width))
    red, green, blue = -red, -green, -blue
    if right > width:
        right -= width
        r, g, b = _column_rgb(tables, which, top, bottom, width)
        red, green, blue = red + r, green + g, blue + b
    r, g, b = _column_rgb(tables, which, top, bottom, min(right, width))
    return red + r, green + g, blue + b
