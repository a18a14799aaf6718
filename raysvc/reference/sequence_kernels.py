"""Well spread random numbers: Owen-scrambled Sobol points, found by hashing.

Burley 2020, "Practical Hash-based Owen Scrambling", JCGT 9(4). Every pixel and every pair of
dimensions has its own scrambling and its own order of the first two Sobol dimensions, so that any
number of pairs can be had ("padding"), each spread as well as two dimensions can be. The hash of a
scrambling is Vegdahl's (2021, "Building a Better LK Hash"); how the second dimension is found
without a loop over bits is Ahmed's (2024, "An Implementation Algorithm of 2D Sobol Sequence Fast,
Elegant, and Compact").

Integers are 32 bits wide. Numba widens them when it computes, so they are narrowed again.
"""

import numpy as np

from raysvc.jit import inlined, kernel
from raysvc.types import Doubles, Words

UNIT = 2.0**-32


@inlined
def _word(x: int) -> int:
    """Lower 32 bits."""
    word: int = np.uint32(x & 0xFFFFFFFF)  # type: ignore[assignment]
    return word


@inlined
def mixed(x: int) -> int:
    """Hash of a word in which every bit depends on all (Wellons 2018, "lowbias32")."""
    x = _word(x)
    x = _word((x ^ (x >> 16)) * 0x7FEB352D)
    x = _word((x ^ (x >> 15)) * 0x846CA68B)
    return _word(x ^ (x >> 16))


@inlined
def joined(seed: int, value: int) -> int:
    """Hash of two words."""
    return mixed(_word(seed) ^ _word(mixed(value) + 0x9E3779B9))


@inlined
def reversed_bits(x: int) -> int:
    """Word with its bits in the opposite order."""
    x = _word(x)
    x = _word(((x >> 1) & 0x55555555) | ((x & 0x55555555) << 1))
    x = _word(((x >> 2) & 0x33333333) | ((x & 0x33333333) << 2))
    x = _word(((x >> 4) & 0x0F0F0F0F) | ((x & 0x0F0F0F0F) << 4))
    x = _word(((x >> 8) & 0x00FF00FF) | ((x & 0x00FF00FF) << 8))
    return _word((x >> 16) | (x << 16))


@inlined
def _permuted(x: int, seed: int) -> int:
    """Word whose every bit is flipped or not by a hash of the bits below it.

    On reversed bits that is a nested uniform scramble (Owen 1995).
    """
    x, seed = _word(x), _word(seed)
    x = _word(x ^ _word(x * 0x3D20ADEA))
    x = _word(x + seed)
    x = _word(x * ((seed >> 16) | 1))
    x = _word(x ^ _word(x * 0x05526C56))
    return _word(x ^ _word(x * 0x53A22864))


@inlined
def _pascal(x: int) -> int:
    """Word times Pascal's matrix modulo 2: the second Sobol dimension, bits reversed."""
    x = _word(x)
    x = _word(x ^ ((x & 0xFFFF0000) >> 16))
    x = _word(x ^ ((x & 0xFF00FF00) >> 8))
    x = _word(x ^ ((x & 0xF0F0F0F0) >> 4))
    x = _word(x ^ ((x & 0xCCCCCCCC) >> 2))
    return _word(x ^ ((x & 0xAAAAAAAA) >> 1))


@inlined
def pair(key: int, dimension: int, index: int) -> tuple[float, float]:
    """Two numbers in 0 <= u < 1: point `index` of the sequence `dimension` of a pixel's `key`.

    The points with indices 0 to 2^k - 1 are a (0, k, 2)-net: each of 2^k equal rectangles of any
    shape that a binary cut gives holds one.
    """
    seed = joined(key, dimension)
    place = reversed_bits(_permuted(reversed_bits(index), seed))
    # The first dimension is the place with its bits reversed, so it is scrambled as it stands
    first = reversed_bits(_permuted(place, mixed(seed ^ 0x68BC21EB)))
    second = reversed_bits(_permuted(_pascal(place), mixed(seed ^ 0x02E5BE93)))
    return np.float64(first) * UNIT, np.float64(second) * UNIT


@kernel
def pairs(key: Words, dimension: int, index: Words, points: Doubles) -> None:
    """Fill points (N, 2) with those of keys (N,) and indices (N,); see `pair`."""
    for n in range(len(key)):
        points[n, 0], points[n, 1] = pair(key[n], dimension, index[n])


@kernel
def pixel_keys(pixel: Words, seed: int, key: Words) -> None:
    """Fill key (N,) of pixels (N,) for a picture's seed."""
    for n in range(len(pixel)):
        key[n] = joined(mixed(seed), pixel[n])
