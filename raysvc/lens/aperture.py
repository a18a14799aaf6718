"""The shape of a point out of focus: that of the lens's opening, a disc or a polygon of blades.

A shape is drawn by its perimeter (Kosloff, Tao and Barsky 2009, section 6): on every row of pixels
its left and its right edge. Which those are depends on its size alone, so they are in tables.
"""

import functools
from typing import NamedTuple

import numpy as np

from raysvc.types import Doubles, Floats, Ints, Longs

MAX_BLADES = 16
STEPS_PER_PX = 16
"""Diameters are rounded to 1/16 pixel."""
SUBPIXEL_BITS = 6
"""Edges lie on 1/64 pixel."""
SCANLINES = 32
"""By which the part of a row of pixels is found that a shape covers."""


class Aperture(NamedTuple):
    """The opening of a lens."""

    blades: int = 0
    """Corners of the polygon, on the rim of the lens; 0 is the whole disc."""
    rotation_deg: float = 0.0
    """Turns it counter-clockwise, seen in the picture; without, one corner is up."""


DISC = Aperture()


class Stamps(NamedTuple):
    """Shapes of all sizes: of Q diameters, at most K rows of pixels each.

    Of diameter d, in pixels, number `round(d STEPS_PER_PX)` is a shape behind the focus, as the
    lens looks from behind; with `flipped` more it is one before the focus, upside down.
    """

    first: Longs
    """(Q,) first row, from that of its centre."""
    rows: Longs
    """(Q,) how many."""
    begin: Ints
    """(Q, K) left edge from the left edge of the centre's pixel, in 1/64 pixel."""
    end: Ints
    """(Q, K) right edge."""
    area_px: Floats
    """(Q,) sum of its rows: nearly that of the shape, and exactly that of what is drawn."""
    flipped: int


@functools.lru_cache(maxsize=16)
def stamps(aperture: Aperture, largest_px: int) -> Stamps:
    """Return the tables of a shape, up to a diameter."""
    diameters = np.arange(largest_px * STEPS_PER_PX + 1) / STEPS_PER_PX
    behind, before = (_tables(aperture, diameters, turn) for turn in (1.0, -1.0))
    return Stamps(
        np.concatenate([behind[0], before[0]]),
        np.concatenate([behind[1], before[1]]),
        np.concatenate([behind[2], before[2]]),
        np.concatenate([behind[3], before[3]]),
        np.concatenate([behind[4], before[4]]),
        len(diameters),
    )


def _tables(
    aperture: Aperture, diameters: Doubles, turn: float
) -> tuple[Longs, Longs, Ints, Ints, Floats]:
    reach = int(np.ceil(diameters[-1] / 2)) + 1
    row = np.arange(-reach, reach + 1)
    scanline = (np.arange(SCANLINES) + 0.5) / SCANLINES - 0.5
    radius = np.maximum(diameters / 2, 1e-3)
    # Rows go down and the unit shape's y goes up.
    y = -(row[:, None] + scanline) / radius[:, None, None] * turn
    left, right = (x * radius[:, None, None] for x in extent(aperture, y))
    if turn < 0:
        left, right = -right, -left
    width = np.maximum(right - left, 0.0)
    mean = width.mean(axis=2)
    middle = (width * (left + right) / 2).mean(axis=2) / np.maximum(mean, 1e-9)
    unit = 1 << SUBPIXEL_BITS
    begin = np.rint((0.5 + middle - mean / 2) * unit).astype(np.int64)
    end = np.rint((0.5 + middle + mean / 2) * unit).astype(np.int64)
    # A shape that is too small to be seen is a pixel.
    nothing = (end <= begin).all(axis=1)
    begin[nothing, reach], end[nothing, reach] = 0, unit
    covered = end > begin
    first = covered.argmax(axis=1)
    rows = covered.sum(axis=1)
    packed = np.minimum(first[:, None] + np.arange(len(row)), len(row) - 1)
    area = np.maximum(end - begin, 0).sum(axis=1) / unit
    return (
        first - reach,
        rows,
        np.take_along_axis(begin, packed, axis=1).astype(np.int32),
        np.take_along_axis(end, packed, axis=1).astype(np.int32),
        area.astype(np.float32),
    )


def extent(aperture: Aperture, y: Doubles) -> tuple[Doubles, Doubles]:
    """Left and right edge of the unit shape at heights y (up); right < left where it is not."""
    if aperture.blades == 0:
        half = np.sqrt(np.maximum(1.0 - y * y, 0.0))
        return -half, half
    count = aperture.blades
    between = (
        np.radians(90.0 + aperture.rotation_deg) + (np.arange(count) + 0.5) * 2 * np.pi / count
    )
    apothem = np.cos(np.pi / count)
    left, right = np.full(y.shape, -2.0), np.full(y.shape, 2.0)
    for across, up in zip(np.cos(between), np.sin(between), strict=True):
        room = apothem - y * up
        if abs(across) < 1e-9:
            right = np.where(room < 0, -4.0, right)
        elif across > 0:
            right = np.minimum(right, room / across)
        else:
            left = np.maximum(left, room / across)
    return left, right
