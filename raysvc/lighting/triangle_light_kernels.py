"""Light of a triangle at a point, in closed form.

Lambert 1760, "Photometria": the irradiance by a polygon is the sum over its edges of the angle that
each fills, times the cosine between the surface's normal and that of the edge's plane through the
point. What is below the horizon is cut off first.
"""

import math

from raysvc.geometry.vector_kernels import Vec3, cross, dot, plus
from raysvc.jit import inlined


@inlined
def _edge(normal: Vec3, a: Vec3, b: Vec3) -> float:
    """Twice the part of the edge from a to b, both seen from the point."""
    across = cross(a, b)
    sine = math.sqrt(dot(across, across))
    if sine < 1e-300:
        return 0.0
    return math.atan2(sine, dot(a, b)) * dot(normal, across) / sine


@inlined
def _at_horizon(a: Vec3, b: Vec3, above_a: float, above_b: float) -> Vec3:
    """Where the edge from a to b crosses the horizon."""
    return plus(a, plus(b, a, -1.0), above_a / (above_a - above_b))


@inlined
def triangle_irradiance(normal: Vec3, a: Vec3, b: Vec3, c: Vec3) -> float:
    """Irradiance of a triangle of radiance 1, from corners relative to the point.

    Whichever way it turns; `normal` is unit.
    """
    above_a, above_b, above_c = dot(normal, a), dot(normal, b), dot(normal, c)
    count = (above_a > 0.0) + (above_b > 0.0) + (above_c > 0.0)
    if count == 0:
        return 0.0
    if count == 3:
        return 0.5 * abs(_edge(normal, a, b) + _edge(normal, b, c) + _edge(normal, c, a))
    # Turn the corners so that a is alone on its side of the horizon
    alone = count == 1
    if (above_b > 0.0) == alone:
        a, b, c = b, c, a
        above_a, above_b, above_c = above_b, above_c, above_a
    elif (above_c > 0.0) == alone:
        a, b, c = c, a, b
        above_a, above_b, above_c = above_c, above_a, above_b
    p, q = _at_horizon(a, b, above_a, above_b), _at_horizon(a, c, above_a, above_c)
    if count == 1:
        return 0.5 * abs(_edge(normal, a, p) + _edge(normal, p, q) + _edge(normal, q, a))
    total = _edge(normal, p, b) + _edge(normal, b, c) + _edge(normal, c, q)
    return 0.5 * abs(total + _edge(normal, q, p))
