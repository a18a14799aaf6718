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
