"""Passes of recursive doubling (Hillis and Steele 1986), with any number of samples per pass.

P_0 = image, P_i(x) = sum over j < k of P_(i-1)(x - j k^i): after pass i every entry is the sum of
k^(i+1) texels. Hensley et al. 2005 make summed-area tables of it on a GPU, where an entry can read
many others but not wait for one.
"""

from raysvc.jit import kernel
from raysvc.types import Doubles, Floats


@kernel
def add_from_the_left(
    source: Floats | Doubles,
    target: Floats | Doubles,
    stride: int,
    samples: int,
    begin: int,
    end: int,
) -> None:
    """Write to rows begin..end of `target` (R, N) every value of `source` and those left of it.

    `stride` is the distance from sample to sample in values; what is left of column 0 is zero.
    """
    width = source.shape[1]
    for row in range(begin, end):
        for x in range(width):
            target[row, x] = source[row, x]
        for j in range(1, min(samples, (width - 1) // stride + 1)):
            for x in range(j * stride, width):
                target[row, x] += source[row, x - j * stride]


@kernel
def add_from_above(
    source: Floats | Doubles,
    target: Floats | Doubles,
    stride: int,
    samples: int,
    begin: int,
    end: int,
) -> None:
    """Do the same with the rows above: `stride` is in rows, what is above row 0 is zero."""
    for row in range(begin, end):
        for x in range(source.shape[1]):
            target[row, x] = source[row, x]
        for j in range(1, min(samples, row // stride + 1)):
            for x in range(source.shape[1]):
                target[row, x] += source[row - j * stride, x]
