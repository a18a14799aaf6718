"""Means of textures over rectangles by summed-area tables, whatever lies outside 0..1.

Crow 1984, "Summed-Area Tables for Texture Mapping". A long slanted footprint is covered by up to
MAX_BOXES rectangles along its longer axis. The table continues outside the texture as the texels
do: repeated, S(x + W) = S(x) + S(W); mirrored, S(2W - x) = 2 S(W) - S(x); clamped, it goes on
linearly as at the border. So a rectangle's sum is that of a few entries however many copies of the
texture it spans, and exact but for the rounding of texels to 1 / ONE.
"""

import math
from typing import NamedTuple

from raysvc.jit import inlined, kernel
from raysvc.shading.ellipse_kernels import Spread, longer_direction, squared_axes
from raysvc.shading.texel_kernels import (
    DATA,
    MIRROR,
    NO_TEXEL,
    REPEAT,
    TextureTable,
    Vec2,
    Vec4,
    brought_near,
)
from raysvc.types import Bytes, Floats, Ints, Longs

MAX_BOXES = 8
Size = tuple[int, int]
ONE = 1 << 24
"""What a texel of value 1 adds; 8192 x 8192 of them stay below 2^53, where doubles are exact."""


class TextureSums(NamedTuple):
    """Summed-area tables of T textures."""

    sums: Longs
    """(N, 4) int64 in units of 1 / ONE: tables of (h + 1) rows of (w + 1) entries; entry (i, j) is
    the sum of texels in rows above i and columns left of j."""
    start: Longs
    """(T, 2) where in `sums` the table of each texture begins, read as DATA and as COLOUR; -1 where
    there is none."""
    level: Ints
    """(T, 2) the size of the texture that the table is of."""


@kernel
def accumulate(texels: Bytes, kind: int, decoding: Floats, sums: Longs) -> None:
    """Fill sums (h + 1, w + 1, 4), row and column 0 of which are zero, from texels (h, w, 4)."""
    for row in range(texels.shape[0]):
        for channel in range(4):
            running = 0
            code = DATA if channel == 3 else kind
            for col in range(texels.shape[1]):
                running += int(decoding[code, texels[row, col, channel]] * ONE + 0.5)
                sums[row + 1, col + 1, channel] = sums[row, col + 1, channel] + running


@inlined
def _edge(x: float, size: int, wrap: int) -> tuple[int, float, float, float]:
    """S at a coordinate as sign ((1 - part) S[i] + part S[i + 1]) + whole S[size]."""
    sign, whole = 1.0, 0.0
    if wrap == REPEAT:
        whole = math.floor(x / size)
        x -= whole * size
    elif wrap == MIRROR:
        whole = 2.0 * math.floor(0.5 * x / size)
        x -= whole * size
        if x > size:
            sign, whole, x = -1.0, whole + 2.0, 2.0 * size - x
    # Outside a clamped texture `part` is not within 0..1, and extrapolates
    i = min(max(math.floor(x), 0), size - 1)
    return i, x - i, sign, whole


@inlined
def _between(
    low: float, high: float, size: int, wrap: int
) -> tuple[tuple[int, int, int, int, int], tuple[float, float, float, float, float]]:
    """Entries of a table along one axis, and their weights, that make S(high) - S(low)."""
    i, part_low, sign_low, whole_low = _edge(low, size, wrap)
    j, part_high, sign_high, whole_high = _edge(high, size, wrap)
    # Numba wants all entries as wide as computed ones: sizes are of 32 bits
    return (i, i + 1, j, j + 1, size + 0), (
        -sign_low * (1.0 - part_low),
        -sign_low * part_low,
        sign_high * (1.0 - part_high),
        sign_high * part_high,
        whole_high - whole_low,
    )


@inlined
def box_sum(
    sums: TextureSums,
    start: int,
    size: Size,
    wraps: Size,
    low: Vec2,
    high: Vec2,
) -> Vec4:
    """Sum of texels, in units of 1 / ONE, over the rectangle from `low` to `high` in texels.

    `start` is where the table of a texture of (width, height) begins.
    """
    cols, across = _between(low[0], high[0], size[0], wraps[0])
    rows, down = _between(low[1], high[1], size[1], wraps[1])
    red = green = blue = alpha = 0.0
    for r in range(5):
        if down[r] == 0.0:
            continue
        line = start + rows[r] * (size[0] + 1)
        for c in range(5):
            if across[c] == 0.0:
                continue
            weight, at = down[r] * across[c], line + cols[c]
            red += weight * sums.sums[at, 0]
            green += weight * sums.sums[at, 1]
            blue += weight * sums.sums[at, 2]
            alpha += weight * sums.sums[at, 3]
    return red, green, blue, alpha


@inlined
def summed(
    textures: TextureTable,
    sums: TextureSums,
    texture: int,
    uv: Vec2,
    spread: Spread,
    kind: int,
) -> Vec4:
    """Linear RGBA of a texture over what a pixel covers, by boxes along the longer axis.

    `spread` is the pixel's matrix in texels of the largest size. Each box is a texel wider, as
    variances add, than its part of the pixel, which makes what is magnified linear interpolation.
    The boxes' places and widths have the variance of the pixel along both axes of the texture.
    """
    start, level = sums.start[texture, kind], sums.level[texture, kind]
    size = textures.size[texture, level, 0], textures.size[texture, level, 1]
    wraps = textures.sampler[texture, 0], textures.sampler[texture, 1]
    shrunk_x = size[0] / textures.size[texture, 0, 0]
    shrunk_y = size[1] / textures.size[texture, 0, 1]
    spread = (
        spread[0] * shrunk_x * shrunk_x,
        spread[1] * shrunk_x * shrunk_y,
        spread[2] * shrunk_y * shrunk_y,
    )
    longer, shorter = squared_axes(spread)
    along = longer_direction(spread, longer)
    length = math.sqrt(longer)
    length_x, length_y = length * along[0], length * along[1]

    # As many boxes as make each no thicker than the footprint, if it is slanted
    slant = min(abs(length_x), abs(length_y)) / math.sqrt(max(shorter, 1.0))
    boxes = int(min(math.ceil(slant), MAX_BOXES)) if slant > 1.0 else 1
    part_x, part_y = length_x / boxes, length_y / boxes
    half_x = 0.5 * math.sqrt(part_x * part_x + shorter * along[1] * along[1] + 1.0)
    half_y = 0.5 * math.sqrt(part_y * part_y + shorter * along[0] * along[0] + 1.0)
    u, v = brought_near(uv, wraps[0], wraps[1])
    x = u * size[0] - 0.5 * (boxes - 1) * part_x
    y = v * size[1] - 0.5 * (boxes - 1) * part_y
    total = NO_TEXEL
    for k in range(boxes):
        at_x, at_y = x + k * part_x, y + k * part_y
        low, high = (at_x - half_x, at_y - half_y), (at_x + half_x, at_y + half_y)
        some = box_sum(sums, start, size, wraps, low, high)
        total = (total[0] + some[0], total[1] + some[1], total[2] + some[2], total[3] + some[3])
    mean = 1.0 / (boxes * 4.0 * half_x * half_y * ONE)
    return total[0] * mean, total[1] * mean, total[2] * mean, total[3] * mean
