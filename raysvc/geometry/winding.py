"""How often surfaces go around a point."""

import numpy as np

from raysvc.types import Doubles, Ints


def signed_solid_angles(corners: Doubles, point: Doubles) -> Doubles:
    """(F,) float64 steradians that triangles (F, 3, 3) cover seen from a point (3,).

    Positive where their back is seen (Van Oosterom and Strackee 1983, "The Solid Angle of a Plane
    Triangle"). Those that the point lies on cover nothing.
    """
    a, b, c = (corners[:, k] - point for k in range(3))
    la, lb, lc = (np.sqrt(np.einsum("fk,fk->f", side, side)) for side in (a, b, c))
    volume = np.einsum("fk,fk->f", a, np.cross(b, c))
    below = la * lb * lc
    for first, second, third in ((a, b, lc), (a, c, lb), (b, c, la)):
        below += np.einsum("fk,fk->f", first, second) * third
    # In its own plane a triangle has no inside from which it would be seen.
    flat = np.abs(volume) <= 1e-12 * np.maximum(la * lb * lc, 1e-300)
    angles: Doubles = np.where(flat, 0.0, 2.0 * np.arctan2(volume, below))
    return angles


def windings(corners: Doubles, group: Ints, groups: int, point: Doubles) -> Doubles:
    """(groups,) float64: how often each group of triangles (F, 3, 3) goes around a point (3,).

    1 inside of a closed surface that faces outwards, 0 outside, and in between where it has holes
    (Jacobson, Kavan and Sorkine-Hornung 2013, "Robust Inside-Outside Segmentation using Generalized
    Winding Numbers"); -1 in a room whose walls face inwards. `group` (F,) numbers them.
    """
    angles = signed_solid_angles(corners, point)
    return np.bincount(group, angles, groups) / (4.0 * np.pi)
