"""White surfaces, and what a picture full of them looks like, to measure light by."""

import math

import numpy as np

from raysvc.shading.brushed import Brushed
from raysvc.shading.coat import Coat
from raysvc.shading.glass import Glass
from raysvc.shading.surface import Surface
from raysvc.types import Bools, Doubles, Floats

DIELECTRIC_F0 = 0.04


def white_surface(
    normal: Doubles, view: Doubles, metallic: float, roughness: float | Floats
) -> Surface:
    """White surfaces with normals and views (N, 3), unit, at the origin; roughness one or (N,)."""
    count = len(normal)

    def filled(value: float | Floats, *shape: int) -> Floats:
        return np.ascontiguousarray(np.broadcast_to(np.float32(value), (count, *shape)))

    normal32 = np.ascontiguousarray(normal, np.float32)
    return Surface(
        position=filled(0, 3),
        geometric_normal=normal32,
        normal=normal32,
        to_viewer=np.ascontiguousarray(view, np.float32),
        base_colour=filled(1, 3),
        alpha=filled(1),
        metallic=filled(metallic),
        roughness=filled(roughness),
        dielectric_f0=filled(DIELECTRIC_F0),
        transmission=filled(0),
        emissive=filled(0, 3),
        occlusion=filled(1),
        unlit=np.zeros(count, bool),
        clearance=filled(0),
        coat=Coat.empty(0),
        glass=Glass.empty(0),
    )


def brushed_surface(normal: Doubles, view: Doubles, roughness: float, anisotropy: float) -> Surface:
    """White dielectrics with normals and views (N, 3), unit, whose highlights are long sideways.

    No normal may point straight up or down.
    """
    tangent = np.cross([0.0, 1.0, 0.0], normal)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    strength = np.full(len(normal), anisotropy, np.float32)
    brushed = Brushed(strength, np.ascontiguousarray(tangent, np.float32))
    return white_surface(normal, view, 0.0, roughness)._replace(brushed=brushed)


def sphere(size: int) -> tuple[Doubles, Doubles, Bools]:
    """Normals, views (N, 3) of a sphere seen from afar, a little above, and its mask (H, W)."""
    y, x = 1.05 - (np.mgrid[0:size, 0:size] + 0.5) / size * 2.1
    x = -x
    inside = x * x + y * y < 1
    local = np.stack([x, y, np.sqrt(np.maximum(1 - x * x - y * y, 0))], axis=-1)[inside]
    towards = np.array([[0.0, 0.2, 1.0]]) / math.hypot(0.2, 1.0)
    right = np.array([[1.0, 0.0, 0.0]])
    normal = local @ np.concatenate([right, np.cross(towards, right), towards])
    return normal, np.tile(towards, (len(normal), 1)), inside
