"""Where a ray meets a triangle: the one function that turns "which" into t, u and v.

Möller and Trumbore 1997, "Fast, Minimum Storage Ray/Triangle Intersection", in double precision.
"""

import numpy as np

from raysvc.jit import inlined, kernel
from raysvc.types import Floats, Ints

Vec3 = tuple[float, float, float]


@inlined
def intersect_plane(origin: Vec3, direction: Vec3, a: Vec3, b: Vec3, c: Vec3) -> Vec3:
    """Ray parameter t and weights u, v of vertices b, c where the ray meets the plane of abc.

    There is no test that the point is inside; t is inf if the ray is parallel to the plane.
    """
    e1 = (b[0] - a[0], b[1] - a[1], b[2] - a[2])
    e2 = (c[0] - a[0], c[1] - a[1], c[2] - a[2])
    p = (
        direction[1] * e2[2] - direction[2] * e2[1],
        direction[2] * e2[0] - direction[0] * e2[2],
        direction[0] * e2[1] - direction[1] * e2[0],
    )
    det = e1[0] * p[0] + e1[1] * p[1] + e1[2] * p[2]
    if det == 0.0:
        return (np.inf, 0.0, 0.0)
    s = (origin[0] - a[0], origin[1] - a[1], origin[2] - a[2])
    q = (
        s[1] * e1[2] - s[2] * e1[1],
        s[2] * e1[0] - s[0] * e1[2],
        s[0] * e1[1] - s[1] * e1[0],
    )
    inverse = 1.0 / det
    u = (s[0] * p[0] + s[1] * p[1] + s[2] * p[2]) * inverse
    v = (direction[0] * q[0] + direction[1] * q[1] + direction[2] * q[2]) * inverse
    t = (e2[0] * q[0] + e2[1] * q[1] + e2[2] * q[2]) * inverse
    return (t, u, v)


@inlined
def vec3(array: Floats, row: int) -> Vec3:
    """Row of an (N, 3) array as a tuple of doubles; Numba's float() would leave it single."""
    return (np.float64(array[row, 0]), np.float64(array[row, 1]), np.float64(array[row, 2]))


@kernel
def hits_on_triangles(
    origins: Floats,
    directions: Floats,
    positions: Floats,
    triangles: Ints,
    triangle: Ints,
    t: Floats,
    barycentric: Floats,
) -> None:
    """Fill t (R,) and barycentric (R, 2) of rays whose triangle is known; -1 gives inf and 0.

    Weights are clamped into the triangle: a structure or rasteriser may have rounded differently,
    and attributes must not be extrapolated.
    """
    for r in range(len(triangle)):
        f = triangle[r]
        t[r] = np.inf
        barycentric[r, 0] = 0.0
        barycentric[r, 1] = 0.0
        if f < 0:
            continue
        a = vec3(positions, triangles[f, 0])
        b = vec3(positions, triangles[f, 1])
        c = vec3(positions, triangles[f, 2])
        distance, u, v = intersect_plane(vec3(origins, r), vec3(directions, r), a, b, c)
        u = min(max(u, 0.0), 1.0)
        v = min(max(v, 0.0), 1.0 - u)
        if not np.isfinite(distance):
            # The ray lies in the plane: take the point of the triangle's middle.
            u = v = 1.0 / 3.0
            m = (
                (a[0] + b[0] + c[0]) / 3.0 - origins[r, 0],
                (a[1] + b[1] + c[1]) / 3.0 - origins[r, 1],
                (a[2] + b[2] + c[2]) / 3.0 - origins[r, 2],
            )
            d = vec3(directions, r)
            distance = (m[0] * d[0] + m[1] * d[1] + m[2] * d[2]) / (
                d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
            )
        t[r] = distance
        barycentric[r, 0] = u
        barycentric[r, 1] = v
