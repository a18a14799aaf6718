"""Reading an environment that has been softened once."""

import math
from typing import NamedTuple

from raysvc.jit import inlined
from raysvc.lighting.sphere_kernels import turns_of
from raysvc.types import Floats


class SoftMap(NamedTuple):
    """A lat-long map as an `Environment` is one, into whose space the world is turned by a yaw."""

    radiance: Floats
    """(rows, columns, 3) float32: means over about the same solid angle around each texel."""
    cos_yaw: float
    sin_yaw: float


@inlined
def soft_radiance(
    soft: SoftMap, world_x: float, y: float, world_z: float
) -> tuple[float, float, float]:
    """RGB in a unit direction of world space, bilinear."""
    x = soft.cos_yaw * world_x - soft.sin_yaw * world_z
    z = soft.sin_yaw * world_x + soft.cos_yaw * world_z
    picture = soft.radiance
    rows, columns = picture.shape[0], picture.shape[1]
    polar = turns_of(math.sqrt(x * x + z * z), y)
    row = min(max(2.0 * polar * rows - 0.5, 0.0), rows - 1.001)
    column = (turns_of(x, -z) + 0.5) * columns - 0.5
    top, left = int(row), math.floor(column)
    v, u = row - top, column - left
    here, right = int(left) % columns, (int(left) + 1) % columns
    a, b, c, d = (1.0 - v) * (1.0 - u), (1.0 - v) * u, v * (1.0 - u), v * u
    return (
        a * picture[top, here, 0]
        + b * picture[top, right, 0]
        + c * picture[top + 1, here, 0]
        + d * picture[top + 1, right, 0],
        a * picture[top, here, 1]
        + b * picture[top, right, 1]
        + c * picture[top + 1, here, 1]
        + d * picture[top + 1, right, 1],
        a * picture[top, here, 2]
        + b * picture[top, right, 2]
        + c * picture[top + 1, here, 2]
        + d * picture[top + 1, right, 2],
    )
