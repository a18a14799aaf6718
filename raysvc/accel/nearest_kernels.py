"""Which of two triangles that a ray may meet comes first, as the structures themselves decide."""

import numpy as np

from raysvc.geometry.watertight_kernels import distance_to, shear_of
from raysvc.jit import kernel
from raysvc.types import Doubles, Floats, Ints


@kernel
def keep_nearer(
    origins: Floats,
    directions: Floats,
    positions: Floats,
    indices: Ints,
    found: Ints,
    triangle: Ints,
    t: Doubles,
    limit: Floats,
) -> None:
    """Take found (R,) over into triangle (R,) where it is nearer, or as near and lower in number.

    Both are -1 where there is none. t (R,) is the distance of `triangle`; limit (R,) becomes the
    next float32 after it, so that a structure that is asked next still sees what is equally near.
    """
    corners = np.empty(9, np.float32)
    for r in range(len(found)):
        f = found[r]
        if f < 0:
            continue
        for vertex in range(3):
            for axis in range(3):
                corners[3 * vertex + axis] = positions[indices[f, vertex], axis]
        # The same expressions as in the structures' kernels, so that they round alike.
        x, y, z, sx, sy, sz = shear_of(
            np.float64(directions[r, 0]), np.float64(directions[r, 1]), np.float64(directions[r, 2])
        )
        ox, oy, oz = np.float64(origins[r, x]), np.float64(origins[r, y]), np.float64(origins[r, z])
        distance = distance_to(corners, 0, x, y, z, sx, sy, sz, ox, oy, oz)
        if distance < 0.0:
            # A structure that rounds otherwise has met what this test just misses.
            distance = float(limit[r])
        if triangle[r] < 0 or distance < t[r] or (distance == t[r] and f < triangle[r]):
            triangle[r] = f
            t[r] = distance
            limit[r] = min(limit[r], np.nextafter(np.float32(distance), np.float32(np.inf)))
