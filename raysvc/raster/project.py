"""Vertices in homogeneous pixel coordinates."""

import numpy as np

from raysvc.scene import Camera
from raysvc.types import Doubles, Floats

VERTICES = 1 << 13
"""Projected at once."""


def project(positions: Floats, camera: Camera) -> Doubles:
    """World positions (V, 3) to homogeneous pixels (V, 4) float64: x w, y w, w, depth.

    x / w grows to the right and y / w downwards from the picture's top left corner, such that pixel
    (row, col) is sampled at (col + 0.5, row + 0.5) whatever the camera's offset in the pixel. Depth
    is along the view axis in metres; w is that depth for a perspective camera and 1 for an
    orthographic one.
    """
    result = np.empty((len(positions), 4))
    scale = 1.0 / camera.metres_per_pixel_at_unit_depth
    dx, dy = camera.offset_px
    # A few at a time: what is made on the way then stays in the cache, and needs no new memory
    for begin in range(0, len(positions), VERTICES):
        part = slice(begin, begin + VERTICES)
        local = (positions[part] - camera.eye) @ camera.world_from_camera[:3, :3]
        depth = -local[:, 2]
        if camera.slant != (0.0, 0.0):
            local[:, :2] -= np.multiply.outer(depth, camera.slant)
        w = depth if camera.projection == "perspective" else np.ones_like(depth)
        result[part, 0] = local[:, 0] * scale + (0.5 * camera.width - dx) * w
        result[part, 1] = local[:, 1] * -scale + (0.5 * camera.height - dy) * w
        result[part, 2] = w
        result[part, 3] = depth
    return result
