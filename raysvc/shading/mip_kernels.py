"""Prefiltered sizes of textures, and reading between their texels and between them.

Williams 1983, "Pyramidal Parametrics".
"""

import math

from raysvc.jit import inlined, kernel
from raysvc.shading.texel_kernels import (
    NO_TEXEL,
    TextureTable,
    Vec2,
    Vec4,
    brought_near,
    plus_texel,
    wrapped,
)
from raysvc.types import Bytes, Floats


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
def nearest(textures: TextureTable, texture: int, uv: Vec2, kind: int) -> Vec4:
    """The texel of the largest size that holds uv."""
    width, height = textures.size[texture, 0, 0], textures.size[texture, 0, 1]
    wrap_u, wrap_v = textures.sampler[texture, 0], textures.sampler[texture, 1]
    u, v = brought_near(uv, wrap_u, wrap_v)
    col = wrapped(math.floor(u * width), width, wrap_u)
    row = wrapped(math.floor(v * height), height, wrap_v)
    at = textures.start[texture, 0] + row * width + col
    return plus_texel(textures, at, 1.0, kind, NO_TEXEL)


@inlined
def plus_bilinear(
    textures: TextureTable,
    texture: int,
    level: int,
    uv: Vec2,
    sharpness: Vec2,
    kind: int,
    weight: float,
    total: Vec4,
) -> Vec4:
    """Running total plus the mean of the four texels of one size about uv.

    Weights fall by `sharpness`, at least 1, per texel along each axis: with 1 this is bilinear
    interpolation; with more, what a box 1 / sharpness texels wide sees of texels that are squares.
    """
    start = textures.start[texture, level]
    width, height = textures.size[texture, level, 0], textures.size[texture, level, 1]
    wrap_u, wrap_v = textures.sampler[texture, 0], textures.sampler[texture, 1]
    u, v = brought_near(uv, wrap_u, wrap_v)
    x, y = u * width - 0.5, v * height - 0.5
    left, top = math.floor(x), math.floor(y)
    fx = min(max((x - left - 0.5) * sharpness[0] + 0.5, 0.0), 1.0)
    fy = min(max((y - top - 0.5) * sharpness[1] + 0.5, 0.0), 1.0)
    col0, col1 = wrapped(left, width, wrap_u), wrapped(left + 1, width, wrap_u)
    row0 = start + wrapped(top, height, wrap_v) * width
    row1 = start + wrapped(top + 1, height, wrap_v) * width
    total = plus_texel(textures, row0 + col0, weight * (1.0 - fx) * (1.0 - fy), kind, total)
    total = plus_texel(textures, row0 + col1, weight * fx * (1.0 - fy), kind, total)
    total = plus_texel(textures, row1 + col0, weight * (1.0 - fx) * fy, kind, total)
    return plus_texel(textures, row1 + col1, weight * fx * fy, kind, total)
