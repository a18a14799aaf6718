"""What a triangle's vertices say at a point of it."""

from typing import NamedTuple

import numpy as np

from raysvc.geometry.vector_kernels import Vec3, cross, dot, plus, row3, scaled, unit_or
from raysvc.jit import inlined, kernel
from raysvc.types import Floats, Ints


class Geometry(NamedTuple):
    """The arrays of a `Scene` that kernels read."""

    positions: Floats
    normals: Floats
    tangents: Floats
    uv: Floats
    colours: Floats
    triangles: Ints
    material_of_triangle: Ints


@inlined
def mixed3(array: Floats, i0: int, i1: int, i2: int, u: float, v: float) -> Vec3:
    """Rows of an (N, >= 3) array mixed with barycentric weights."""
    w = 1.0 - u - v
    return (
        w * array[i0, 0] + u * array[i1, 0] + v * array[i2, 0],
        w * array[i0, 1] + u * array[i1, 1] + v * array[i2, 1],
        w * array[i0, 2] + u * array[i1, 2] + v * array[i2, 2],
    )


@kernel
def positions_at(geometry: Geometry, triangle: Ints, barycentric: Floats, position: Floats) -> None:
    """Fill position (N, 3) of points at triangle (N,), all >= 0, and barycentric (N, 2)."""
    for n in range(len(triangle)):
        f = triangle[n]
        u, v = np.float64(barycentric[n, 0]), np.float64(barycentric[n, 1])
        corners = geometry.triangles
        here = mixed3(geometry.positions, corners[f, 0], corners[f, 1], corners[f, 2], u, v)
        position[n, 0], position[n, 1], position[n, 2] = here


@inlined
def normals(
    geometry: Geometry, triangle: int, u: float, v: float, towards: Vec3
) -> tuple[Vec3, Vec3]:
    """Normal of a triangle and interpolated normal at a point, both of its front.

    Where a triangle has no normal it is `towards`.
    """
    i0, i1, i2 = (
        geometry.triangles[triangle, 0],
        geometry.triangles[triangle, 1],
        geometry.triangles[triangle, 2],
    )
    a = row3(geometry.positions, i0)
    across = cross(
        plus(row3(geometry.positions, i1), a, -1.0), plus(row3(geometry.positions, i2), a, -1.0)
    )
    geometric = unit_or(across, towards)
    shading = unit_or(mixed3(geometry.normals, i0, i1, i2, u, v), geometric)
    if dot(shading, geometric) < 0.0:
        shading = scaled(shading, -1.0)
    return geometric, shading


@inlined
def mixed_uv(
    uv: Floats, i0: int, i1: int, i2: int, uv_set: int, weights: Vec3
) -> tuple[float, float]:
    """Texture coordinates of one set, mixed (or, with weights that sum to 0, differenced)."""
    return (
        weights[0] * uv[i0, uv_set, 0]
        + weights[1] * uv[i1, uv_set, 0]
        + weights[2] * uv[i2, uv_set, 0],
        weights[0] * uv[i0, uv_set, 1]
        + weights[1] * uv[i1, uv_set, 1]
        + weights[2] * uv[i2, uv_set, 1],
    )
