"""Reading textures inside kernels."""

import math
from typing import NamedTuple

import numpy as np

from raysvc.jit import inlined, kernel
from raysvc.types import Bytes, Floats, Ints, Longs

Vec2 = tuple[float, float]
Vec4 = tuple[float, float, float, float]
NEAREST, BILINEAR, MIP = 0, 1, 2
MAX_LEVELS = 16
REPEAT, CLAMP, MIRROR = 0, 1, 2
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
    linear_from_srgb: Floats
    """(256,) decoding of colour."""


@kernel
def halve(texels: Bytes, decoding: Floats, thresholds: Floats, smaller: Bytes) -> None:
    """Fill `smaller` (h, w, 4) with means of those texels of (H, W, 4) that each covers.

    Sizes are halved and rounded down, at least 1; an odd last row or column is folded into its
    neighbour. Colour is averaged as `decoding` (256,) says; alpha is linear.
    """
    height, width = texels.shape[0], texels.shape[1]
    h, w = smaller.shape[0], smaller.shape[1]
    for row in range(h):
        row_end = height if row == h - 1 else 2 * row + 2
        for col in range(w):
            col_end = width if col == w - 1 else 2 * col + 2
            red = green = blue = alpha = 0.0
            for y in range(2 * row if h < height else row, row_end):
                for x in range(2 * col if w < width else col, col_end):
                    red += decoding[texels[y, x, 0]]
                    green += decoding[texels[y, x, 1]]
                    blue += decoding[texels[y, x, 2]]
                    alpha += texels[y, x, 3]
            rows = row_end - (2 * row if h < height else row)
            cols = col_end - (2 * col if w < width else col)
            count = rows * cols
            smaller[row, col, 0] = _code(red / count, thresholds)
            smaller[row, col, 1] = _code(green / count, thresholds)
            smaller[row, col, 2] = _code(blue / count, thresholds)
            smaller[row, col, 3] = int(alpha / count + 0.5)


@inlined
def _code(value: float, thresholds: Floats) -> int:
    """Number of thresholds (255,) below a value: the nearest 8-bit code, by bisection."""
    low, high = 0, 255
    while low < high:
        middle = (low + high) // 2
        if thresholds[middle] < value:
            low = middle + 1
        else:
            high = middle
    return low


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
def _brought_near(u: float, wrap: int) -> float:
    """Coordinate that reads the same texel as one far outside the texture; 0 for inf and NaN.

    There the whole part only costs precision, and would overflow an integer.
    """
    if not abs(u) < np.inf:
        return 0.0
    if wrap == CLAMP:
        return min(max(u, -1.0), 2.0)
    return u - 2.0 * math.floor(u / 2.0)


@inlined
def _plus_texel(
    textures: TextureTable, at: int, weight: float, is_colour: bool, total: Vec4
) -> Vec4:
    """Running total plus one texel, decoded and weighted."""
    texels, decoding = textures.texels, textures.linear_from_srgb
    if is_colour:
        red, green, blue = (
            decoding[texels[at, 0]],
            decoding[texels[at, 1]],
            decoding[texels[at, 2]],
        )
    else:
        red, green, blue = texels[at, 0] / 255.0, texels[at, 1] / 255.0, texels[at, 2] / 255.0
    return (
        total[0] + weight * red,
        total[1] + weight * green,
        total[2] + weight * blue,
        total[3] + weight * texels[at, 3] / 255.0,
    )


@inlined
def _plus_level(
    textures: TextureTable,
    texture: int,
    level: int,
    uv: Vec2,
    nearest: bool,
    is_colour: bool,
    weight: float,
    total: Vec4,
) -> Vec4:
    """Running total plus one size of a texture at uv, bilinear or nearest."""
    start = textures.start[texture, level]
    width, height = textures.size[texture, level, 0], textures.size[texture, level, 1]
    wrap_u, wrap_v = textures.sampler[texture, 0], textures.sampler[texture, 1]
    u, v = uv
    if not (abs(u) <= FAR and abs(v) <= FAR):
        u, v = _brought_near(u, wrap_u), _brought_near(v, wrap_v)
    x, y = u * width, v * height
    if nearest:
        col = wrapped(math.floor(x), width, wrap_u)
        row = wrapped(math.floor(y), height, wrap_v)
        return _plus_texel(textures, start + row * width + col, weight, is_colour, total)
    x -= 0.5
    y -= 0.5
    left, top = math.floor(x), math.floor(y)
    fx, fy = x - left, y - top
    col0, col1 = wrapped(left, width, wrap_u), wrapped(left + 1, width, wrap_u)
    row0 = start + wrapped(top, height, wrap_v) * width
    row1 = start + wrapped(top + 1, height, wrap_v) * width
    total = _plus_texel(textures, row0 + col0, weight * (1 - fx) * (1 - fy), is_colour, total)
    total = _plus_texel(textures, row0 + col1, weight * fx * (1 - fy), is_colour, total)
    total = _plus_texel(textures, row1 + col0, weight * (1 - fx) * fy, is_colour, total)
    return _plus_texel(textures, row1 + col1, weight * fx * fy, is_colour, total)


@inlined
def sample(
    textures: TextureTable,
    texture: int,
    uv: Vec2,
    texels_per_pixel: float,
    texture_filter: int,
    is_colour: bool,
) -> Vec4:
    """Linear RGBA of a texture at uv for a footprint of so many texels of its largest size.

    The filter is NEAREST, BILINEAR, or MIP: trilinear between the two sizes whose texels are next
    to the footprint's. A magnified texture whose sampler says nearest is read so by every filter.
    """
    magnified = not texels_per_pixel > 1.0
    nearest = texture_filter == NEAREST or (textures.sampler[texture, 2] == 1 and magnified)
    level = 0.0
    if texture_filter == MIP and not magnified:
        level = min(math.log2(texels_per_pixel), textures.levels[texture] - 1.0)
    lower = int(level)
    fraction = level - lower
    total = (0.0, 0.0, 0.0, 0.0)
    total = _plus_level(textures, texture, lower, uv, nearest, is_colour, 1.0 - fraction, total)
    if fraction > 0.0:
        total = _plus_level(textures, texture, lower + 1, uv, nearest, is_colour, fraction, total)
    return total
