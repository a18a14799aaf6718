"""What is behind the scene."""

import numpy as np

from raysvc.frame.composite_kernels import over
from raysvc.frame.prepared import Prepared
from raysvc.frame.settings import Settings
from raysvc.scene import Camera
from raysvc.types import Floats, Longs


def composite(
    prepared: Prepared,
    camera: Camera,
    settings: Settings,
    pixel: Longs,
    row: Longs,
    radiance: Floats,
    alpha: Floats,
) -> Floats:
    """Premultiplied linear RGBA (P, 4) of pixels (P,): their points over one another and the
    background.

    Point n, of N sorted front to back, belongs to pixel[row[n]]; radiance is (N, 3), alpha (N,).
    """
    rgba = np.zeros((len(pixel), 4), np.float32)
    over(row, radiance, alpha, rgba)
    if settings.background == "transparent":
        return rgba
    open_ = np.flatnonzero(rgba[:, 3] < 1.0)
    rgba[open_, :3] += (1.0 - rgba[open_, 3:]) * behind_scene(
        prepared, camera, settings, pixel[open_]
    )[:, :3]
    rgba[open_, 3] = 1.0
    return rgba


def behind_scene(prepared: Prepared, camera: Camera, settings: Settings, pixel: Longs) -> Floats:
    """Premultiplied linear RGBA (P, 4) of what pixels (P,) would show without a scene."""
    rgba = np.zeros((len(pixel), 4), np.float32)
    if settings.background == "transparent":
        return rgba
    rgba[:, 3] = 1.0
    if settings.background == "environment":
        _, directions = camera.rays(pixel)
        rgba[:, :3] = prepared.light.radiance(directions)
    else:
        rgba[:, :3] = np.array(settings.background, np.float32)
    return rgba
