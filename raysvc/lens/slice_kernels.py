"""Kernels that sort points into slices and resolutions."""

from typing import NamedTuple

import numpy as np

from raysvc.jit import inlined, kernel
from raysvc.lens.sources import CHANNELS, Sources
from raysvc.types import Bytes, Floats, Longs

FULL_PX = 32.0
"""Diameters of 32 pixels and more are spread at half the resolution, of 64 at a quarter ..."""


BESIDE_NEARER, BESIDE_FARTHER, HIDDEN = 1, 2, 4


class Membership(NamedTuple):
    """Where N points belong."""

    slice: Bytes
    """(N,) the nearer of the one or two slices."""
    nearer: Floats
    """(N,) part that is in it, of what other points of the pixel in this slice leave visible ..."""
    farther: Floats
    """(N,) ... and part that is in the next one."""
    flags: Bytes
    """(N,) BESIDE_NEARER, BESIDE_FARTHER: nothing in the pixel is before that part of the point in
    the slice before; HIDDEN: something in the pixel hides it."""
    level: Bytes
    """(N,) at which resolution: 1 / 2^level of the picture's."""


@inlined
def level_of(coc_px: float, levels: int) -> int:
    """Number of the resolution at which a diameter is spread, less than `levels`."""
    level, size = 0, abs(coc_px)
    while size >= FULL_PX and level + 1 < levels:
        size *= 0.5
        level += 1
    return level


@kernel
def join(
    row_start: Longs,
    pixel: Longs,
    coc_px: Floats,
    cover: Floats,
    fade_begin: Floats,
    fade_end: Floats,
    sharp: int,
    first: int,
    last: int,
    member: Membership,
    counts: Longs,
) -> None:
    """Find where the points of rows first..last belong, and count them.

    row_start: (H + 1,) number of the first point of each row. counts: (S, 2, levels, H) int64,
    of what is seen and of what is hidden, added
    to; what is in focus is not counted.
    """
    slices, levels = counts.shape[0], counts.shape[2]
    visible = np.ones(slices, np.float32)
    before = np.int64(-1)
    solid = False
    for y in range(first, last):
        for i in range(row_start[y], row_start[y + 1]):
            if pixel[i] != before:
                before = pixel[i]
                visible[:] = 1.0
                solid = False
            coc = coc_px[i]
            k = 0
            while k < slices - 1 and fade_end[k] <= coc:
                k += 1
            part = np.float32(0.0)
            if k < slices - 1 and coc > fade_begin[k]:
                part = (coc - fade_begin[k]) / (fade_end[k] - fade_begin[k])
            level = level_of(coc, levels)
            flags = HIDDEN if solid else 0
            if k > 0 and visible[k - 1] >= 1.0:
                flags += BESIDE_NEARER
            if visible[k] >= 1.0:
                flags += BESIDE_FARTHER
            nearer = (np.float32(1.0) - part) * visible[k]
            farther = np.float32(0.0)
            if part > 0.0:
                farther = part * visible[k + 1]
                visible[k + 1] *= np.float32(1.0) - cover[i]
            visible[k] *= np.float32(1.0) - cover[i]
            if cover[i] <= 0.0:
                nearer = farther = np.float32(0.0)
            member.slice[i], member.level[i], member.flags[i] = k, level, flags
            member.nearer[i], member.farther[i] = nearer, farther
            hidden = 1 if solid else 0
            if nearer > 0.0 and k != sharp:
                counts[k, hidden, level, y] += 1
            if farther > 0.0:
                counts[k + 1, hidden, level, y] += 1
            solid |= cover[i] >= 1.0


@kernel
def collect(
    row_start: Longs,
    pixel: Longs,
    coc_px: Floats,
    rgba: Floats,
    cover: Floats,
    member: Membership,
    sharp: int,
    first: int,
    last: int,
    place: Longs,
    out: Sources,
    focus: Floats,
) -> None:
    """Write the points of rows first..last where they belong.

    place: (S, 2, levels, H) int64, number of the first free source of each row; counted up. out:
    takes columns, diameters (those of the picture) and values. focus: (H, W, 5) float32 zeros,
    what is in focus: premultiplied colour and how much it covers.
    """
    width = focus.shape[1]
    for y in range(first, last):
        for i in range(row_start[y], row_start[y + 1]):
            k, level = member.slice[i], member.level[i]
            hidden = 1 if member.flags[i] & HIDDEN else 0
            x = pixel[i] - np.int64(y) * width
            for step in range(2):
                share = member.nearer[i] if step == 0 else member.farther[i]
                if share <= 0.0:
                    continue
                if k + step == sharp:
                    for c in range(4):
                        focus[y, x, c] += share * rgba[i, c]
                    focus[y, x, 4] += share * cover[i]
                    continue
                to = place[k + step, hidden, level, y]
                place[k + step, hidden, level, y] = to + 1
                out.column[to] = x
                out.size_px[to] = coc_px[i]
                for c in range(4):
                    out.values[to, c] = share * rgba[i, c]
                out.values[to, 4] = share * cover[i]
                out.values[to, 5] = np.float32(0.0)
                # What is hidden goes on where the slice's other points end.
                if hidden == 1 or member.flags[i] & (1 << step):
                    out.values[to, 5] = share * cover[i]


@kernel
def merge(fine: Sources, level: int, width: int, first: int, last: int, out: Sources) -> None:
    """Merge points of 2^level x 2^level pixels, for rows first..last of the coarse picture.

    A merged point has the mean diameter of its points, by how much they cover, in pixels of the
    coarse picture. `out.end` counts what is written from `out.begin` on. width: of the fine one.
    """
    edge = 1 << level
    height = len(fine.begin)
    columns = (width + edge - 1) >> level
    sums = np.zeros((columns, CHANNELS))
    sizes = np.zeros(columns)
    for row in range(first, last):
        rows = min(edge, height - row * edge)
        for y in range(row * edge, row * edge + rows):
            for i in range(fine.begin[y], fine.end[y]):
                x = fine.column[i] >> level
                sizes[x] += fine.size_px[i] * fine.values[i, 4]
                for c in range(CHANNELS):
                    sums[x, c] += fine.values[i, c]
        to = out.begin[row]
        for x in range(columns):
            if sums[x, 4] <= 0.0:
                continue
            # At the right and lower border a coarse pixel lies partly outside: the picture goes on.
            share = 1.0 / (rows * min(edge, width - x * edge))
            out.column[to] = x
            out.size_px[to] = sizes[x] / (sums[x, 4] * edge)
            for c in range(CHANNELS):
                out.values[to, c] = sums[x, c] * share
                sums[x, c] = 0.0
            sizes[x] = 0.0
            to += 1
        out.end[row] = to


@kernel
def columns_of(sources: Sources, first: int, last: int) -> tuple[int, int]:
    """Return the columns from..to that hold all sources of rows first..last; from >= to for none.

    Those of a row are in order.
    """
    least, most = 1 << 40, 0
    for y in range(first, last):
        if sources.begin[y] < sources.end[y]:
            least = min(least, int(sources.column[sources.begin[y]]))
            most = max(most, int(sources.column[sources.end[y] - 1]) + 1)
    return least, most


@kernel
def largest_of(rgba: Floats, first: int, last: int, largest: Floats) -> None:
    """Raise largest (4,) to the greatest magnitudes of rows first..last of rgba (N, 4).

    What is not a number counts as infinite.
    """
    for i in range(first, last):
        for c in range(4):
            size = abs(rgba[i, c])
            if not size <= largest[c]:
                largest[c] = np.inf if np.isnan(size) else size
