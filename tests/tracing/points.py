"""Surfaces that are points with normals, and nothing else."""

import numpy as np

from raysvc.shading.coat import Coat
from raysvc.shading.glass import Glass
from raysvc.shading.surface import Surface
from raysvc.shading.surface_kernels import CLEARANCE


def points(position, normal, *, geometric_normal=None, view=None):
    """Grey points; `geometric_normal` and `view` are the normal unless given."""
    position = np.atleast_2d(np.array(position, np.float32))
    count = len(position)

    def vectors(values):
        return np.array(np.broadcast_to(np.asarray(values, np.float32), (count, 3)))

    def numbers(value):
        return np.full(count, value, np.float32)

    return Surface(
        position=position,
        geometric_normal=vectors(normal if geometric_normal is None else geometric_normal),
        normal=vectors(normal),
        to_viewer=vectors(normal if view is None else view),
        base_colour=vectors((0.5, 0.5, 0.5)),
        alpha=numbers(1),
        metallic=numbers(0),
        roughness=numbers(0.5),
        dielectric_f0=numbers(0.04),
        transmission=numbers(0),
        emissive=vectors((0, 0, 0)),
        occlusion=numbers(1),
        unlit=np.zeros(count, np.bool_),
        clearance=CLEARANCE * np.maximum(np.abs(position).max(axis=1), np.float32(1)),
        coat=Coat.empty(0),
        glass=Glass.empty(0),
    )
