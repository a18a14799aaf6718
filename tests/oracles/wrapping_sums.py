"""Repeated integration in fixed point that may wrap: exact at every order (Hogenauer 1981).

Sums modulo 2^64 lose nothing as long as the *differences* that are asked for fit into 64 bits: an
integrator that overflows is set right by the differences that follow it.
"""

import numpy as np

FRACTION_BITS = 20


def to_fixed_point(image):
    """Words of an image whose values are multiples of 2^-20, negative ones as two's complement."""
    scaled = np.asarray(image, np.float64) * 2.0**FRACTION_BITS
    assert (scaled == np.round(scaled)).all() and np.abs(scaled).max() < 2.0**62
    return scaled.astype(np.int64).view(np.uint64)


def from_fixed_point(words):
    """Values of words."""
    return np.asarray(words, np.uint64).view(np.int64) * 2.0**-FRACTION_BITS


def table(image):
    """(H+1, W+1, C) words: the summed-area table of an image, as if its sums could not round."""
    height, width, channels = image.shape
    sums = np.zeros((height + 1, width + 1, channels), np.uint64)
    sums[1:, 1:] = to_fixed_point(image).cumsum(0, np.uint64).cumsum(1, np.uint64)
    return sums


def spline_sum(image, order, last, wide):
    """Sum of a periodic image times a B-spline of whole width, not divided by its weight.

    Parameters
    ----------
    last
        row and column of the last texel that has a weight, within the image
    wide
        rows and columns of the box that is convolved `order` times with itself
    """
    words = to_fixed_point(image)
    for axis in (0, 1):
        length, support = words.shape[axis], order * wide[axis]
        copies = -(-support // length) + 1
        words = np.concatenate([words] * copies, axis)
        for _ in range(order):
            words = words.cumsum(axis, np.uint64)
        # Differences at the texels that are asked for, from the last copy
        at = last[axis] + (copies - 1) * length
        for _ in range(order):
            behind = np.roll(words, wide[axis], axis)
            words = words - behind
        words = words.take([at], axis)
    return from_fixed_point(words[0, 0])
