"""From metres on a triangle to what a pixel covers of its barycentric coordinates."""

from raysvc.geometry.differential_kernels import away_from_zero, barycentric_gradients
from raysvc.geometry.vector_kernels import Vec3, cross, dot, plus, unit_or
from raysvc.jit import inlined
from raysvc.shading.ellipse_kernels import Spread

DISC = 3.0
"""A disc of radius r has the variance of a square whose width squared is 3 r^2."""


@inlined
def spread_of_weights(
    a: Vec3, b: Vec3, c: Vec3, direction: Vec3, dpdx: Vec3, dpdy: Vec3, blur: float
) -> Spread:
    """The matrix (see `ellipse_kernels`) of the weights of b and c; 0 without area.

    A map from weights to texture coordinates, which is linear on the triangle, turns it into that
    of a texture. `direction` is that of the ray which the disc of radius `blur` is across: on the
    plane it becomes an ellipse, longer by 1 / cosine.
    """
    to_u, to_v = barycentric_gradients(a, b, c)
    ux, uy = dot(to_u, dpdx), dot(to_u, dpdy)
    vx, vy = dot(to_v, dpdx), dot(to_v, dpdy)
    uu, uv, vv = ux * ux + uy * uy, ux * vx + uy * vy, vx * vx + vy * vy
    if blur > 0.0:
        # Projected along the ray: P P^T + D D^T / (D.N)^2 within the plane
        normal = unit_or(cross(plus(b, a, -1.0), plus(c, a, -1.0)), direction)
        cosine = away_from_zero(dot(direction, normal))
        u_along, v_along = dot(to_u, direction) / cosine, dot(to_v, direction) / cosine
        square = DISC * blur * blur
        uu += square * (dot(to_u, to_u) + u_along * u_along)
        uv += square * (dot(to_u, to_v) + u_along * v_along)
        vv += square * (dot(to_v, to_v) + v_along * v_along)
    return uu, uv, vv
