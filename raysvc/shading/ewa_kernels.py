"""Elliptical weighted average: a Gaussian over the ellipse that a pixel covers of a texture.

Greene and Heckbert 1986, "Creating Raster Omnimax Images from Multiple Perspective Views Using the
Elliptical Weighted Average Filter"; Heckbert 1989. The size of the texture is chosen by the
ellipse's shorter axis, and long ellipses are fattened until their axes are as 1 to MAX_ANISOTROPY,
so that the number of texels read is bounded.

The filter's variance is what the pixel, a box, has (a twelfth of the squared steps), plus that of
linear interpolation (1/6 of a texel of the largest size), less that of the averaging that made the
smaller size. So the blur does not jump where another size is taken.
"""

import math

from raysvc.jit import inlined
from raysvc.shading.ellipse_kernels import Spread, squared_axes, widened
from raysvc.shading.texel_kernels import (
    CLAMP,
    MIRROR,
    NO_TEXEL,
    TextureTable,
    Vec2,
    Vec4,
    brought_near,
    plus_texel,
    wrapped,
)

MAX_ANISOTROPY = 16.0
"""Longest axis of an ellipse in lengths of its shortest."""
LEAST_SQUARE = 4.0
"""Square of the shorter axis in texels of the size that is read. With less than two texels across
the place of the centre between them shows; with more, more are read than need be."""
LEAST_VARIANCE = 1.0 / 6.0
"""In texels of the size that is read, along each axis."""
FALL = 2.0
"""The weight is exp(-FALL r^2) - exp(-FALL) at r of the ellipse's radius."""
EDGE = math.exp(-FALL)
RADIUS_SQUARE = 2.0 * FALL * (1.0 - EDGE * (1.0 + FALL)) / (1.0 - EDGE * (1.0 + FALL + FALL**2 / 2))
"""Square of the ellipse's radius for variance 1 of the weights."""


@inlined
def ewa_level(spread: Spread) -> tuple[Spread, int]:
    """A pixel's matrix, fattened if it is too long, and the size of the texture to read it from.

    In texels of the largest size; the texture may have fewer sizes.
    """
    longer, shorter = squared_axes(spread)
    least = longer / (MAX_ANISOTROPY * MAX_ANISOTROPY)
    spread = widened(spread, longer, shorter, least)
    shorter = max(shorter, least)
    if shorter <= LEAST_SQUARE:
        return spread, 0
    return spread, int(0.5 * math.log2(shorter / LEAST_SQUARE))


@inlined
def ewa(
    textures: TextureTable, texture: int, level: int, uv: Vec2, spread: Spread, kind: int
) -> tuple[Vec4, float]:
    """Linear RGBA of one size of a texture over what a pixel covers, and the sum of the weights.

    `spread` and `level` are those of `ewa_level`. Odd sizes are more than halved, so that an
    ellipse may lie between four texels: then the sum is 0.
    """
    # Variances in texels of that size; a size of 1 is the same everywhere along that axis.
    width, height = textures.size[texture, level, 0], textures.size[texture, level, 1]
    shrunk_x = width / textures.size[texture, 0, 0]
    shrunk_y = height / textures.size[texture, 0, 1]
    xx = _variance(spread[0], shrunk_x, width)
    yy = _variance(spread[2], shrunk_y, height)
    xy = spread[1] * shrunk_x * shrunk_y / 12.0 if width > 1 and height > 1 else 0.0

    # The ellipse a dx^2 + 2 b dx dy + c dy^2 < 1 about (x, y), centres of texels at whole numbers
    wrap_u, wrap_v = textures.sampler[texture, 0], textures.sampler[texture, 1]
    u, v = brought_near(uv, wrap_u, wrap_v)
    x, y = u * width - 0.5, v * height - 0.5
    scale = 1.0 / (RADIUS_SQUARE * (xx * yy - xy * xy))
    a, b, c = yy * scale, -xy * scale, xx * scale
    reach_y = math.sqrt(RADIUS_SQUARE * yy)
    start = textures.start[texture, level]
    period = 2 * width if wrap_u == MIRROR else width
    fall_twice = math.exp(-2.0 * FALL * a)
    total, weights = NO_TEXEL, 0.0
    for row in range(math.ceil(y - reach_y), math.floor(y + reach_y) + 1):
        dy = row - y
        under_root = b * b * dy * dy - a * (c * dy * dy - 1.0)
        if under_root <= 0.0:
            continue
        reach, middle = math.sqrt(under_root) / a, x - b * dy / a
        first, end = math.ceil(middle - reach), math.floor(middle + reach) + 1
        if first >= end:
            continue
        line = start + wrapped(row, height, wrap_v) * width
        place = first % period
        # Along a row the exponent is a square in dx: each weight follows from two products
        dx = first - x
        gauss = math.exp(-FALL * (a * dx * dx + 2.0 * b * dx * dy + c * dy * dy))
        fall = math.exp(-FALL * (a * (2.0 * dx + 1.0) + 2.0 * b * dy))
        for col in range(first, end):
            if wrap_u == CLAMP:
                at = line + min(max(col, 0), width - 1)
            else:
                at = line + (place if place < width else period - 1 - place)
                place = place + 1 if place + 1 < period else 0
            weight = gauss - EDGE
            total = plus_texel(textures, at, weight, kind, total)
            weights += weight
            gauss *= fall
            fall *= fall_twice
    mean = 1.0 / weights if weights > 0.0 else 0.0
    return (total[0] * mean, total[1] * mean, total[2] * mean, total[3] * mean), weights


@inlined
def _variance(square: float, shrunk: float, size: int) -> float:
    """Of the weights along one axis, in texels of a size that is `shrunk` from the largest."""
    if size == 1:
        return LEAST_VARIANCE
    return max((square + 3.0) * shrunk * shrunk / 12.0 - 1.0 / 12.0, LEAST_VARIANCE)
