"""A frame around a direction, inside kernels."""

import math

from raysvc.geometry.vector_kernels import Vec3
from raysvc.jit import inlined


@inlined
def basis(n: Vec3) -> tuple[Vec3, Vec3]:
    """Two unit vectors perpendicular to a unit vector and to each other.

    Duff et al. 2017, "Building an Orthonormal Basis, Revisited", JCGT 6(1).
    """
    sign = math.copysign(1.0, n[2])
    a = -1.0 / (sign + n[2])
    b = n[0] * n[1] * a
    return (1.0 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]), (
        b,
        sign + n[1] * n[1] * a,
        -n[1],
    )
