"""Where a picture may have edges, by what its pixels and their neighbours show."""

import numpy as np

from raysvc.raster.edge_kernels import mark_shadow_edges, mark_surface_edges, measure_contrast
from raysvc.types import Bools, Floats, Ints

MIDDLE_GREY = 0.2
"""Of white: what an average surface returns."""


def surface_edges(part: Ints, depth: Floats, normal: Floats) -> Bools:
    """(H, W) bool: pixels next to which the part, the normal or the depth changes suddenly.

    Parameters
    ----------
    part
        (H, W) int32 number of the object and material that a pixel shows, -1 for none, UNKNOWN for
        a pixel that is to be left out
    depth
        (H, W) float32 along the view axis, or of a mirror image along the ray; inf for none
    normal
        (H, W, 3) float32 unit shading normals
    """
    mask = np.zeros(part.shape, np.bool_)
    mark_surface_edges(part, depth, normal, mask)
    return mask


def shadow_edges(part: Ints, light: Floats) -> Bools:
    """(H, W) bool: pixels next to which much less or more light falls on the same part.

    `part` (H, W) is as in `surface_edges`, `light` (H, W) float32 what comes straight from lights.
    """
    mask = np.zeros(part.shape, np.bool_)
    mark_shadow_edges(part, light, mask)
    return mask


def visible_contrast(rgba: Floats) -> Floats:
    """(H, W) float32 in 0..1: how much pixels differ from their four neighbours to the eye.

    `rgba` is (H, W, 4), linear, premultiplied. Of colours the exposed value x counts as
    sqrt(x / (1 + x)): about what a screen shows, whatever the tone mapping will be, and highlights
    count no more than white. Exposed so that half of what is lit is above middle grey: how the
    picture will be shown must not change it.
    """
    contrast = np.empty(rgba.shape[:2], np.float32)
    brightest = rgba[..., :3].max(axis=2)
    lit = brightest[brightest > 0.0]
    exposure = MIDDLE_GREY / float(np.median(lit)) if len(lit) else 1.0
    measure_contrast(rgba, exposure, contrast)
    return contrast
