"""Where a ray starts so that it does not meet the surface that it leaves.

Wächter and Binder 2019, "A Fast and Robust Method for Avoiding Self-Intersection", Ray Tracing
Gems, ch. 6: the point moves along the geometric normal by a number of floating-point steps, so the
distance fits the coordinates' own precision, and by a small fixed distance near the origin.
"""

import numpy as np

from raysvc.jit import inlined, kernel
from raysvc.types import Floats

STEPS = 256
NEAR_ORIGIN = 1.0 / 32.0
FIXED_M = 1.0 / 65536.0
EPSILON = 1.1920929e-07
"""Spacing of float32 at 1."""


@inlined
def offset_origin(
    position: Floats, geometric_normal: Floats, n: int, side: np.float32, origins: Floats, at: int
) -> None:
    """Write origins[at]: position n moved along its normal (side 1) or against it (side -1)."""
    steps = np.float32(STEPS * EPSILON)
    for k in range(3):
        p, towards = position[n, k], side * geometric_normal[n, k]
        if abs(p) < NEAR_ORIGIN:
            origins[at, k] = p + np.float32(FIXED_M) * towards
        else:
            origins[at, k] = p + abs(p) * steps * towards


@kernel
def offset_origins(
    position: Floats, geometric_normal: Floats, directions: Floats, origins: Floats
) -> None:
    """Fill origins (N, 3): positions moved to that side of the surface to which directions go."""
    for n in range(len(position)):
        out = (
            directions[n, 0] * geometric_normal[n, 0]
            + directions[n, 1] * geometric_normal[n, 1]
            + directions[n, 2] * geometric_normal[n, 2]
        )
        side = np.float32(1.0) if out >= 0.0 else np.float32(-1.0)
        offset_origin(position, geometric_normal, n, side, origins, n)
