"""Spreading the slow way: every shape drawn pixel by pixel, in double precision."""

import numpy as np

SIDE = np.sqrt(3) / 2


def along(begin, end, size):
    """(size,) how much of each pixel [begin, end) covers, what leaves 0..size mirrored back in."""
    edges = np.arange(-size, 2 * size, dtype=float)
    covered = np.clip(np.minimum(edges + 1, end) - np.maximum(edges, begin), 0, None)
    return mirrored(covered)


def mirrored(values):
    """(n, ...) of (3n, ...): the parts before and after are mirrored back into the middle one."""
    size = len(values) // 3
    return values[size : 2 * size] + values[:size][::-1] + values[2 * size :][::-1]


def square(y, x, diameter, height, width):
    """(H, W) share of a point in pixel (y, x) that each pixel gets of its square."""
    half = np.rint(diameter * SIDE / 2 * 64) / 64
    down = along(y + 0.5 - half, y + 0.5 + half, height)
    across = along(x + 0.5 - half, x + 0.5 + half, width)
    return np.outer(down, across) / (4 * half**2)


def smooth(order):
    """The same for a box of an order: folded with itself by np.convolve."""

    def share(y, x, diameter, height, width):
        kernel = smooth_kernel(diameter, order)
        lines = []
        for at, size in ((y, height), (x, width)):
            line = np.zeros((3 * size, 2))
            first = size + at - len(kernel[0]) // 2
            for k in range(2):
                begin = size + at - len(kernel[k]) // 2
                line[begin : begin + len(kernel[k]), k] = kernel[k]
            assert first >= 0
            lines.append(mirrored(line))
        down, across = lines
        parts = mix(diameter, order)
        return sum(parts[k] * np.outer(down[:, k], across[:, k]) for k in range(2))

    return share


def mix(diameter, order):
    """How much there is of the narrower and of the wider box."""
    square_width = 0.75 * diameter**2 / order + 1
    width = odd_below(np.sqrt(square_width))
    wider = (square_width - width**2) / ((width + 2) ** 2 - width**2)
    return 1 - wider, wider


def odd_below(value):
    return int(np.floor((value - 1) / 2 + 1e-12)) * 2 + 1


def smooth_kernel(diameter, order):
    width = odd_below(np.sqrt(0.75 * diameter**2 / order + 1))
    found = []
    for w in (width, width + 2):
        line = np.ones(1)
        for _ in range(order):
            line = np.convolve(line, np.full(w, 1 / w))
        found.append(line)
    return found


def aperture(blades=0, rotation_deg=0.0, samples=32):
    """The same for a disc or polygon: many points of each pixel are asked if they are inside."""
    corners = np.radians(90 + rotation_deg) + np.arange(max(blades, 1)) * 2 * np.pi / max(blades, 1)

    def inside(u, v):
        if blades == 0:
            return u**2 + v**2 <= 1
        found = np.ones(np.broadcast(u, v).shape, bool)
        for a, b in zip(corners, np.roll(corners, -1), strict=True):
            # Counter-clockwise with v up: inside is to the left of every side.
            found &= (np.cos(b) - np.cos(a)) * (v - np.sin(a)) >= (np.sin(b) - np.sin(a)) * (
                u - np.cos(a)
            )
        return found

    def share(y, x, diameter, height, width):
        radius = abs(diameter) / 2 * (1 if diameter > 0 else -1)
        at = (np.arange(3 * height * samples) + 0.5) / samples - height
        across = (np.arange(3 * width * samples) + 0.5) / samples - width
        covered = inside((across - x - 0.5) / radius, -(at[:, None] - y - 0.5) / radius)
        covered = covered.reshape(3 * height, samples, 3 * width, samples).mean(axis=(1, 3))
        return mirrored(mirrored(covered).T).T / covered.sum()

    return share


def splat(values, membership, diameter, share=square):
    """(C, H, W) sums of values (C, H, W) by membership (H, W) over shapes of diameters (H, W)."""
    _, height, width = values.shape
    out = np.zeros(values.shape)
    for y in range(height):
        for x in range(width):
            if membership[y, x] > 0:
                part = share(y, x, diameter[y, x], height, width) * membership[y, x]
                out += values[:, y, x, None, None] * part
    return out
