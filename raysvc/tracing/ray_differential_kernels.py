"""Loops that carry differentials over arrays of rays.

The formulas are in `geometry.differential_kernels`, the arrays in `RayDifferentials`.
"""

import math

import numpy as np

from raysvc.geometry.basis_kernels import basis
from raysvc.geometry.differential_kernels import (
    LARGEST,
    NO_STEP,
    away_from_zero,
    barycentric_gradients,
    bounded,
    interpolated_normal_step,
    reflected_step,
    refracted_step,
    transferred,
    unit_step,
)
from raysvc.geometry.vector_kernels import Vec3, cross, dot, plus, row3, scaled, unit_or
from raysvc.jit import inlined, kernel
from raysvc.shading.attribute_kernels import Geometry
from raysvc.shading.footprint import Footprint
from raysvc.shading.surface import Surface
from raysvc.tracing.ray_differentials import RayDifferentials
from raysvc.types import Doubles, Floats, Ints

MIRRORED = 0.0
"""Instead of a ratio of indices of refraction: the ray is reflected."""
LEAST_BEND = 1e-4
"""A ray that is bent by less tells too little of what bent it."""


@inlined
def write(array: Floats, n: int, step: Vec3) -> None:
    """Write a row of an (N, 3) array, without infinity or NaN."""
    array[n, 0], array[n, 1], array[n, 2] = bounded(step)


@kernel
def primary(
    directions: Floats,
    forward: Doubles,
    right: Doubles,
    down: Doubles,
    is_perspective: bool,
    differentials: RayDifferentials,
) -> None:
    """Fill differentials of a camera's rays in `directions` (R, 3), unit.

    forward (3,) unit; right, down (3,): a pixel's steps in metres, at distance 1 along the view if
    the camera is a perspective one.
    """
    view = (forward[0], forward[1], forward[2])
    to_right, downwards = (right[0], right[1], right[2]), (down[0], down[1], down[2])
    for n in range(len(directions)):
        differentials.blur[n] = 0.0
        differentials.widening[n] = 0.0
        if is_perspective:
            direction = row3(directions, n)
            length = 1.0 / away_from_zero(dot(direction, view))
            write(differentials.origin_dx, n, NO_STEP)
            write(differentials.origin_dy, n, NO_STEP)
            write(differentials.direction_dx, n, unit_step(direction, length, to_right))
            write(differentials.direction_dy, n, unit_step(direction, length, downwards))
        else:
            write(differentials.origin_dx, n, to_right)
            write(differentials.origin_dy, n, downwards)
            write(differentials.direction_dx, n, NO_STEP)
            write(differentials.direction_dy, n, NO_STEP)


@kernel
def footprints(
    geometry: Geometry,
    triangle: Ints,
    t: Floats,
    directions: Floats,
    differentials: RayDifferentials,
    footprint: Footprint,
) -> None:
    """Fill footprints of N rays that meet triangles at distances t (N,)."""
    for n in range(len(triangle)):
        f = triangle[n]
        a = row3(geometry.positions, geometry.triangles[f, 0])
        e1 = plus(row3(geometry.positions, geometry.triangles[f, 1]), a, -1.0)
        e2 = plus(row3(geometry.positions, geometry.triangles[f, 2]), a, -1.0)
        direction, distance = row3(directions, n), np.float64(t[n])
        plane = cross(e1, e2)
        if not dot(plane, plane) > 0.0:
            plane = direction
        step = transferred(
            direction,
            row3(differentials.origin_dx, n),
            row3(differentials.direction_dx, n),
            distance,
            plane,
        )
        write(footprint.dpdx, n, step)
        step = transferred(
            direction,
            row3(differentials.origin_dy, n),
            row3(differentials.direction_dy, n),
            distance,
            plane,
        )
        write(footprint.dpdy, n, step)
        blur = differentials.blur[n] + differentials.widening[n] * distance
        footprint.blur[n] = min(blur, LARGEST)


@kernel
def pixel_angles(differentials: RayDifferentials, t: Floats, angle: Floats) -> None:
    """Fill angle (R,): of a pixel's step at distance t (R,), or inf, seen from where rays start."""
    for n in range(len(t)):
        part = 1.0 / np.float64(t[n]) if t[n] > 0.0 else LARGEST
        right = plus(row3(differentials.direction_dx, n), row3(differentials.origin_dx, n), part)
        down = plus(row3(differentials.direction_dy, n), row3(differentials.origin_dy, n), part)
        angle[n] = math.sqrt(math.sqrt(dot(right, right) * dot(down, down)))


@inlined
def _normal_step(
    geometry: Geometry, triangle: int, position: Vec3, normal: Vec3, seen_from: Vec3, step: Vec3
) -> Vec3:
    """What the shading normal changes by when the point moves by `step` on its triangle's plane.

    From the vertices' normals, turned to the side of `seen_from`, and kept perpendicular to
    `normal`, which a normal map may have bent.
    """
    i0, i1, i2 = (
        geometry.triangles[triangle, 0],
        geometry.triangles[triangle, 1],
        geometry.triangles[triangle, 2],
    )
    a = row3(geometry.positions, i0)
    to_u, to_v = barycentric_gradients(
        a, row3(geometry.positions, i1), row3(geometry.positions, i2)
    )
    away = plus(position, a, -1.0)
    # The position is rounded, perhaps to outside of a small triangle
    u = min(max(dot(to_u, away), 0.0), 1.0)
    v = min(max(dot(to_v, away), 0.0), 1.0 - u)
    n0, n1, n2 = (
        row3(geometry.normals, i0),
        row3(geometry.normals, i1),
        row3(geometry.normals, i2),
    )
    turned = interpolated_normal_step(n0, n1, n2, u, v, dot(to_u, step), dot(to_v, step))
    along_u, along_v = plus(n1, n0, -1.0), plus(n2, n0, -1.0)
    interpolated = plus(plus(n0, along_u, u), along_v, v)
    side = 1.0 if dot(interpolated, seen_from) >= 0.0 else -1.0
    return scaled(plus(turned, normal, -dot(turned, normal)), side)


@inlined
def _facet(direction: Vec3, leaving: Vec3, normal: Vec3, eta: float) -> Vec3:
    """Unit normal, on the side of `normal`, about which a ray is reflected or refracted.

    It is `normal` for mirrors, and another for rays into the lobe of a rough surface (Walter et al.
    2007, "Microfacet Models for Refraction through Rough Surfaces", section 4.2: the half vector).
    """
    across = plus(leaving, direction, -1.0)
    if eta != MIRRORED:
        across = plus(scaled(direction, eta), leaving, -1.0)
    if dot(across, across) < LEAST_BEND * LEAST_BEND:
        return normal
    facet = unit_or(across, normal)
    return facet if dot(facet, normal) >= 0.0 else scaled(facet, -1.0)


@inlined
def _direction_step(
    direction: Vec3, direction_step: Vec3, facet: Vec3, normal: Vec3, normal_step: Vec3, eta: float
) -> Vec3:
    """What the reflected or refracted direction changes by; the facet turns with the normal."""
    facet_step = plus(scaled(normal_step, dot(normal, facet)), normal, -dot(normal_step, facet))
    if eta == MIRRORED:
        return reflected_step(direction, direction_step, facet, facet_step)
    return refracted_step(direction, direction_step, facet, facet_step, eta)


@kernel
def continued(
    geometry: Geometry,
    triangle: Ints,
    surface: Surface,
    directions: Floats,
    arriving: RayDifferentials,
    footprint: Footprint,
    widening: Floats,
    eta: Floats,
    leaving: RayDifferentials,
) -> None:
    """Fill differentials of rays that go on in directions (N, 3) from N points of a surface.

    The points are on triangles (N,). `arriving` and `footprint` are those of the rays that arrived;
    widening (N,) is what the surface adds to the cone; eta (N,) is the ratio of indices of
    refraction, or MIRRORED.
    """
    for n in range(len(triangle)):
        f = triangle[n]
        direction = scaled(row3(surface.to_viewer, n), -1.0)
        position, normal = row3(surface.position, n), row3(surface.normal, n)
        plane_normal = row3(surface.geometric_normal, n)
        ratio = np.float64(eta[n])
        facet = _facet(direction, row3(directions, n), normal, ratio)
        for axis in range(2):
            step, turn = row3(footprint.dpdx, n), row3(arriving.direction_dx, n)
            if axis == 1:
                step, turn = row3(footprint.dpdy, n), row3(arriving.direction_dy, n)
            tilt = _normal_step(geometry, f, position, normal, plane_normal, step)
            turned = _direction_step(direction, turn, facet, normal, tilt, ratio)
            write(leaving.origin_dx if axis == 0 else leaving.origin_dy, n, step)
            write(leaving.direction_dx if axis == 0 else leaving.direction_dy, n, turned)

        # The cone, as the differentials of its radius along two axes across the ray
        blur, wide = np.float64(footprint.blur[n]), np.float64(arriving.widening[n])
        square = 0.0
        if blur > 0.0 or wide > 0.0:
            cosine = away_from_zero(dot(direction, plane_normal))
            across = basis(direction)
            for axis in range(2):
                side = across[axis]
                step = plus(side, direction, -dot(side, plane_normal) / cosine)
                step = bounded(scaled(step, blur))
                tilt = _normal_step(geometry, f, position, normal, plane_normal, step)
                turn = scaled(side, wide)
                turned = _direction_step(direction, turn, facet, normal, tilt, ratio)
                turned = bounded(turned)
                square += 0.5 * dot(turned, turned)
        leaving.blur[n] = blur
        added = np.float64(widening[n])
        leaving.widening[n] = min(math.sqrt(square + added * added), LARGEST)
