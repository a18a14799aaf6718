"""Spreading the slow way: every square drawn pixel by pixel, in double precision."""

import numpy as np


def coverage(begin, end, size):
    """(size,) how much of each pixel [begin, end) covers, what leaves 0..size mirrored back in."""
    edges = np.arange(-size, 2 * size, dtype=float)
    covered = np.clip(np.minimum(edges + 1, end) - np.maximum(edges, begin), 0, None)
    left, inside, right = covered[:size], covered[size : 2 * size], covered[2 * size :]
    return inside + left[::-1] + right[::-1]


def splat(values, membership, side):
    """(C, H, W) sums of values (C, H, W) times membership (H, W) over squares of side (H, W)."""
    _, height, width = values.shape
    out = np.zeros(values.shape)
    for y in range(height):
        for x in range(width):
            if membership[y, x] > 0:
                half = side[y, x] / 2
                down = coverage(y + 0.5 - half, y + 0.5 + half, height)
                across = coverage(x + 0.5 - half, x + 0.5 + half, width)
                square = np.outer(down, across) * membership[y, x] / side[y, x] ** 2
                out += values[:, y, x, None, None] * square
    return out


def spread(rgba, coc):
    """(H, W, 4) blur of a picture with nothing nearer than the focus, from the definition."""
    side = np.minimum(np.abs(coc) * np.sqrt(3) / 2, 2 * min(coc.shape)).astype(float)
    sharp = side <= 1
    share = np.clip(np.log2(np.maximum(side, 1) / 4) / 2, 0, 1)
    values = np.concatenate([np.moveaxis(rgba, 2, 0), np.ones((1, *coc.shape))])
    picture, known = np.zeros(rgba.shape), np.zeros(coc.shape)
    for membership in (share, 1 - share):
        sums = splat(values, np.where(sharp, 0, membership), side)
        for y, x in np.argwhere(sums[4] > 0):
            weight = sums[4, y, x]
            cover = min(weight, 1)
            rest = (1 - cover) * known[y, x]
            front = sums[:4, y, x] / weight
            picture[y, x] = (cover * front + rest * picture[y, x]) / (cover + rest)
            known[y, x] = max(known[y, x], min(1, 2 * weight))
    picture[sharp] = rgba[sharp]
    return picture
