"""Whether a ray meets a triangle, so that none slips between two triangles that share an edge.

Woop, Benthin and Wald 2013, "Watertight Ray/Triangle Intersection", section 3, in double precision:
vertices are sheared into a space in which the ray is the z axis, and the sign of a product of two
coordinates, rounded alike for both triangles of an edge, says on which side of the edge it passes.
Every structure decides by this function, so all of them see the same triangles at the same
distances.
"""

import numpy as np

from raysvc.jit import inlined
from raysvc.types import Floats

Shear = tuple[int, int, int, float, float, float]


@inlined
def shear_of(dx: float, dy: float, dz: float) -> Shear:
    """Axes x, y, z of the ray's space, z the longest component of the direction, and the shear.

    A direction of zero length gives a shear that meets nothing.
    """
    ax, ay, az = abs(dx), abs(dy), abs(dz)
    if ax >= ay and ax >= az:
        return (1, 2, 0, dy / dx, dz / dx, 1.0 / dx)
    if ay >= az:
        return (2, 0, 1, dz / dy, dx / dy, 1.0 / dy)
    return (0, 1, 2, dx / dz, dy / dz, 1.0 / dz)


@inlined
def distance_to(
    corners: Floats,
    at: int,
    axis_x: int,
    axis_y: int,
    axis_z: int,
    shear_x: float,
    shear_y: float,
    shear_z: float,
    origin_x: float,
    origin_y: float,
    origin_z: float,
) -> float:
    """t at which a ray meets the triangle whose nine coordinates begin at corners[at], or -1.

    The origin's coordinates are in the order of the ray's axes. A hit behind the origin is
    negative. Points on an edge belong to the triangle; a triangle without area, or seen edge-on, is
    never met.
    """
    az = np.float64(corners[at + axis_z]) - origin_z
    bz = np.float64(corners[at + 3 + axis_z]) - origin_z
    cz = np.float64(corners[at + 6 + axis_z]) - origin_z
    ax = np.float64(corners[at + axis_x]) - origin_x - shear_x * az
    ay = np.float64(corners[at + axis_y]) - origin_y - shear_y * az
    bx = np.float64(corners[at + 3 + axis_x]) - origin_x - shear_x * bz
    by = np.float64(corners[at + 3 + axis_y]) - origin_y - shear_y * bz
    cx = np.float64(corners[at + 6 + axis_x]) - origin_x - shear_x * cz
    cy = np.float64(corners[at + 6 + axis_y]) - origin_y - shear_y * cz
    u = cx * by - cy * bx
    v = ax * cy - ay * cx
    w = bx * ay - by * ax
    if (u < 0.0 or v < 0.0 or w < 0.0) and (u > 0.0 or v > 0.0 or w > 0.0):
        return -1.0
    volume = u + v + w
    if volume == 0.0:
        return -1.0
    return (u * az + v * bz + w * cz) * shear_z / volume
