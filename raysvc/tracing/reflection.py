"""Rays that leave points of surfaces: mirrored, in any direction, or to a place."""

import numpy as np

from raysvc.accel.base import Rays
from raysvc.shading.surface import Surface
from raysvc.tracing.offset_kernels import offset_origins
from raysvc.types import Floats, Longs


def mirror_rays(surface: Surface) -> Rays:
    """Rays (N) reflected about the shading normal; any below the triangle is turned up."""
    cosine = np.einsum("nk,nk->n", surface.normal, surface.to_viewer)[:, None]
    directions = 2.0 * cosine * surface.normal - surface.to_viewer
    above = np.einsum("nk,nk->n", surface.geometric_normal, directions)[:, None]
    directions -= np.minimum(2.0 * above, 0.0) * surface.geometric_normal
    directions /= np.sqrt(np.einsum("nk,nk->n", directions, directions))[:, None]
    return rays_from(surface, directions, np.full(surface.size, np.inf, np.float32))


def rays_from(
    surface: Surface, directions: Floats, t_max: Floats, index: Longs | None = None
) -> Rays:
    """Rays (N) that leave the surface without meeting it, on the side into which they go.

    `index` (N,) says from which of the surface's points; from each of them by default.
    """
    chosen = slice(None) if index is None else index
    directions = np.ascontiguousarray(directions, np.float32)
    origins = np.empty_like(directions)
    offset_origins(
        surface.position[chosen],
        surface.geometric_normal[chosen],
        surface.clearance[chosen],
        directions,
        origins,
    )
    return Rays(origins, directions, np.ascontiguousarray(t_max, np.float32))


def rays_towards(surface: Surface, to_place: Floats, distance: Floats, index: Longs) -> Rays:
    """Rays (N) that leave the surface's points `index` (N,) and end at places.

    A place is `distance` (N,) from its point in the direction `to_place` (N, 3), or infinitely far.
    A ray starts a little off its point, and is aimed at the place from there.
    """
    rays = rays_from(surface, to_place, distance, index)
    near = np.flatnonzero(np.isfinite(distance))
    if not len(near):
        return rays
    ends = surface.position[index[near]] + to_place[near] * distance[near, None].astype(np.float64)
    away = ends - rays.origins[near]
    reach = np.sqrt(np.einsum("nk,nk->n", away, away))
    directions, t_max = rays.directions.copy(), rays.t_max.copy()
    directions[near] = away / np.maximum(reach, 1e-30)[:, None]
    t_max[near] = reach
    return Rays(rays.origins, directions, t_max)
