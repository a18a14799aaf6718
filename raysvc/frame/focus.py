"""Focus on what a pixel shows."""

from dataclasses import replace

import numpy as np

from raysvc.errors import InvalidSetting
from raysvc.frame.points import front
from raysvc.frame.prepared import Prepared
from raysvc.frame.primary import traced
from raysvc.frame.view import View
from raysvc.scene import Camera


def focused(camera: Camera, view: View, prepared: Prepared) -> Camera:
    """Return the camera with its focus on what `view.focus_pixel` shows, if it was given.

    That is the first surface, along the ray through the middle of the pixel, that covers at least
    half of what is behind it. Raises InvalidSetting where the pixel shows nothing of the scene.
    """
    if view.focus_pixel is None:
        return camera
    x, y = (int(place) for place in view.focus_pixel)
    pixel = np.array([y * camera.width + x])
    _, directions, hits = traced(prepared, camera, pixel, np.zeros((1, 2)))
    alpha = prepared.tables.alpha(hits.triangle, hits.barycentric)
    first = front(np.zeros(len(alpha), np.int64), alpha, 1)[0]
    if first < 0:
        raise InvalidSetting("shows nothing that could be in focus", field="camera.focus_pixel")
    depth = hits.t[first] * (directions[first] @ camera.forward)
    return replace(camera, focus_distance=float(depth))
