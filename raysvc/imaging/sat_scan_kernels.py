"""Steps of summed-area tables by scans: down the columns, transposition, resolving of strips.

A scan down the columns adds whole rows to each other, which is what vector units are for; a scan
along the rows is one down the columns of the transposed image.
"""

from raysvc.jit import kernel
from raysvc.types import Doubles, Floats

TILE = 16
"""Side in texels of what is transposed at a time: its rows, read and written, stay in the cache."""


@kernel
def scan_down(source: Floats | Doubles, target: Floats | Doubles, begin: int, end: int) -> None:
    """Write to columns begin..end of `target` the sums of `source` down to every row.

    Both are (R, N), or the same; the order of additions is from the top.
    """
    for x in range(begin, end):
        target[0, x] = source[0, x]
    for row in range(1, source.shape[0]):
        for x in range(begin, end):
            target[row, x] = target[row - 1, x] + source[row, x]


@kernel
def transpose(
    source: Floats | Doubles, target: Floats | Doubles, first: int, begin: int, end: int
) -> None:
    """Write rows begin..end of `source` (R, Q, C) as columns of `target`.

    What is in the source's corner goes to row and column `first` of the target.
    """
    columns, channels = source.shape[1], source.shape[2]
    for top in range(begin, end, TILE):
        for left in range(0, columns, TILE):
            for column in range(left, min(left + TILE, columns)):
                for row in range(top, min(top + TILE, end)):
                    for c in range(channels):
                        target[column + first, row + first, c] = source[row, column, c]


@kernel
def add_to_rows(table: Floats | Doubles, offset: Floats | Doubles, begin: int, end: int) -> None:
    """Add `offset` (N,) to rows begin..end of `table` (R, N)."""
    for row in range(begin, end):
        for x in range(table.shape[1]):
            table[row, x] += offset[x]
