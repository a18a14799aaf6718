"""Reading a texture over what a pixel covers, by one of five filters."""

import math

from raysvc.jit import inlined
from raysvc.shading.ellipse_kernels import Spread, squared_axes
from raysvc.shading.ewa_kernels import ewa, ewa_level
from raysvc.shading.mip_kernels import nearest, plus_bilinear
from raysvc.shading.texel_kernels import NO_TEXEL, TextureTable, Vec2, Vec4
from raysvc.shading.texture_sum_kernels import TextureSums, summed

NEAREST, BILINEAR, MIP, EWA, SAT = range(5)
WIDEST = 1e20
"""Square of a footprint in texels; what is larger (or not a number) shows the mean."""


@inlined
def bilinear(textures: TextureTable, texture: int, uv: Vec2, kind: int) -> Vec4:
    """Linear RGBA of a texture's largest size, between texels; squares if the sampler says so."""
    if textures.sampler[texture, 2] == 1:
        return nearest(textures, texture, uv, kind)
    return plus_bilinear(textures, texture, 0, uv, (1.0, 1.0), kind, 1.0, NO_TEXEL)


@inlined
def filtered(
    textures: TextureTable,
    sums: TextureSums,
    texture: int,
    uv: Vec2,
    spread: Spread,
    texture_filter: int,
    kind: int,
) -> Vec4:
    """Linear RGBA of a texture at uv, over a pixel whose matrix in units of uv is `spread`.

    NEAREST and BILINEAR look at one point. MIP takes the mean of the two sizes next to the longer
    axis, EWA a Gaussian ellipse, SAT rectangles; `sums` is read by SAT alone. Where a pixel is
    smaller than a texel all but NEAREST interpolate linearly, unless the sampler says that texels
    are squares there: those have edges as wide as the pixel with EWA and SAT, else sharp ones.
    """
    width, height = textures.size[texture, 0, 0], textures.size[texture, 0, 1]
    # A size of 1 is the same everywhere along that axis.
    wide, tall = float(width if width > 1 else 0), float(height if height > 1 else 0)
    spread = (spread[0] * wide * wide, spread[1] * wide * tall, spread[2] * tall * tall)
    is_finite = spread[0] + spread[2] < WIDEST
    longer = squared_axes(spread)[0] if is_finite else WIDEST
    squares = textures.sampler[texture, 2] == 1 and longer <= 1.0
    by_area = texture_filter == EWA or texture_filter == SAT
    if texture_filter == NEAREST or (squares and not by_area):
        return nearest(textures, texture, uv, kind)

    # All that follows ends in linear interpolation within one size or two, if not before
    level, sharpness = 0.0, (1.0, 1.0)
    last = textures.levels[texture] - 1
    if squares:
        sharpness = (_sharpness(spread[0]), _sharpness(spread[2]))
    elif longer > 1.0 and texture_filter != BILINEAR:
        level = min(0.5 * math.log2(longer), float(last))
        if by_area and is_finite:
            # From linear interpolation to the whole filter without a jump
            if longer < 2.0:
                part = longer - 1.0
                spread = (spread[0] * part, spread[1] * part, spread[2] * part)
            if texture_filter == SAT:
                return summed(textures, sums, texture, uv, spread, kind)
            spread, whole_level = ewa_level(spread)
            level = float(min(whole_level, last))
            if whole_level < last:
                read, weights = ewa(textures, texture, whole_level, uv, spread, kind)
                if weights > 0.0:
                    return read
    lower = int(level)
    part = level - lower
    total, weight = NO_TEXEL, 1.0 - part
    for k in range(2 if part > 0.0 else 1):
        total = plus_bilinear(textures, texture, lower + k, uv, sharpness, kind, weight, total)
        weight = part
    return total


@inlined
def _sharpness(square: float) -> float:
    """Reciprocal of a pixel's width in texels; the largest number that is of use for a point."""
    return 1.0 / math.sqrt(max(square, 1e-12))
