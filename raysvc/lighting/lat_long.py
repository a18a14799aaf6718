"""Geometry of lat-long maps: where texels look and how much of the sphere they cover.

Row 0 looks up (+Y); the centre column is what is seen looking along -Z, +X is to its right.
"""

import math

import numpy as np

from raysvc.errors import InvalidSetting
from raysvc.types import Doubles


def texel_directions(
    rows: Doubles | float, columns: Doubles | float, height: int, width: int
) -> Doubles:
    """Unit directions of points of a map.

    Parameters
    ----------
    rows, columns
        broadcastable, in texels, texel centres at +0.5
    height, width
        of the map

    Returns
    -------
    (..., 3) float64
    """
    polar = np.asarray(rows) * (math.pi / height)
    azimuth = (np.asarray(columns) / width - 0.5) * math.tau
    sine = np.sin(polar)
    x, y, z = np.broadcast_arrays(sine * np.sin(azimuth), np.cos(polar), -sine * np.cos(azimuth))
    return np.stack([x, y, z], axis=-1)


def texel_solid_angles(height: int, width: int) -> Doubles:
    """(height,) float64 exact solid angle in steradians of one texel in each row."""
    edges = np.cos(np.arange(height + 1) * (math.pi / height))
    angles: Doubles = (edges[:-1] - edges[1:]) * (math.tau / width)
    return angles


def check_turned(yaw_deg: float, strength: float) -> None:
    """Raise InvalidSetting for what cannot turn and scale a map."""
    if not math.isfinite(yaw_deg):
        raise InvalidSetting(f"must be a finite number, is {yaw_deg}", field="yaw_deg")
    if not 0.0 <= strength < math.inf:
        raise InvalidSetting(f"must be finite and not negative, is {strength}", field="strength")
