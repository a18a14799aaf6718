"""Sample points shared out over tiles of pixels, so that neighbours complete each other.

Interleaved sampling (Keller and Heidrich 2001, "Interleaved Sampling"): every pixel of an 8 x 8
tile takes one of 64 points of the unit square. The points are a (0, 2)-sequence (Sobol' 1967) dealt
out along a Morton curve: each aligned block of 2 x 2, 4 x 4 or 8 x 8 pixels then holds a net, with
one point in every elementary interval of its size.
"""

import numpy as np

from raysvc.types import Doubles, Longs

TILE = 8
"""Pixels along a side of a tile."""
BITS = 32


def tile_points(seed: int) -> Doubles:
    """(64, 2) float64 in 0..1: points of the tile's pixels along the Morton curve.

    The seed scrambles their digits, which keeps every net a net (Kollig and Keller 2002, "Efficient
    Multidimensional Sampling").
    """
    index = np.arange(TILE * TILE, dtype=np.uint64)
    # Both dimensions by their generator matrices: the reversal of bits, and Pascal's triangle.
    first = np.zeros_like(index)
    second = np.zeros_like(index)
    column = np.uint64(1 << (BITS - 1))
    for bit in range(6):
        digit = (index >> np.uint64(bit)) & np.uint64(1)
        first ^= digit * np.uint64(1 << (BITS - 1 - bit))
        second ^= digit * column
        column ^= column >> np.uint64(1)
    scramble = np.random.default_rng(seed).integers(0, 1 << BITS, 2, dtype=np.uint64)
    points = np.stack([first ^ scramble[0], second ^ scramble[1]], axis=1)
    return (points + 0.5) / float(1 << BITS)


def place_in_tile(pixel: Longs, width: int) -> Longs:
    """(N,) number along the Morton curve, 0..63, of pixels (N,) of a picture of that width."""
    row, col = np.divmod(pixel, width)
    place = np.zeros_like(pixel)
    for bit in range(3):
        place |= ((col >> bit) & 1) << (2 * bit)
        place |= ((row >> bit) & 1) << (2 * bit + 1)
    return place


RAYS = 4
"""Points of each place in `dealt_points`."""


def dealt_points(seed: int) -> Doubles:
    """(16, 4, 2) float64 in 0..1: the same 64 points, four for each place of a 4 x 4 tile.

    Each place's four are a net. So are, of each aligned block of 2 x 2 and of 4 x 4 places, the
    first points, the second, the third, and the fourth; and all 64 together. Tiles of 4 x 4 repeat,
    so that wherever four rows and columns begin they have all of the points.
    """
    place = np.arange(16)
    # Place t begins at point 4 t + f(t). Of all linear f, this one leaves all those nets.
    low, high = ((place[:, None] >> np.array(bits)) & 1 for bits in ((0, 1, 3), (0, 2, 3)))
    begin = low.sum(axis=1) % 2 + 2 * (high.sum(axis=1) % 2)
    points: Doubles = tile_points(seed)[4 * place[:, None] + (begin[:, None] ^ np.arange(RAYS))]
    return points
