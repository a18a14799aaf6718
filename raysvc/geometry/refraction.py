"""Snell's law: where a ray goes on behind a surface at which the index of refraction changes.

`eta` is the index on the side that the ray comes from over the index on the side that it goes to:
1 / ior into a solid, ior out of it.
"""

import math

from raysvc.geometry.vector_kernels import Vec3, dot
from raysvc.jit import inlined


@inlined
def transmitted_cosine(cosine: float, eta: float) -> float:
    """Cosine between the refracted ray and the normal of the far side, 0 at total reflection.

    `cosine` is that of the arriving ray on the near side, in 0..1.
    """
    return math.sqrt(max(1.0 - eta * eta * (1.0 - cosine * cosine), 0.0))


@inlined
def refracted(towards: Vec3, normal: Vec3, eta: float) -> tuple[Vec3, float]:
    """Unit direction of the refracted ray, and its cosine; (0, 0, 0) and 0 at total reflection.

    Parameters
    ----------
    towards
        unit, against the arriving ray
    normal
        unit, on the side from which the ray arrives
    """
    cosine = dot(towards, normal)
    far = transmitted_cosine(cosine, eta)
    if far == 0.0:
        return (0.0, 0.0, 0.0), 0.0
    along = eta * cosine - far
    direction = (
        along * normal[0] - eta * towards[0],
        along * normal[1] - eta * towards[1],
        along * normal[2] - eta * towards[2],
    )
    return direction, far
