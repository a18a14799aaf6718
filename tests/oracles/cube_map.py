"""A lat-long map of six pictures, texel by texel and in plain Python."""

import math

import numpy as np


def face_towards(faces, direction):
    """Number of the (6, 3, 3) face that a direction goes through."""
    return int(np.argmax([forward @ direction for _, _, forward in faces]))


def lookup(pictures, faces, direction):
    """Bilinear interpolation between pixel centres of pictures with a border of one pixel."""
    number = face_towards(faces, direction)
    right, up, forward = faces[number]
    size = pictures.shape[1] - 2
    across, down = (
        right @ direction / (forward @ direction),
        -(up @ direction) / (forward @ direction),
    )
    x, y = (across + 1) / 2 * size + 0.5, (down + 1) / 2 * size + 0.5
    left, top = math.floor(x), math.floor(y)
    total = np.zeros(3)
    for row in (top, top + 1):
        for column in (left, left + 1):
            weight = (1 - abs(x - column)) * (1 - abs(y - row))
            total += weight * pictures[number, row, column]
    return total


def lat_long(pictures, faces, detail):
    """(2 S, 4 S, 3): means of detail x detail lookups in every texel."""
    size = pictures.shape[1] - 2
    result = np.zeros((2 * size, 4 * size, 3))
    places = (np.arange(detail) + 0.5) / detail
    for row in range(2 * size):
        for column in range(4 * size):
            for v in places:
                for u in places:
                    polar = math.pi * (row + v) / (2 * size)
                    azimuth = math.tau * ((column + u) / (4 * size) - 0.5)
                    level = math.sin(polar)
                    direction = np.array(
                        [level * math.sin(azimuth), math.cos(polar), -level * math.cos(azimuth)]
                    )
                    result[row, column] += lookup(pictures, faces, direction) / detail**2
    return result
