"""Poses of cameras. Right-handed, +Y up, the camera looks along its own -Z."""

import numpy as np

from raysvc.types import Doubles


def unit(vector: Doubles) -> Doubles:
    """Return vector(s) (..., 3) scaled to length 1; zero vectors stay zero."""
    # Squares of very short or long vectors leave the range of doubles.
    greatest = np.abs(vector).max(axis=-1, keepdims=True)
    vector = vector / np.where(greatest > 0, greatest, 1.0)
    length = np.linalg.norm(vector, axis=-1, keepdims=True)
    return vector / np.where(length > 0, length, 1.0)


def look_at(eye: Doubles, target: Doubles, up: Doubles) -> Doubles:
    """Return world_from_camera (4, 4) of a camera at `eye` with `target` in the middle of its view.

    When `up` is along the view, another axis takes its place. `eye` and `target` must differ.
    """
    back = unit(np.asarray(eye, np.float64) - target)
    right = np.cross(unit(np.asarray(up, np.float64)), back)
    if np.linalg.norm(right) < 1e-9:
        right = np.cross([0.0, 0.0, 1.0] if abs(back[2]) < 0.9 else [0.0, 1.0, 0.0], back)
    right = unit(right)
    pose = np.eye(4)
    pose[:3, 0], pose[:3, 1], pose[:3, 2], pose[:3, 3] = right, np.cross(back, right), back, eye
    return pose


def framed_distance(
    corners: Doubles, pose: Doubles, tan_half_fov: tuple[float, float], margin: float
) -> float:
    """Distance back along the view at which every corner is inside the field of view.

    Parameters
    ----------
    corners
        (N, 3) points that must be seen
    pose
        (4, 4) world_from_camera of a camera that stands where the distance is counted from
    tan_half_fov
        tangents of half the horizontal and vertical fields of view
    margin
        factor > 1 that leaves room around them
    """
    local = (corners - pose[:3, 3]) @ pose[:3, :3]
    needed = [local[:, 2] + margin * np.abs(local[:, axis]) / tan_half_fov[axis] for axis in (0, 1)]
    return float(max(n.max() for n in needed))
