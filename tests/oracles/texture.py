"""Reading a texture, one point at a time, as glTF and OpenGL describe it."""

import math

import numpy as np


def srgb_to_linear(code):
    """Linear value of an 8-bit sRGB code."""
    s = code / 255
    return s / 12.92 if s <= 0.04045 else ((s + 0.055) / 1.055) ** 2.4


def texel_index(index, size, wrap):
    """Which texel stands at an index outside 0..size-1: by walking there."""
    if wrap == "clamp":
        return max(0, min(size - 1, index))
    if wrap == "repeat":
        return index - size * math.floor(index / size)
    tiles = math.floor(index / size)
    inside = index - size * tiles
    return inside if tiles % 2 == 0 else size - 1 - inside


def texel(texels, x, y, wraps, is_colour):
    """Linear RGBA of texel (x, y)."""
    height, width = texels.shape[:2]
    codes = texels[texel_index(y, height, wraps[1]), texel_index(x, width, wraps[0])]
    decode = srgb_to_linear if is_colour else (lambda code: code / 255)
    return np.array([*(decode(int(code)) for code in codes[:3]), codes[3] / 255])


def nearest(texels, u, v, wraps, is_colour):
    """The texel that holds (u, v)."""
    height, width = texels.shape[:2]
    return texel(texels, math.floor(u * width), math.floor(v * height), wraps, is_colour)


def bilinear(texels, u, v, wraps, is_colour):
    """Mean of the four texels about (u, v), by their distance in texels."""
    height, width = texels.shape[:2]
    x, y = u * width - 0.5, v * height - 0.5
    total = np.zeros(4)
    for row in (math.floor(y), math.floor(y) + 1):
        for col in (math.floor(x), math.floor(x) + 1):
            weight = (1 - abs(x - col)) * (1 - abs(y - row))
            total += weight * texel(texels, col, row, wraps, is_colour)
    return total


def halved(texels, is_colour):
    """The next smaller size: every texel the mean of those it covers, an odd last one folded in."""
    height, width = texels.shape[:2]
    h, w = max(height // 2, 1), max(width // 2, 1)
    smaller = np.zeros((h, w, 4))
    for row in range(h):
        for col in range(w):
            y = [r for r in range(height) if min(r * h // (height - height % 2 or 1), h - 1) == row]
            x = [c for c in range(width) if min(c * w // (width - width % 2 or 1), w - 1) == col]
            block = [texel(texels, c, r, ("clamp", "clamp"), is_colour) for r in y for c in x]
            smaller[row, col] = np.mean(block, axis=0)
    return smaller


def box_mean(texels, low, high, wraps, is_colour):
    """Mean over a rectangle in texels (x, y) of a texture whose texels are squares."""
    total = np.zeros(4)
    for row in range(math.floor(low[1]), math.ceil(high[1])):
        tall = min(high[1], row + 1) - max(low[1], row)
        for col in range(math.floor(low[0]), math.ceil(high[0])):
            wide = min(high[0], col + 1) - max(low[0], col)
            total += wide * tall * texel(texels, col, row, wraps, is_colour)
    return total / ((high[0] - low[0]) * (high[1] - low[1]))


def gaussian(texels, u, v, variance, wraps, is_colour):
    """Mean of all texels under exp(-2 r^2) - exp(-2) within an ellipse, r of its radius.

    variance (2, 2) of the weights, in texels.
    """
    height, width = texels.shape[:2]
    # Radius 1 has this variance, by summing over a fine grid.
    x, y = np.meshgrid(*[np.linspace(-1, 1, 801)] * 2)
    weight = np.maximum(np.exp(-2 * (x * x + y * y)) - np.exp(-2), 0)
    of_unit = (weight * x * x).sum() / weight.sum()
    inverse = np.linalg.inv(variance / of_unit)
    reach = np.ceil(np.sqrt(np.diag(variance / of_unit))).astype(int) + 1
    at = np.array([u * width - 0.5, v * height - 0.5])
    total, weights = np.zeros(4), 0.0
    for row in range(math.floor(at[1]) - reach[1], math.floor(at[1]) + reach[1] + 2):
        for col in range(math.floor(at[0]) - reach[0], math.floor(at[0]) + reach[0] + 2):
            away = np.array([col, row]) - at
            square = away @ inverse @ away
            if square < 1:
                counts = math.exp(-2 * square) - math.exp(-2)
                total += counts * texel(texels, col, row, wraps, is_colour)
                weights += counts
    return total / weights
