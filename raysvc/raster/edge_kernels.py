"""Loops over a picture's pixels and their neighbours, in search of edges."""

import math

import numpy as np

from raysvc.jit import inlined, kernel
from raysvc.types import Bools, Floats, Ints

UNKNOWN = -2
"""The part of a pixel of which nothing is known, and which makes no edges."""
SAME_NORMAL = 0.9
"""Neighbours whose normals' cosine is less are on different faces."""
DEPTH_BEND = 0.01
"""Second difference of depth and its reciprocal, as parts of these, above which there is a step."""
SHADED = 0.5
"""Neighbours of which one gets less than this part of the other's light are across a shadow."""


@inlined
def bends(before: float, here: float, after: float) -> bool:
    """Whether neither three depths in a row nor their reciprocals are those of a plane.

    On a plane the depth is linear in the picture (orthographic) or its reciprocal is (perspective);
    at a step neither is. What is not in front of the camera, or nowhere, has no depth.
    """
    if not (0.0 < before < math.inf and 0.0 < here < math.inf and 0.0 < after < math.inf):
        return False
    if abs(before + after - 2.0 * here) <= DEPTH_BEND * here:
        return False
    return abs(1.0 / before + 1.0 / after - 2.0 / here) > DEPTH_BEND / here


@inlined
def parted(part: Ints, normal: Floats, y: int, x: int, v: int, u: int) -> bool:
    """Whether pixels (y, x) and (v, u) show different parts, or different faces of one."""
    if part[y, x] == UNKNOWN or part[v, u] == UNKNOWN:
        return False
    if part[y, x] != part[v, u]:
        return True
    cosine = (
        normal[y, x, 0] * normal[v, u, 0]
        + normal[y, x, 1] * normal[v, u, 1]
        + normal[y, x, 2] * normal[v, u, 2]
    )
    return bool(part[y, x] >= 0 and cosine < SAME_NORMAL)


@kernel
def mark_surface_edges(part: Ints, depth: Floats, normal: Floats, mask: Bools) -> None:
    """Set mask (H, W) on both sides of edges; see `raysvc.raster.edges.surface_edges`."""
    height, width = part.shape
    for y in range(height):
        for x in range(width):
            here = np.float64(depth[y, x])
            if x + 1 < width and parted(part, normal, y, x, y, x + 1):
                mask[y, x] = mask[y, x + 1] = True
            if y + 1 < height and parted(part, normal, y, x, y + 1, x):
                mask[y, x] = mask[y + 1, x] = True
            if 0 < x < width - 1:
                left, right = np.float64(depth[y, x - 1]), np.float64(depth[y, x + 1])
                mask[y, x] |= bends(left, here, right)
            if 0 < y < height - 1:
                above, below = np.float64(depth[y - 1, x]), np.float64(depth[y + 1, x])
                mask[y, x] |= bends(above, here, below)


@kernel
def mark_shadow_edges(part: Ints, light: Floats, mask: Bools) -> None:
    """Set mask (H, W) on both sides of edges; see `raysvc.raster.edges.shadow_edges`."""
    height, width = part.shape
    for y in range(height):
        for x in range(width):
            for step in range(2):
                v, u = y + step, x + 1 - step
                if v < height and u < width and part[y, x] >= 0 and part[y, x] == part[v, u]:
                    here, there = light[y, x], light[v, u]
                    if min(here, there) < SHADED * max(here, there):
                        mask[y, x] = mask[v, u] = True


@inlined
def on_screen(radiance: float, exposure: float) -> float:
    """Roughly how bright a screen shows radiance, in 0..1."""
    exposed = radiance * exposure
    return math.sqrt(exposed / (1.0 + exposed))


@kernel
def measure_contrast(rgba: Floats, exposure: float, contrast: Floats) -> None:
    """Fill contrast (H, W): the greatest difference from the four neighbours in any channel.

    Colours of rgba (H, W, 4) count as a screen shows them.
    """
    height, width = contrast.shape
    contrast[:] = 0.0
    for y in range(height):
        for x in range(width):
            for step in range(2):
                v, u = y + step, x + 1 - step
                if v < height and u < width:
                    greatest = abs(rgba[y, x, 3] - rgba[v, u, 3])
                    for k in range(3):
                        here, there = np.float64(rgba[y, x, k]), np.float64(rgba[v, u, k])
                        if here != there:
                            apart = on_screen(here, exposure) - on_screen(there, exposure)
                            greatest = max(greatest, abs(apart))
                    contrast[y, x] = max(contrast[y, x], greatest)
                    contrast[v, u] = max(contrast[v, u], greatest)
