"""What pixels cover along the paths of their rays: carried from the camera over every bounce.

Igehy 1999, "Tracing Ray Differentials", for the pixel; a cone beside it for the lobes of rough
mirrors (Amanatides 1984, "Ray Tracing with Cones"), whose widening a curved mirror changes as it
does a pixel's.

    camera -> primary_differentials -> footprint_at -> reflected | refracted
                                            ^                  |
                                            +------------------+

`footprint_at` says what is seen where a ray arrives, and the other two how its continuation begins.
"""

import math
from typing import Final

import numpy as np

from raysvc.scene import Camera
from raysvc.shading.attribute_kernels import Geometry
from raysvc.shading.footprint import Footprint
from raysvc.shading.mirrored import Mirrored
from raysvc.shading.surface import Surface
from raysvc.tracing.ray_differential_kernels import (
    MIRRORED,
    continued,
    footprints,
    pixel_angles,
    primary,
)
from raysvc.tracing.ray_differentials import RayDifferentials
from raysvc.types import Doubles, Floats, Ints

ROUGH: Final = 0.7
"""Roughness from which what a pixel sees mirrored adds nothing to the lobe."""


def primary_differentials(
    camera: Camera, directions: Floats, pixels_per_step: float = 1.0
) -> RayDifferentials:
    """Differentials of a camera's rays.

    Parameters
    ----------
    camera
        as it is; where in its pixels the rays go does not matter
    directions
        (R, 3) unit, as `Camera.rays` returns them; those of a surface are `-surface.to_viewer`
    pixels_per_step
        what a ray stands for: 1 / sqrt(n) if it is one of n samples of its pixel
    """
    differentials = RayDifferentials.empty(len(directions))
    step = camera.metres_per_pixel_at_unit_depth * pixels_per_step
    right: Doubles = step * camera.world_from_camera[:3, 0]
    down: Doubles = -step * camera.world_from_camera[:3, 1]
    is_perspective = camera.projection == "perspective"
    primary(directions, camera.forward, right, down, is_perspective, differentials)
    return differentials


def footprint_at(
    geometry: Geometry,
    triangle: Ints,
    t: Floats,
    directions: Floats,
    differentials: RayDifferentials,
) -> Footprint:
    """What pixels cover where N rays meet triangles (N,) at distances t (N,).

    `directions` (N, 3) unit. The points move on the planes of their triangles, as far as those go;
    rays nearer to a plane than 1e-4 are treated as if they were not.
    """
    footprint = Footprint.empty(len(triangle))
    footprints(geometry, triangle, t, directions, differentials, footprint)
    return footprint


def pixel_angle(differentials: RayDifferentials, t: Floats) -> Floats:
    """(R,) angle in radians that a pixel's step covers at distances t (R,), seen from the origins.

    The mean of both axes, by their product; across the rays nearly. t may be inf: then it is what
    the direction changes by.
    """
    angle = np.empty(len(t), np.float32)
    pixel_angles(differentials, t, angle)
    return angle


def reflected(
    geometry: Geometry,
    triangle: Ints,
    surface: Surface,
    directions: Floats,
    arriving: RayDifferentials,
    footprint: Footprint,
    widening: Floats,
) -> RayDifferentials:
    """Differentials of rays that N points of a surface reflect.

    Parameters
    ----------
    geometry, triangle
        of the scene, and (N,) on which of its triangles the points are: they say how the shading
        normal turns. A normal map's own change is left out; its footprint has filtered it
    surface
        N points, with the directions from which they are seen
    directions
        (N, 3) unit, of the rays that leave: about the shading normal, or, into the lobe of a rough
        surface, about a half vector, which is taken to turn with it
    arriving
        differentials of the N rays that arrived at them
    footprint
        what `footprint_at` says of them there
    widening
        (N,) what the surface's roughness adds to the cone: the tangent of half its lobe's angle. It
        is added to what arrived as independent blurs are, by the squares
    """
    leaving = RayDifferentials.empty(len(triangle))
    mirrored = np.full(len(triangle), MIRRORED, np.float32)
    continued(
        geometry, triangle, surface, directions, arriving, footprint, widening, mirrored, leaving
    )
    return leaving


def mirrored(
    geometry: Geometry,
    triangle: Ints,
    surface: Surface,
    arriving: RayDifferentials,
    footprint: Footprint,
) -> Mirrored:
    """What a pixel's step sees mirrored at N points of a surface.

    As large as a square with the mean variance of the step's image, which grows with the distance
    of the point and the curvature of the surface; at most a quarter of the sphere. Parameters as of
    `reflected`.
    """
    cosine = np.einsum("nk,nk->n", surface.normal, surface.to_viewer)[:, None]
    directions = 2.0 * cosine * surface.normal - surface.to_viewer
    still = np.zeros(len(triangle), np.float32)
    leaving = reflected(geometry, triangle, surface, directions, arriving, footprint, still)
    right, down = (
        np.einsum("nk,nk->n", step, step) for step in (leaving.direction_dx, leaving.direction_dy)
    )
    pixel_sr = np.minimum(0.5 * (right + down), np.float32(math.pi)).astype(np.float32)
    return Mirrored(np.where(surface.roughness < ROUGH, pixel_sr, np.float32(0.0)))


def refracted(
    geometry: Geometry,
    triangle: Ints,
    surface: Surface,
    directions: Floats,
    arriving: RayDifferentials,
    footprint: Footprint,
    widening: Floats,
    eta: Floats,
) -> RayDifferentials:
    """Differentials of rays that are refracted, into directions (N, 3); see `reflected`.

    `eta` (N,) float32, above 0, is the index of refraction where the ray comes from over that where
    it goes: 1 for thin panes.
    """
    leaving = RayDifferentials.empty(len(triangle))
    continued(geometry, triangle, surface, directions, arriving, footprint, widening, eta, leaving)
    return leaving
