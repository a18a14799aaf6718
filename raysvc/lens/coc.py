"""The thin lens: how large a point out of focus appears."""

import numpy as np

from raysvc.scene import Camera
from raysvc.types import Doubles, Floats

LARGEST_COC_PX = 1e6
"""Limit of what is returned; far beyond any picture, and finite."""


def coc_px(camera: Camera, depth: Floats) -> Floats:
    """Signed diameter, in pixels, of the circle of confusion of points at given depths.

    A point at depth z sends rays through a lens of radius R that meet the plane of focus, at
    distance F, in a disc of radius R |z - F| / z. A pixel is s F metres wide there (s: width at
    depth 1), so the diameter is 2 R / s (1/F - 1/z) pixels: affine in 1/z, negative nearer than F.

    An orthographic camera has no eye for the lens to be at. Its rays cross the plane of depth 0
    within R of the pixel's own point and meet in focus: 2 R / s (z/F - 1), s the width anywhere.

    Parameters
    ----------
    camera
        gives R, F and s; R = 0 is a pinhole, for which every circle is 0
    depth
        any shape, float32, metres along the view axis, positive; inf for the background

    Returns
    -------
    the same shape, float32, within +-LARGEST_COC_PX
    """
    lens_px = 2.0 * camera.aperture_radius / camera.metres_per_pixel_at_unit_depth
    if lens_px == 0.0:
        return np.zeros(depth.shape, np.float32)
    z = depth.astype(np.float64)
    with np.errstate(divide="ignore"):
        if camera.projection == "orthographic":
            blur = z / camera.focus_distance - 1.0
        else:
            blur = 1.0 / camera.focus_distance - 1.0 / z
    return np.clip(lens_px * blur, -LARGEST_COC_PX, LARGEST_COC_PX).astype(np.float32)


def background_coc_px(camera: Camera) -> float:
    """Signed diameter, in pixels, of what is infinitely far away."""
    return float(coc_px(camera, np.full(1, np.inf, np.float32))[0])


def depth_at(camera: Camera, coc_px: Floats) -> Doubles:
    """Depth (N,) of points with given diameters (N,): the inverse of `coc_px`, given a lens.

    inf where not even the background is blurred as much.
    """
    lens_px = 2.0 * camera.aperture_radius / camera.metres_per_pixel_at_unit_depth
    blur = coc_px.astype(np.float64) / lens_px
    if camera.projection == "orthographic":
        return camera.focus_distance * np.maximum(blur + 1.0, 0.0)
    nearness = 1.0 / camera.focus_distance - blur
    with np.errstate(divide="ignore"):
        depth: Doubles = 1.0 / np.maximum(nearness, 0.0)
    return depth
