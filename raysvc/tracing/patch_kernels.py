"""Inner loops over the elements into which triangles are cut.

The edges of a triangle are cut into n parts each, and lines parallel to its edges cut it into n^2
elements. In the row of u in [i, i + 1) / n there are n - i elements like the triangle, numbered
i (2 n - i) + 2 j, and between them n - i - 1 that stand on their heads, each numbered after the one
to its left.
"""

import math
from typing import NamedTuple

import numpy as np

from raysvc.geometry.vector_kernels import Vec3, cross, dot, plus, row3, scaled, unit_or
from raysvc.jit import inlined, kernel
from raysvc.types import Bytes, Doubles, Floats, Ints, Longs

CELL_BITS = 20
"""Of a cell's number along each axis."""
GOLDEN = 0.6180339887498949
SILVER = 0.4142135623730950
OFF_EDGES = 0.01
"""By how much samples keep off the edges of elements."""


class PatchTable(NamedTuple):
    """To which patch every element of F triangles belongs."""

    parts: Ints
    """(F,) into how many parts each edge of a triangle is cut."""
    first: Ints
    """(F,) number of a triangle's first element."""
    patch: Ints
    """(2, E) patch of each element's front and back."""


@inlined
def _edges(positions: Floats, triangles: Ints, f: int) -> tuple[Vec3, Vec3, Vec3]:
    """First corner of a triangle and its edges from there."""
    a = row3(positions, triangles[f, 0])
    return (
        a,
        plus(row3(positions, triangles[f, 1]), a, -1.0),
        plus(row3(positions, triangles[f, 2]), a, -1.0),
    )


@inlined
def _corner(n: int, number: int) -> tuple[int, int, bool]:
    """Row i, place j and whether it stands on its head, of element `number` of n^2."""
    i = n - 1 - int(math.sqrt(n * n - 1 - number + 0.5))
    rest = number - i * (2 * n - i)
    return i, rest // 2, rest % 2 == 1


@inlined
def _within(n: int, number: int, s: float, t: float) -> tuple[float, float]:
    """Barycentrics u, v of the place (s, t), s + t <= 1, within an element."""
    i, j, upside_down = _corner(n, number)
    if upside_down:
        return (i + 1.0 - s) / n, (j + 1.0 - t) / n
    return (i + s) / n, (j + t) / n


@inlined
def _facing(normal: Vec3) -> int:
    """Which of the six ways along the axes a direction goes, about."""
    ax, ay, az = abs(normal[0]), abs(normal[1]), abs(normal[2])
    if ax >= ay and ax >= az:
        return 0 if normal[0] >= 0.0 else 1
    if ay >= az:
        return 2 if normal[1] >= 0.0 else 3
    return 4 if normal[2] >= 0.0 else 5


@kernel
def measure_triangles(positions: Floats, triangles: Ints, areas: Doubles, longest: Doubles) -> None:
    """Fill areas (F,), and lengths (F,) of the longest edges."""
    for f in range(len(triangles)):
        _, e1, e2 = _edges(positions, triangles, f)
        across = cross(e1, e2)
        areas[f] = 0.5 * math.sqrt(dot(across, across))
        e3 = plus(e2, e1, -1.0)
        longest[f] = math.sqrt(max(dot(e1, e1), dot(e2, e2), dot(e3, e3)))


@kernel
def key_elements(
    positions: Floats,
    triangles: Ints,
    table: PatchTable,
    low: Doubles,
    size: float,
    keys: Longs,
) -> None:
    """Fill keys (2, E): the same number for fronts or backs in one cell that face the same way.

    Cells are `size` wide and begin at the point `low` (3,).
    """
    greatest = (1 << CELL_BITS) - 1
    for f in range(len(triangles)):
        a, e1, e2 = _edges(positions, triangles, f)
        normal = cross(e1, e2)
        front, back = _facing(normal), _facing(scaled(normal, -1.0))
        n = table.parts[f]
        for number in range(n * n):
            u, v = _within(n, number, 1.0 / 3.0, 1.0 / 3.0)
            centre = plus(plus(a, e1, u), e2, v)
            x = min(max(int((centre[0] - low[0]) / size), 0), greatest)
            y = min(max(int((centre[1] - low[1]) / size), 0), greatest)
            z = min(max(int((centre[2] - low[2]) / size), 0), greatest)
            cell = (((x << CELL_BITS) | y) << CELL_BITS) | z
            keys[0, table.first[f] + number] = cell * 6 + front
            keys[1, table.first[f] + number] = cell * 6 + back


@kernel
def place_samples(
    positions: Floats,
    triangles: Ints,
    table: PatchTable,
    triangle: Ints,
    element: Ints,
    side: Bytes,
    barycentric: Floats,
    towards: Floats,
) -> None:
    """Fill barycentric (S, 2) with a point of each element, towards (S, 3) with its side's normal.

    Points of consecutive samples are spread by two irrational steps.
    """
    for k in range(len(element)):
        f = triangle[k]
        s, t = (k * GOLDEN) % 1.0, (k * SILVER) % 1.0
        if s + t > 1.0:
            s, t = 1.0 - s, 1.0 - t
        # Rounding must not move it to the next element
        s, t = s + (1.0 / 3.0 - s) * OFF_EDGES, t + (1.0 / 3.0 - t) * OFF_EDGES
        u, v = _within(table.parts[f], element[k] - table.first[f], s, t)
        barycentric[k, 0], barycentric[k, 1] = u, v
        _, e1, e2 = _edges(positions, triangles, f)
        normal = unit_or(cross(e1, e2), (0.0, 1.0, 0.0))
        for c in range(3):
            towards[k, c] = normal[c] if side[k] == 0 else -normal[c]


@kernel
def look_up_patches(
    positions: Floats,
    triangles: Ints,
    table: PatchTable,
    triangle: Ints,
    barycentric: Floats,
    directions: Floats,
    patch: Ints,
) -> None:
    """Fill patch (R,) of rays along `directions` that have met points of triangles, -1 of none."""
    for r in range(len(triangle)):
        f = triangle[r]
        patch[r] = -1
        if f < 0:
            continue
        n = table.parts[f]
        number = 0
        if n > 1:
            u, v = np.float64(barycentric[r, 0]) * n, np.float64(barycentric[r, 1]) * n
            i = min(int(u), n - 1)
            j = min(int(v), n - 1 - i)
            number = i * (2 * n - i) + 2 * j
            if u - i + v - j > 1.0 and j < n - 1 - i:
                number += 1
        _, e1, e2 = _edges(positions, triangles, f)
        side = 1 if dot(cross(e1, e2), row3(directions, r)) > 0.0 else 0
        patch[r] = table.patch[side, table.first[f] + number]
