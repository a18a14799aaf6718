"""Textures as kernels see them: texels by number, and what lies outside 0..1."""

import math
from typing import NamedTuple

import numpy as np

from raysvc.jit import inlined
from raysvc.types import Bytes, Floats, Ints, Longs

Vec2 = tuple[float, float]
Vec4 = tuple[float, float, float, float]
MAX_LEVELS = 16
REPEAT, CLAMP, MIRROR = 0, 1, 2
DATA, COLOUR = 0, 1
"""Kinds of texels: numbers as they are, and sRGB colours."""
NO_TEXEL: Vec4 = (0.0, 0.0, 0.0, 0.0)
FAR = 1e6
"""Texture coordinates beyond this are brought near first."""


class TextureTable(NamedTuple):
    """What kernels read; T textures, at most MAX_LEVELS sizes each."""

    texels: Bytes
    """(N, 4) uint8 of all levels of all textures, row by row."""
    start: Longs
    """(T, MAX_LEVELS) where in `texels` a level begins."""
    size: Ints
    """(T, MAX_LEVELS, 2) width and height of a level."""
    levels: Ints
    """(T,) how many there are."""
    sampler: Ints
    """(T, 3): wrap along u and v (repeat 0, clamp 1, mirror 2); 1 if magnified as squares."""
    decoding: Floats
    """(2, 256) float32: linear value of a code, as DATA and as COLOUR; alpha is always data."""


@inlined
def wrapped(index: int, size: int, wrap: int) -> int:
    """Texel index within 0..size-1 by the wrap mode (repeat 0, clamp 1, mirror 2)."""
    if wrap == CLAMP:
        return min(max(index, 0), size - 1)
    if wrap == MIRROR:
        folded = index % (2 * size)
        return folded if folded < size else 2 * size - 1 - folded
    return index % size


@inlined
def brought_near(uv: Vec2, wrap_u: int, wrap_v: int) -> Vec2:
    """Coordinates that read the same texel as those far outside the texture; 0 for inf and NaN.

    There the whole part only costs precision, and would overflow an integer.
    """
    u, v = uv
    if abs(u) <= FAR and abs(v) <= FAR:
        return u, v
    return _brought_near(u, wrap_u), _brought_near(v, wrap_v)


@inlined
def _brought_near(u: float, wrap: int) -> float:
    if not abs(u) < np.inf:
        return 0.0
    if wrap == CLAMP:
        return min(max(u, -1.0), 2.0)
    return u - 2.0 * math.floor(u / 2.0)


@inlined
def plus_texel(textures: TextureTable, at: int, weight: float, kind: int, total: Vec4) -> Vec4:
    """Running total plus one texel, decoded and weighted."""
    texels, decoding = textures.texels, textures.decoding
    return (
        total[0] + weight * decoding[kind, texels[at, 0]],
        total[1] + weight * decoding[kind, texels[at, 1]],
        total[2] + weight * decoding[kind, texels[at, 2]],
        total[3] + weight * decoding[DATA, texels[at, 3]],
    )
