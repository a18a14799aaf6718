"""Which pixels lie on an edge of what is seen, so that only those get more samples."""

import numpy as np

from raysvc.types import Bools, Doubles, Floats, Ints

SAME_NORMAL = 0.9
"""Neighbours whose normals' cosine is less are on different faces."""
DEPTH_BEND = 0.01
"""Second difference of depth and its reciprocal, as parts of these, above which there is a step."""


def edge_mask(part: Ints, depth: Floats, normal: Floats) -> Bools:
    """(H, W) bool: pixels next to which the part, the normal or the depth changes suddenly.

    Parameters
    ----------
    part
        (H, W) int32 number of the object and material that a pixel shows, -1 for none
    depth
        (H, W) float32 along the view axis, inf for none
    normal
        (H, W, 3) float32 unit shading normals
    """
    mask = np.zeros(part.shape, np.bool_)
    for axis in (0, 1):
        near = (slice(None, -1), slice(None)) if axis == 0 else (slice(None), slice(None, -1))
        far = (slice(1, None), slice(None)) if axis == 0 else (slice(None), slice(1, None))
        cosine = np.einsum("hwk,hwk->hw", normal[near], normal[far])
        differs = (part[near] != part[far]) | ((cosine < SAME_NORMAL) & (part[near] >= 0))
        mask[near] |= differs
        mask[far] |= differs
        mask |= _depth_steps(depth, axis)
    return mask


def _depth_steps(depth: Floats, axis: int) -> Bools:
    """Pixels whose depth is not near the mean of their two neighbours' along an axis.

    On a plane the depth is linear in the picture (orthographic) or its reciprocal is (perspective);
    at a step neither is.
    """
    seen = np.isfinite(depth) & (depth > 0)
    z = np.moveaxis(np.where(seen, depth, 1.0).astype(np.float64), axis, 0)
    known = np.moveaxis(seen, axis, 0)
    found = np.zeros(z.shape, np.bool_)
    found[1:-1] = _bends(z) & _bends(1.0 / z) & known[:-2] & known[1:-1] & known[2:]
    return np.moveaxis(found, 0, axis)


def _bends(z: Doubles) -> Bools:
    """Whether rows of (H, W), save the first and last, are not near their neighbours' mean."""
    bends: Bools = np.abs(z[:-2] + z[2:] - 2.0 * z[1:-1]) > DEPTH_BEND * z[1:-1]
    return bends
