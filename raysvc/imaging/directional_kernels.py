"""Edges smoothed along themselves: a directionally adaptive filter.

Iourcha, Yang and Pomianowski 2009, "A Directionally Adaptive Edge Anti-Aliasing Filter" (HPG). Near
an edge a picture is taken to change in one direction only, colour = g(u . x). Its gradient is that
of the plane which fits the 3 x 3 pixels about a pixel best, u the direction that the gradients of
all channels have most in common. A line across u is then of one colour: each of the nine pixels
counts as much as its line is long within the pixel.

The paper takes several samples of a pixel; here are only the centres, so that nothing is traced or
shaded. Light is compressed meanwhile, or one highlight would outshine the mean.
"""

import math

from raysvc.jit import inlined, kernel
from raysvc.types import Bools, Floats

LEAST_CHANGE = 1e-4
"""Squared length of a gradient, in compressed light per pixel, below which nothing is smoothed."""
LEAST_EXPLAINED = 0.6
"""Part of the nine pixels' variance that a change along u must explain: a step explains most of it,
while at corners, on thin lines and in foliage there is no one direction."""
RED, GREEN, BLUE = 0.2126, 0.7152, 0.0722


@inlined
def compressed_scale(red: float, green: float, blue: float) -> float:
    """1 / (1 + luminance): what a colour is multiplied by before it is averaged."""
    return 1.0 / (1.0 + max(RED * red + GREEN * green + BLUE * blue, 0.0))


@inlined
def chord(offset: float, across: float, along: float) -> float:
    """Length within a unit square of the line at `offset` from its centre.

    Its normal has components (across, along), a unit vector.
    """
    wide, narrow = max(abs(across), abs(along)), min(abs(across), abs(along))
    outer, inner = 0.5 * (wide + narrow), 0.5 * (wide - narrow)
    distance = abs(offset)
    if distance >= outer:
        return 0.0
    if distance <= inner:
        return 1.0 / wide
    return (outer - distance) / (wide * narrow)


@kernel
def smooth_along_edges(picture: Floats, mask: Bools, smoothed: Floats) -> None:
    """Fill `smoothed` (H, W, 4) from premultiplied RGBA (H, W, 4), filtered in the mask (H, W)."""
    height, width = mask.shape
    for row in range(height):
        for col in range(width):
            for k in range(4):
                smoothed[row, col, k] = picture[row, col, k]
            if not mask[row, col]:
                continue

            # Gradients of all channels, and their second moments
            xx, xy, yy, variance = 0.0, 0.0, 0.0, 0.0
            for k in range(4):
                right, down, mean, square = 0.0, 0.0, 0.0, 0.0
                for dy in range(-1, 2):
                    for dx in range(-1, 2):
                        y, x = min(max(row + dy, 0), height - 1), min(max(col + dx, 0), width - 1)
                        scale = compressed_scale(
                            picture[y, x, 0], picture[y, x, 1], picture[y, x, 2]
                        )
                        value = picture[y, x, k] * (scale if k < 3 else 1.0)
                        right += dx * value / 6.0
                        down += dy * value / 6.0
                        mean += value / 9.0
                        square += value * value
                xx += right * right
                xy += right * down
                yy += down * down
                variance += square - 9.0 * mean * mean

            # The direction that they have most in common
            middle, half = 0.5 * (xx + yy), 0.5 * (xx - yy)
            root = math.sqrt(half * half + xy * xy)
            most = middle + root
            # Along an axis the squares of the nine places add up to 6.
            if most < LEAST_CHANGE or 6.0 * most < LEAST_EXPLAINED * variance:
                continue
            ux, uy = (half + root, xy) if half >= 0.0 else (xy, root - half)
            length = math.sqrt(ux * ux + uy * uy)
            if length == 0.0:
                continue
            ux, uy = ux / length, uy / length

            # Every pixel by the length of its line
            total, red, green, blue, alpha = 0.0, 0.0, 0.0, 0.0, 0.0
            for dy in range(-1, 2):
                for dx in range(-1, 2):
                    y, x = min(max(row + dy, 0), height - 1), min(max(col + dx, 0), width - 1)
                    counts = chord(dx * ux + dy * uy, ux, uy)
                    scale = compressed_scale(picture[y, x, 0], picture[y, x, 1], picture[y, x, 2])
                    total += counts
                    red += counts * scale * picture[y, x, 0]
                    green += counts * scale * picture[y, x, 1]
                    blue += counts * scale * picture[y, x, 2]
                    alpha += counts * picture[y, x, 3]
            red, green, blue = red / total, green / total, blue / total
            luminance = RED * red + GREEN * green + BLUE * blue
            back = 1.0 / max(1.0 - luminance, 1e-6)
            smoothed[row, col, 0] = red * back
            smoothed[row, col, 1] = green * back
            smoothed[row, col, 2] = blue * back
            smoothed[row, col, 3] = alpha / total


@kernel
def contrasts(picture: Floats, contrast: Floats) -> None:
    """Fill contrast (H, W): the greatest difference to one of eight neighbours, light compressed.

    Of the channels of premultiplied RGBA (H, W, 4).
    """
    height, width = contrast.shape
    for row in range(height):
        for col in range(width):
            own = compressed_scale(picture[row, col, 0], picture[row, col, 1], picture[row, col, 2])
            greatest = 0.0
            for y in range(max(row - 1, 0), min(row + 2, height)):
                for x in range(max(col - 1, 0), min(col + 2, width)):
                    scale = compressed_scale(picture[y, x, 0], picture[y, x, 1], picture[y, x, 2])
                    for k in range(3):
                        apart = abs(scale * picture[y, x, k] - own * picture[row, col, k])
                        greatest = max(greatest, apart)
                    greatest = max(greatest, abs(picture[y, x, 3] - picture[row, col, 3]))
            contrast[row, col] = greatest
