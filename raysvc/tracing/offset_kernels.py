"""Where a ray starts so that it does not meet the surface that it leaves.

The point moves along the geometric normal by the surface's `clearance`. That is so many float32
steps of the triangle's largest coordinate: a structure computes with the triangle's coordinates, so
those set its error, wherever on the triangle the point lies (compare Wächter and Binder 2019, "A
Fast and Robust Method for Avoiding Self-Intersection", Ray Tracing Gems, ch. 6, which goes by the
coordinates of the point).
"""

import numpy as np

from raysvc.jit import inlined, kernel
from raysvc.types import Floats


@inlined
def offset_origin(
    position: Floats,
    geometric_normal: Floats,
    clearance: Floats,
    n: int,
    side: np.float32,
    origins: Floats,
    at: int,
) -> None:
    """Write origins[at]: position n moved along its normal (side 1) or against it (side -1)."""
    for k in range(3):
        origins[at, k] = position[n, k] + side * clearance[n] * geometric_normal[n, k]


@kernel
def offset_origins(
    position: Floats,
    geometric_normal: Floats,
    clearance: Floats,
    directions: Floats,
    origins: Floats,
) -> None:
    """Fill origins (N, 3): positions moved to that side of the surface to which directions go."""
    for n in range(len(position)):
        out = (
            directions[n, 0] * geometric_normal[n, 0]
            + directions[n, 1] * geometric_normal[n, 1]
            + directions[n, 2] * geometric_normal[n, 2]
        )
        side = np.float32(1.0) if out >= 0.0 else np.float32(-1.0)
        offset_origin(position, geometric_normal, clearance, n, side, origins, n)
