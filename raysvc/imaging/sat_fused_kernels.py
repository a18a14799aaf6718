"""Summed-area tables in one pass: a running sum along the row, added to the row above.

Every texel is read once and every entry written once. The columns may be cut into lanes, each of
which takes the rows' running sums over from the lane to its left: the additions are the same in the
same order, so that a table does not depend on the lanes.
"""

from raysvc.jit import kernel
from raysvc.types import Doubles, Floats


@kernel
def accumulate(
    image: Floats | Doubles,
    table: Floats | Doubles,
    running: Floats | Doubles,
    rows: tuple[int, int],
    columns: tuple[int, int],
) -> None:
    """Fill entries below and right of some rows and columns of an image, of any channels.

    Parameters
    ----------
    image, table
        (H, W, C), and (H+1, W+1, C) with what is above and left of those entries filled
    running
        (H, C) of the table's dtype: sums of every row up to the first column; moved to the last one
    rows, columns
        begin and end
    """
    channels = image.shape[2]
    for row in range(rows[0], rows[1]):
        for column in range(columns[0], columns[1]):
            for c in range(channels):
                running[row, c] += image[row, column, c]
                table[row + 1, column + 1, c] = table[row, column + 1, c] + running[row, c]


@kernel
def accumulate_rgb(
    image: Floats | Doubles,
    table: Floats | Doubles,
    running: Floats | Doubles,
    rows: tuple[int, int],
    columns: tuple[int, int],
) -> None:
    """Do as `accumulate` does, to the same bits, three channels and two rows at a time.

    Six sums stay in registers, no addition waits for the one before it, and the row above is read
    for two rows at once.
    """
    row = rows[0]
    while row + 1 < rows[1]:
        r0, g0, b0 = running[row, 0], running[row, 1], running[row, 2]
        r1, g1, b1 = running[row + 1, 0], running[row + 1, 1], running[row + 1, 2]
        for column in range(columns[0], columns[1]):
            r0 += image[row, column, 0]
            g0 += image[row, column, 1]
            b0 += image[row, column, 2]
            r1 += image[row + 1, column, 0]
            g1 += image[row + 1, column, 1]
            b1 += image[row + 1, column, 2]
            red = table[row, column + 1, 0] + r0
            green = table[row, column + 1, 1] + g0
            blue = table[row, column + 1, 2] + b0
            table[row + 1, column + 1, 0] = red
            table[row + 1, column + 1, 1] = green
            table[row + 1, column + 1, 2] = blue
            table[row + 2, column + 1, 0] = red + r1
            table[row + 2, column + 1, 1] = green + g1
            table[row + 2, column + 1, 2] = blue + b1
        running[row, 0], running[row, 1], running[row, 2] = r0, g0, b0
        running[row + 1, 0], running[row + 1, 1], running[row + 1, 2] = r1, g1, b1
        row += 2
    if row < rows[1]:
        accumulate(image, table, running, (row, rows[1]), columns)


@kernel
def accumulate_first(image: Floats | Doubles, table: Floats | Doubles, row: int) -> None:
    """Fill the entries below one row of an image as if it were the first one."""
    for c in range(image.shape[2]):
        table[row + 1, 0, c] = 0.0
        for column in range(image.shape[1]):
            table[row + 1, column + 1, c] = table[row + 1, column, c] + image[row, column, c]
