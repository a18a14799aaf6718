"""Which pixel centres a triangle covers, in exact rational arithmetic, one pixel at a time."""

from fractions import Fraction

import numpy as np


def covered(corners, width, height):
    """(height, width) bool: the centre is inside, or on a top or left edge.

    corners: three (x, y) in pixels, y downwards, as Fractions (or integers), in either order.
    """
    (ax, ay), (bx, by), (cx, cy) = corners
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    picture = np.zeros((height, width), bool)
    if area == 0:
        return picture
    if area < 0:
        corners = corners[::-1]
    edges = [(corners[k], corners[(k + 1) % 3]) for k in range(3)]
    for row in range(height):
        for col in range(width):
            centre = (col + Fraction(1, 2), row + Fraction(1, 2))
            picture[row, col] = all(_inside(edge, centre) for edge in edges)
    return picture


def _inside(edge, point):
    """Right of an edge of a clockwise triangle, or on it if it is a top or left edge."""
    (x0, y0), (x1, y1) = edge
    side = (x1 - x0) * (point[1] - y0) - (y1 - y0) * (point[0] - x0)
    is_left = y1 < y0
    is_top = y1 == y0 and x1 > x0
    return side > 0 or (side == 0 and (is_left or is_top))
