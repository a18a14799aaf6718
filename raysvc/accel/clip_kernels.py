"""Bounds of the part of a triangle that lies in a box: the "perfect split" of Havran and Bittner
2002.

The triangle is clipped plane by plane (Sutherland and Hodgman 1974) in double precision.
"""

import numpy as np

from raysvc.jit import inlined, kernel
from raysvc.types import Doubles, Floats

ROUNDING = 2.0**-40
"""Clipped bounds are extended by this part of the greatest coordinate: far more than is
ever lost.
"""
POLYGON = 30
"""Coordinates that a clipped triangle may have: three corners and one more for each of
six planes.
"""


@inlined
def _cut(
    polygon: Doubles, count: int, axis: int, plane: float, sign: float, result: Doubles
) -> int:
    """Keep what has sign * (coordinate - plane) >= 0 of a polygon; return its number of corners."""
    kept = 0
    for n in range(count):
        here, there = 3 * n, 3 * ((n + 1) % count)
        a = sign * (polygon[here + axis] - plane)
        b = sign * (polygon[there + axis] - plane)
        if a >= 0.0:
            for k in range(3):
                result[3 * kept + k] = polygon[here + k]
            kept += 1
        if (a < 0.0) != (b < 0.0) and a != 0.0 and b != 0.0:
            part = a / (a - b)
            for k in range(3):
                result[3 * kept + k] = polygon[here + k] + part * (
                    polygon[there + k] - polygon[here + k]
                )
            result[3 * kept + axis] = plane
            kept += 1
    return kept


@kernel
def clip_to_box(corners: Floats, at: int, box: Doubles, polygon: Doubles, other: Doubles) -> int:
    """Fill polygon with the part of the triangle at corners[at] in box (6,); return its corners.

    polygon and other (POLYGON,) are scratch; 0 corners if nothing is inside.
    """
    for k in range(9):
        polygon[k] = np.float64(corners[at + k])
    count = 3
    for axis in range(3):
        for side in range(2):
            plane = box[3 * side + axis]
            sign = 1.0 - 2.0 * side
            outside = False
            for n in range(count):
                outside = outside or sign * (polygon[3 * n + axis] - plane) < 0.0
            if outside:
                count = _cut(polygon, count, axis, plane, sign, other)
                for k in range(3 * count):
                    polygon[k] = other[k]
    return count


@kernel
def clip_bounds(
    corners: Floats, at: int, box: Doubles, polygon: Doubles, other: Doubles, bounds: Floats
) -> bool:
    """Narrow bounds (6,) to those of the triangle at corners[at] inside box (6,); False if none is.

    polygon and other (POLYGON,) are scratch. Bounds are rounded outwards, and never grow.
    """
    count = clip_to_box(corners, at, box, polygon, other)
    if count == 0:
        return False
    size = 0.0
    for k in range(9):
        size = max(size, abs(np.float64(corners[at + k])))
    margin = ROUNDING * size
    for axis in range(3):
        low, high = np.inf, -np.inf
        for n in range(count):
            low, high = min(low, polygon[3 * n + axis]), max(high, polygon[3 * n + axis])
        low, high = max(low - margin, box[axis]), min(high + margin, box[3 + axis])
        below, above = np.float32(low), np.float32(high)
        if below > low:
            below = np.nextafter(below, np.float32(-np.inf))
        if above < high:
            above = np.nextafter(above, np.float32(np.inf))
        bounds[axis] = max(bounds[axis], below)
        bounds[3 + axis] = min(bounds[3 + axis], above)
    return True


@kernel
def area_of(polygon: Doubles, count: int) -> float:
    """Area of a flat convex polygon of so many corners."""
    x = y = z = 0.0
    for n in range(1, count - 1):
        ax, ay, az = (
            polygon[3 * n] - polygon[0],
            polygon[3 * n + 1] - polygon[1],
            polygon[3 * n + 2] - polygon[2],
        )
        bx, by, bz = (
            polygon[3 * n + 3] - polygon[0],
            polygon[3 * n + 4] - polygon[1],
            polygon[3 * n + 5] - polygon[2],
        )
        x, y, z = x + ay * bz - az * by, y + az * bx - ax * bz, z + ax * by - ay * bx
    return float(0.5 * np.sqrt(x * x + y * y + z * z))
