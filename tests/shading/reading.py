"""Surfaces at points of the quad z = 0 and elsewhere, asked for by texture coordinates."""

import numpy as np

from raysvc.shading.footprint import Footprint
from raysvc.shading.scene_tables import SceneTables


def at_uv(scene, points, *, footprint=0.0, texture_filter="bilinear", direction=(0, 0, -1)):
    """Surface of a quad at positions given by (u, v) in 0..1: v downwards, as in its texture."""
    u, v = np.atleast_2d(np.array(points, float)).T
    # Corners 0 1 2 3 are lower left, lower right, upper right, upper left.
    x, y = u, 1 - v
    first = y <= x
    triangle = np.where(first, 0, 1).astype(np.int32)
    weights = np.where(
        first[:, None], np.stack([x - y, y], axis=1), np.stack([x, y - x], axis=1)
    ).astype(np.float32)
    towards = np.broadcast_to(np.array(direction, np.float32), (len(u), 3))
    towards = towards / np.linalg.norm(towards, axis=1, keepdims=True)
    if not isinstance(footprint, Footprint):
        footprint = square_pixels(towards, footprint)
    return SceneTables.of(scene).surface(
        triangle,
        weights,
        np.ascontiguousarray(towards, np.float32),
        footprint,
        texture_filter,
    )


def square_pixels(directions, width):
    """What pixels so many metres wide across rays cover of a plane z = constant."""
    count = len(directions)
    right = np.tile([1.0, 0.0, 0.0], (count, 1))
    right -= (right * directions).sum(axis=1, keepdims=True) * directions
    right /= np.linalg.norm(right, axis=1, keepdims=True)
    sides = [right, np.cross(directions, right)]
    on_plane = [
        np.float32(width) * (side - side[:, 2:] / directions[:, 2:] * directions) for side in sides
    ]
    return Footprint(
        *(np.ascontiguousarray(step, np.float32) for step in on_plane), np.zeros(count, np.float32)
    )


def parallelograms(dpdx, dpdy, count=1, blur=0.0):
    """The same steps (3,) for so many points."""
    return Footprint(
        np.tile(np.float32(dpdx), (count, 1)),
        np.tile(np.float32(dpdy), (count, 1)),
        np.full(count, blur, np.float32),
    )


def alpha_at_uv(scene, points):
    """Coverage at the same points, as rays ask for it."""
    u, v = np.atleast_2d(np.array(points, float)).T
    x, y = u, 1 - v
    first = y <= x
    weights = np.where(first[:, None], np.stack([x - y, y], 1), np.stack([x, y - x], 1))
    return SceneTables.of(scene).alpha(
        np.where(first, 0, 1).astype(np.int32), weights.astype(np.float32)
    )
