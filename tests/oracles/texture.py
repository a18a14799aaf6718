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
