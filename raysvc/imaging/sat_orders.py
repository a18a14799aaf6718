"""Summed-area tables of higher order: B-spline filters of any size for a fixed number of reads.

Repeated integration (Heckbert 1986) of an image that repeats in both axes. An image integrated
twice or three times over grows fast, and filters are small differences of large numbers; so the
image is split into its mean, what depends on the row only, on the column only, and the rest, whose
every row and column has mean zero. Their integrals are periodic too: they do not grow from period
to period, need no special case at an edge, and cancel less. See docs/summed_area_tables.md.
"""

from typing import Final

import numpy as np

from raysvc.errors import InvalidSetting
from raysvc.imaging.sat import BuiltTable, build_table
from raysvc.imaging.sat_integration_kernels import integrate_columns, integrate_rows
from raysvc.imaging.sat_spline_kernels import read_means
from raysvc.parallel import Control, for_chunks
from raysvc.types import Doubles, Floats, Longs

ORDERS: Final = (1, 2, 3)
CHUNK_ROWS = 16
CHUNK_VALUES = 512
CHUNK_LOOKUPS = 4096


def integrated(
    image: Floats | Doubles,
    order: int,
    control: Control | None = None,
    builder: str = "fused",
) -> Doubles:
    """Make the table for B-spline filters of an order.

    Parameters
    ----------
    image
        (H, W, 3) float32 or float64 that repeats in both axes
    order
        1 box, 2 tent, 3 quadratic: how many boxes the filter is convolved of
    control
        threads and stopping, one thread by default; the bits are the same with any number
    builder
        one of `sat_builders.BUILDERS`, which sums the image as often as the order says; of orders
        above 1 they agree to rounding

    Returns
    -------
    Of order 1 the table (H+1, W+1, 3) that `summed_area_table` makes. Of order n > 1
    (H+n+1, W+n+1, 3) float64, read by `tent_mean_rgb` and `quadratic_mean_rgb`: entry (i, j) of the
    first H+n rows and W+n columns is the n-fold sum of the rest up to texel (i-n, j-n), inclusive;
    the last column holds that of what depends on the row only, the last row that of what depends on
    the column only, and the last entry the mean. Raises InvalidSetting.
    """
    table: Doubles = build_integrated(image, order, control, builder).table
    return table


def build_integrated(
    image: Floats | Doubles,
    order: int,
    control: Control | None = None,
    builder: str = "fused",
) -> BuiltTable:
    """Do as `integrated` does, and say how many passes the builder took for all of its sums."""
    _check_order(order)
    control = control or Control(threads=1)
    if image.ndim != 3 or image.shape[2] != 3 or not image.size:
        raise InvalidSetting(f"must be (height, width, 3), is {image.shape}", "image")
    if order == 1:
        return build_table(image, builder, control=control)
    values = np.array(image, np.float64, order="C")
    height, width, _ = values.shape
    # As two images of one column and of one row, these take the same way as the rest
    by_row, by_column = values.mean(axis=1, keepdims=True), values.mean(axis=0, keepdims=True)
    mean = by_row.mean(axis=(0, 1))
    passes = _integrate(values, order, builder, control)
    _integrate_along_rows(by_column, order, control)
    _integrate_down_columns(by_row, order, control)
    table = np.empty((height + order + 1, width + order + 1, 3))
    rows, columns = _texels(height, order), _texels(width, order)
    table[:-1, :-1] = values[rows[:, None], columns]
    table[:-1, -1] = by_row[rows, 0]
    table[-1, :-1] = by_column[0, columns]
    table[-1, -1] = mean
    return BuiltTable(table, builder, passes)


def spline_means(
    table: Doubles, order: int, filters: Doubles, control: Control | None = None
) -> Doubles:
    """Means of an image that repeats in both axes under B-spline filters of any place and size.

    Parameters
    ----------
    table
        as `integrated` makes it for that order
    filters
        (N, 4) row and column of the centre, in texels from the image's corner, and half height and
        half width of the box that, convolved `order` times with itself, is the filter; the halves
        must be positive. Order n reaches n times as far, with n times the box's variance: boxes of
        the halves h / sqrt(n) blur as much as one of h

    Returns
    -------
    (N, 3) float64, exact but for rounding for an image of constant texels. Raises InvalidSetting.
    """
    _check_order(order)
    filters = np.ascontiguousarray(filters, np.float64)
    if filters.ndim != 2 or filters.shape[1] != 4:
        raise InvalidSetting(f"must be (N, 4), is {filters.shape}", "filters")
    if not np.isfinite(filters).all() or not (filters[:, 2:] > 0.0).all():
        raise InvalidSetting("must be finite, with positive halves", "filters")
    means = np.empty((len(filters), 3))
    tables = table[None]

    def read(begin: int, end: int) -> None:
        read_means(tables, order, filters, means, begin, end)

    for_chunks(len(filters), CHUNK_LOOKUPS, read, control or Control(threads=1))
    return means


def _check_order(order: int) -> None:
    if order not in ORDERS:
        raise InvalidSetting(f"must be 1, 2 or 3, is {order}", "order")


def _texels(length: int, order: int) -> Longs:
    """Whose sums the entries along one axis are: from `order` before the first to the last."""
    found: Longs = np.arange(-order, length, dtype=np.int64) % length
    return found


def _integrate(values: Doubles, times: int, builder: str, control: Control) -> int:
    """Sum along both axes, `times` times, rows and columns of mean zero; return the passes."""
    passes = 0
    sums = np.empty((values.shape[0] + 1, values.shape[1] + 1, 3))
    for _ in range(times):
        _integrate_along_rows(values, 0, control)
        _integrate_down_columns(values, 0, control)
        passes += build_table(values, builder, out=sums, control=control).passes
        values[:] = sums[1:, 1:]
    _integrate_along_rows(values, 0, control)
    _integrate_down_columns(values, 0, control)
    return passes


def _integrate_along_rows(values: Doubles, times: int, control: Control) -> None:
    for_chunks(
        len(values),
        CHUNK_ROWS,
        lambda begin, end: integrate_rows(values, times, begin, end),
        control,
    )


def _integrate_down_columns(values: Doubles, times: int, control: Control) -> None:
    flat = values.reshape(len(values), -1)
    mean = np.empty(flat.shape[1])
    for_chunks(
        flat.shape[1],
        CHUNK_VALUES,
        lambda begin, end: integrate_columns(flat, times, mean, begin, end),
        control,
    )
