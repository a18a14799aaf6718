"""Edges smoothed along themselves: a directionally adaptive filter.

Iourcha, Yang and Pomianowski 2009, "A Directionally Adaptive Edge Anti-Aliasing Filter" (HPG). Near
an edge a picture is taken to change in one direction only, colour = g(u . x). Its gradient is that
of the plane which fits the samples of the 3 x 3 pixels about a pixel best, u the direction that the
gradients of all channels have most in common. A line across u is then of one colour: each sample
counts as much as its line is long within the pixel.

Light is compressed meanwhile, or one highlight would outshine the mean.
"""

import math

from raysvc.jit import inlined, kernel
from raysvc.types import Doubles, Floats, Ints, Longs

LEAST_CHANGE = 1e-4
"""Squared length of a gradient, in compressed light per pixel, below which there is no edge."""
LEAST_EXPLAINED = 0.55
"""Part of the samples' variance that a change along u must explain. A straight step explains three
quarters of it, two thirds if it is diagonal or at the pixel's border; at corners, on thin lines
and in foliage there is no one direction."""
RED, GREEN, BLUE = 0.2126, 0.7152, 0.0722


@kernel
def compress(rgba: Floats, back: bool) -> None:
    """Multiply premultiplied RGBA (N, 4) by 1 / (1 + luminance) in place, or undo that (`back`)."""
    for n in range(len(rgba)):
        luminance = RED * rgba[n, 0] + GREEN * rgba[n, 1] + BLUE * rgba[n, 2]
        if back:
            scale = 1.0 / max(1.0 - luminance, 1e-6)
        else:
            scale = 1.0 / (1.0 + max(luminance, 0.0))
        for k in range(3):
            rgba[n, k] *= scale


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
def smooth_along_edges(
    picture: Floats,
    slot: Ints,
    samples: Floats,
    offsets: Doubles,
    pixel: Longs,
    smoothed: Floats,
) -> None:
    """Fill `smoothed` (P, 4) with what pixels (P,), row * W + col, show.

    A pixel about which no one direction explains the samples shows the mean of its own.

    Parameters
    ----------
    picture
        (H, W, 4) compressed premultiplied RGBA of pixel centres
    slot
        (H, W) which of the Q pixels with samples a pixel is; -1 for one whose samples are all of
        its centre's colour
    samples
        (Q, S, 4) compressed premultiplied RGBA
    offsets
        (S, 2) places of samples from the centre of their pixel, in pixels to the right and down
    """
    height, width = slot.shape
    count = len(offsets)
    xx, xy, yy = 0.0, 0.0, 0.0
    for s in range(count):
        for place in range(9):
            x, y = place % 3 - 1 + offsets[s, 0], place // 3 - 1 + offsets[s, 1]
            xx += x * x
            xy += x * y
            yy += y * y
    determinant = xx * yy - xy * xy

    for n in range(len(pixel)):
        row, col = pixel[n] // width, pixel[n] % width

        # Gradients of all channels, their second moments, and all that there is to explain
        gxx, gxy, gyy, variance = 0.0, 0.0, 0.0, 0.0
        for k in range(4):
            right, down, total, square = 0.0, 0.0, 0.0, 0.0
            for place in range(9):
                dx, dy = place % 3 - 1, place // 3 - 1
                v, u = min(max(row + dy, 0), height - 1), min(max(col + dx, 0), width - 1)
                q = slot[v, u]
                for s in range(count):
                    value = samples[q, s, k] if q >= 0 else picture[v, u, k]
                    right += (dx + offsets[s, 0]) * value
                    down += (dy + offsets[s, 1]) * value
                    total += value
                    square += value * value
            gx = (right * yy - down * xy) / determinant
            gy = (down * xx - right * xy) / determinant
            gxx += gx * gx
            gxy += gx * gy
            gyy += gy * gy
            variance += square - total * total / (9.0 * count)

        # The direction that they have most in common
        middle, half = 0.5 * (gxx + gyy), 0.5 * (gxx - gyy)
        root = math.sqrt(half * half + gxy * gxy)
        ux, uy = (half + root, gxy) if half >= 0.0 else (gxy, root - half)
        length = math.sqrt(ux * ux + uy * uy)
        most, explained = middle + root, 0.0
        if length > 0.0:
            ux, uy = ux / length, uy / length
            explained = most * (xx * ux * ux + 2.0 * xy * ux * uy + yy * uy * uy)
        directed = most >= LEAST_CHANGE and explained >= LEAST_EXPLAINED * variance

        # Every sample by the length of its line
        weight, red, green, blue, alpha = 0.0, 0.0, 0.0, 0.0, 0.0
        for place in range(9):
            dx, dy = place % 3 - 1, place // 3 - 1
            if not directed and place != 4:
                continue
            v, u = min(max(row + dy, 0), height - 1), min(max(col + dx, 0), width - 1)
            q = slot[v, u]
            for s in range(count):
                counts = 1.0
                if directed:
                    counts = chord((dx + offsets[s, 0]) * ux + (dy + offsets[s, 1]) * uy, ux, uy)
                if counts > 0.0:
                    weight += counts
                    red += counts * (samples[q, s, 0] if q >= 0 else picture[v, u, 0])
                    green += counts * (samples[q, s, 1] if q >= 0 else picture[v, u, 1])
                    blue += counts * (samples[q, s, 2] if q >= 0 else picture[v, u, 2])
                    alpha += counts * (samples[q, s, 3] if q >= 0 else picture[v, u, 3])
        smoothed[n, 0], smoothed[n, 1] = red / weight, green / weight
        smoothed[n, 2], smoothed[n, 3] = blue / weight, alpha / weight
