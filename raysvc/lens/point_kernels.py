"""Kernels on the points that a lens is given."""

from typing import NamedTuple

from raysvc.jit import inlined, kernel
from raysvc.types import Floats, Longs


class Columns(NamedTuple):
    """N points; see `LensPoints`."""

    pixel: Longs
    coc_px: Floats
    rgba: Floats
    cover: Floats


@inlined
def _write(found: Columns, i: int, out: Columns, to: int) -> None:
    out.pixel[to] = found.pixel[i]
    out.coc_px[to] = found.coc_px[i]
    for c in range(4):
        out.rgba[to, c] = found.rgba[i, c]
    out.cover[to] = found.cover[i]


@kernel
def merge_by_pixel(first: Columns, second: Columns, out: Columns) -> None:
    """Merge points, (N) and (M), of ascending pixels into one list (N + M).

    In each pixel all points of `first` go before those of `second`.
    """
    ends = len(first.pixel), len(second.pixel)
    i, j = 0, 0
    for to in range(ends[0] + ends[1]):
        if j == ends[1] or (i < ends[0] and first.pixel[i] <= second.pixel[j]):
            _write(first, i, out, to)
            i += 1
        else:
            _write(second, j, out, to)
            j += 1
