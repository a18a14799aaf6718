"""Spreading slices of a picture into squares, with sums in fixed point."""

import math

import numpy as np

from raysvc.lens.spread_kernels import add_squares, integrate
from raysvc.parallel import Control, for_chunks
from raysvc.types import Floats, Longs

SUM_BITS = 62
HEADROOM_BITS = 6
"""Squares of all sizes around a point weigh at most about 2 ln(picture's side), less than 2^6."""


class Squares:
    """One picture to be spread slice by slice; working memory is kept from slice to slice.

    Parameters
    ----------
    values
        (C, H, W) float32, the last of them ones (`planes`)
    side_px
        (H, W) float32, at most twice the smaller of H and W
    control
        threads and stopping
    """

    def __init__(self, values: Floats, side_px: Floats, control: Control) -> None:
        self._values = values
        self._side_px = side_px
        self._control = control
        self._scales = [fixed_point_scale(value) for value in values]
        self._sums = np.empty_like(values)
        self._idle: list[Longs] = []

    def spread(self, membership: Floats) -> Floats:
        """Spread every pixel, times its membership (H, W) float32 in 0..1, without normalising.

        Returns (C, H, W) float32, good until the next call. Totals are kept: what would leave the
        picture is mirrored at its border.
        """

        def work(begin: int, end: int) -> None:
            for channel in range(begin, end):
                self._spread_channel(channel, membership)

        # Channels share no sums, so one channel per thread needs neither locks nor copies.
        for_chunks(len(self._values), 1, work, self._control)
        return self._sums

    def _spread_channel(self, channel: int, membership: Floats) -> None:
        _, height, width = self._values.shape
        try:
            deltas = self._idle.pop()
        except IndexError:
            deltas = np.zeros((height + 2, width + 2), np.int64)
        scale = self._scales[channel]
        add_squares(self._values[channel], membership, self._side_px, scale, deltas)
        integrate(deltas, scale, np.zeros(width, np.int64), self._sums[channel])
        self._idle.append(deltas)


def planes(rgba: Floats) -> Floats:
    """Return what is spread of a picture (H, W, 4): (5, H, W) red, green, blue, alpha, ones.

    Of an opaque picture only (4, H, W) red, green, blue, ones: the ones are its alpha.
    """
    opaque = bool((rgba[..., 3] == 1.0).all())
    out = np.ones((4 if opaque else 5, *rgba.shape[:2]), np.float32)
    out[:-1] = np.moveaxis(rgba, 2, 0)[: len(out) - 1]
    return out


def fixed_point_scale(values: Floats) -> float:
    """Return the largest power of two at which no sum of squares of these values can overflow."""
    largest = float(np.abs(values).max())
    _, exponent = math.frexp(largest)
    return math.ldexp(1.0, SUM_BITS - HEADROOM_BITS - (exponent if largest > 0 else 0))
