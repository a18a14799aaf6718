"""Every ray against every triangle."""

import numpy as np

from raysvc.geometry.watertight_kernels import distance_to, shear_of
from raysvc.jit import kernel
from raysvc.types import Floats, Ints


@kernel
def all_pairs(
    origins: Floats,
    directions: Floats,
    t_max: Floats,
    corners: Floats,
    triangle: Ints,
) -> None:
    """Fill triangle (R,) with the nearest triangle that each ray meets at 0 <= t <= t_max, else -1.

    corners (9 F,) holds the triangles' coordinates. The lowest index wins a tie.
    """
    for r in range(len(triangle)):
        x, y, z, sx, sy, sz = shear_of(
            np.float64(directions[r, 0]), np.float64(directions[r, 1]), np.float64(directions[r, 2])
        )
        ox, oy, oz = np.float64(origins[r, x]), np.float64(origins[r, y]), np.float64(origins[r, z])
        best: float = np.float64(t_max[r])
        triangle[r] = -1
        for f in range(len(corners) // 9):
            t = distance_to(corners, 9 * f, x, y, z, sx, sy, sz, ox, oy, oz)
            if t >= 0.0 and (t < best or (t == best and triangle[r] < 0)):
                best = t
                triangle[r] = f


@kernel
def any_of_all(
    origins: Floats, directions: Floats, t_max: Floats, corners: Floats, tests: Ints, triangle: Ints
) -> None:
    """Fill triangle (R,) with the lowest that meets the ray at 0 <= t <= t_max, and tests (R,)."""
    for r in range(len(triangle)):
        x, y, z, sx, sy, sz = shear_of(
            np.float64(directions[r, 0]), np.float64(directions[r, 1]), np.float64(directions[r, 2])
        )
        ox, oy, oz = np.float64(origins[r, x]), np.float64(origins[r, y]), np.float64(origins[r, z])
        reach = np.float64(t_max[r])
        triangle[r] = -1
        tests[r] = 0
        for f in range(len(corners) // 9):
            tests[r] += 1
            t = distance_to(corners, 9 * f, x, y, z, sx, sy, sz, ox, oy, oz)
            if 0.0 <= t <= reach:
                triangle[r] = f
                break
