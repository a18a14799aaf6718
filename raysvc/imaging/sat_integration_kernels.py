"""Repeated integration of images that repeat, which keeps what it makes small and periodic."""

from raysvc.jit import kernel
from raysvc.types import Doubles


@kernel
def integrate_rows(values: Doubles, times: int, begin: int, end: int) -> None:
    """Integrate rows begin..end of `values` (R, W, C) along the row, in place, `times` over.

    The mean is taken out before every running sum, so that its last value is zero and the next
    period begins where this one did; and after the last, because it is of no use to anybody.
    """
    width, channels = values.shape[1], values.shape[2]
    for row in range(begin, end):
        for c in range(channels):
            for again in range(times + 1):
                total = 0.0
                for column in range(width):
                    total += values[row, column, c]
                mean = total / width
                running = 0.0
                for column in range(width):
                    value = values[row, column, c] - mean
                    running += value
                    values[row, column, c] = running if again < times else value


@kernel
def integrate_columns(values: Doubles, times: int, mean: Doubles, begin: int, end: int) -> None:
    """Integrate columns begin..end of `values` (H, N) down the column, in the same way.

    `mean` (N,) is working memory.
    """
    height = values.shape[0]
    for again in range(times + 1):
        for x in range(begin, end):
            mean[x] = 0.0
        for row in range(height):
            for x in range(begin, end):
                mean[x] += values[row, x]
        for x in range(begin, end):
            mean[x] /= height
            values[0, x] -= mean[x]
        for row in range(1, height):
            for x in range(begin, end):
                values[row, x] -= mean[x]
                if again < times:
                    values[row, x] += values[row - 1, x]
