"""How normals and tangents go along when the vertices of a surface move.

A triangle's old and new corners say how its neighbourhood was turned, stretched and sheared, but
for the thickness; that is taken to scale as the root of the area, so that turning and scaling are
exact. Tangents go by this map, normals by its inverse transpose (glTF 2.0 transforms them so too),
and each vertex takes the mean of what its triangles say. Unlike normals made anew from the
triangles, these stay what an author made of them.
"""

import math

import numpy as np

from raysvc.geometry.vector_kernels import cross, dot, plus, row3, scaled
from raysvc.jit import inlined, kernel
from raysvc.types import Bools, Doubles, Floats, Ints, Longs

AGREE = math.cos(math.radians(0.1))
"""Cosine from which two directions are one: files round them."""
MOST_LEADERS = 64
"""Different normals at one place; further ones stay alone, so that time is bounded."""


@kernel
def smooth_groups(
    order: Longs,
    starts: Longs,
    normals: Floats,
    tangents: Floats,
    positions: Floats,
    reach: float,
    group: Longs,
    tangent_group: Longs,
) -> None:
    """Fill group (V,) with one vertex of those whose normals are one, tangent_group with those
    whose tangents are one too.

    Vertices were at one place if they are neighbours in order (V,), between two of starts (P + 1,).
    They belong together if their normals agreed, which tells smooth seams from hard edges, and if
    they are still within `reach` of each other at positions (V, 3), which tells where the surface
    was torn.
    """
    leaders = np.empty(MOST_LEADERS, np.int64)
    tangent_leaders = np.empty(MOST_LEADERS, np.int64)
    for place in range(len(starts) - 1):
        led, tangent_led = 0, 0
        for n in range(starts[place], starts[place + 1]):
            v = order[n]
            group[v], tangent_group[v] = v, v
            normal, at = row3(normals, v), row3(positions, v)
            for k in range(led):
                u = leaders[k]
                apart = plus(row3(positions, u), at, -1.0)
                near = dot(apart, apart) <= reach * reach
                if near and dot(row3(normals, u), normal) >= AGREE:
                    group[v] = u
                    break
            if group[v] == v and led < MOST_LEADERS:
                leaders[led] = v
                led += 1
            for k in range(tangent_led):
                u = tangent_leaders[k]
                if (
                    group[u] == group[v]
                    and tangents[u, 3] == tangents[v, 3]
                    and dot(row3(tangents, u), row3(tangents, v)) >= AGREE
                ):
                    tangent_group[v] = u
                    break
            if tangent_group[v] == v and tangent_led < MOST_LEADERS:
                tangent_leaders[tangent_led] = v
                tangent_led += 1


@kernel
def carry(
    rest: Floats,
    positions: Floats,
    normals: Floats,
    tangents: Floats,
    triangles: Ints,
    group: Longs,
    tangent_group: Longs,
    moved: Bools,
    normal_sums: Doubles,
    tangent_sums: Doubles,
) -> None:
    """Add to the groups' sums (V, 3) what each triangle says of its corners' normals and tangents.

    rest and positions (V, 3) are the vertices before and after. Weights are the geometric mean of
    the areas before and after, so that a sliver in either shape has little to say and a triangle
    without area nothing. moved (V,) becomes True for groups of which a triangle has changed.
    """
    for f in range(len(triangles)):
        i, j, k = triangles[f, 0], triangles[f, 1], triangles[f, 2]
        if (
            _differs(rest, positions, i)
            or _differs(rest, positions, j)
            or _differs(rest, positions, k)
        ):
            moved[group[i]] = True
            moved[group[j]] = True
            moved[group[k]] = True

        # Edges, normals of twice the area's length, and duals of the edges in the plane
        old_a, new_a = row3(rest, i), row3(positions, i)
        old_1, old_2 = plus(row3(rest, j), old_a, -1.0), plus(row3(rest, k), old_a, -1.0)
        new_1, new_2 = plus(row3(positions, j), new_a, -1.0), plus(row3(positions, k), new_a, -1.0)
        old_n, new_n = cross(old_1, old_2), cross(new_1, new_2)
        old_square, new_square = dot(old_n, old_n), dot(new_n, new_n)
        if old_square == 0.0 or new_square == 0.0:
            continue
        old_area, new_area = math.sqrt(old_square), math.sqrt(new_square)
        weight = math.sqrt(old_area) * math.sqrt(new_area)
        thickness = math.sqrt(new_area / old_area)
        old_d1 = scaled(cross(old_2, old_n), 1.0 / old_square)
        old_d2 = scaled(cross(old_n, old_1), 1.0 / old_square)
        new_d1 = scaled(cross(new_2, new_n), thickness / new_square)
        new_d2 = scaled(cross(new_n, new_1), thickness / new_square)

        for corner in range(3):
            v = triangles[f, corner]
            normal = row3(normals, v)
            across = scaled(new_n, dot(normal, old_n) / (old_area * new_area))
            along = plus(scaled(new_d1, dot(normal, old_1)), new_d2, dot(normal, old_2))
            _add(normal_sums, group[v], plus(across, along, 1.0), weight)
            if tangents[v, 3] != 0.0:
                tangent = row3(tangents, v)
                along = plus(scaled(new_1, dot(tangent, old_d1)), new_2, dot(tangent, old_d2))
                out = thickness * dot(tangent, old_n) / (old_area * new_area)
                _add(tangent_sums, tangent_group[v], plus(along, new_n, out), weight)


@kernel
def settle_normals(group: Longs, moved: Bools, sums: Doubles, normals: Floats) -> None:
    """Replace normals (V, 3) of groups that have moved by their mean, where there is one."""
    for v in range(len(normals)):
        if not moved[group[v]]:
            continue
        mean = row3(sums, group[v])
        length = math.sqrt(dot(mean, mean))
        if length > 0.0:
            for k in range(3):
                normals[v, k] = mean[k] / length


@kernel
def settle_tangents(
    group: Longs,
    tangent_group: Longs,
    moved: Bools,
    sums: Doubles,
    normals: Floats,
    tangents: Floats,
) -> None:
    """Replace tangents (V, 4) of groups that have moved by their mean, square to normals (V, 3);
    by none, w = 0, where there is no such direction.
    """
    for v in range(len(tangents)):
        if not moved[group[v]] or tangents[v, 3] == 0.0:
            continue
        mean, normal = row3(sums, tangent_group[v]), row3(normals, v)
        square = plus(mean, normal, -dot(mean, normal))
        length = math.sqrt(dot(square, square))
        if length > 1e-6 * math.sqrt(dot(mean, mean)):
            for k in range(3):
                tangents[v, k] = square[k] / length
        else:
            for k in range(4):
                tangents[v, k] = 0.0


@inlined
def _differs(before: Floats, after: Floats, v: int) -> bool:
    """Was the vertex moved?"""
    return bool(row3(before, v) != row3(after, v))


@inlined
def _add(sums: Doubles, row: int, vector: tuple[float, float, float], weight: float) -> None:
    """Add a vector's direction with a weight."""
    length = math.sqrt(dot(vector, vector))
    if length > 0.0:
        for k in range(3):
            sums[row, k] += vector[k] * (weight / length)
