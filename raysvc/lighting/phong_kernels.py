"""Light from an environment under powers of the cosine, and from cones."""

import math

from raysvc.jit import inlined, kernel
from raysvc.lighting.lobe_level_kernels import round_lobe
from raysvc.lighting.sphere_kernels import map_radiance, turned
from raysvc.types import Doubles, Floats, Ints

NARROWEST = 1024.0
"""Exponent of the first level."""
LEVELS_PER_OCTAVE = 2.0
"""Levels for each doubling of the solid angle."""
BOX = 12.0 / NARROWEST
"""Steradians of a box with that lobe's variance, 1 / NARROWEST along each axis."""


@inlined
def level_of_exponent(exponent: float) -> float:
    """Level whose lobe is this power of the cosine, as `round_lobe` takes it."""
    octaves = math.log2(NARROWEST) - math.log2(exponent)
    # Above level 0 are filters out of tables, for which one level is one octave
    return octaves * LEVELS_PER_OCTAVE if octaves > 0.0 else octaves


@inlined
def level_of_solid_angle(solid_angle: float) -> float:
    """Level whose lobe has the variance of a box of so many steradians."""
    return level_of_exponent(NARROWEST * BOX / solid_angle)


@kernel
def phong_radiances(
    sharp: Doubles,
    order: int,
    texels: Floats,
    sides: Ints,
    firsts: Ints,
    directions: Floats,
    exponent: float,
    cos_yaw: float,
    sin_yaw: float,
    strength: float,
    result: Floats,
) -> None:
    """Write the turned map's mean RGB under cos^exponent to `result` (N, 3)."""
    level = level_of_exponent(exponent)
    for i in range(len(directions)):
        x, y, z = turned(directions, i, cos_yaw, sin_yaw)
        red, green, blue = round_lobe(sharp, order, texels, sides, firsts, x, y, z, level, BOX, 0.0)
        result[i, 0] = red * strength
        result[i, 1] = green * strength
        result[i, 2] = blue * strength


MIRROR_HALF_WIDTH = 2.5e-3
"""Radians: the lobe of a mirror is 2 MIN_ALPHA wide, and a texel of a map hardly less."""


@kernel
def cone_radiances(
    sharp: Doubles,
    order: int,
    texels: Floats,
    sides: Ints,
    firsts: Ints,
    raw_map: Floats,
    directions: Floats,
    half_width: Floats,
    cos_yaw: float,
    sin_yaw: float,
    strength: float,
    result: Floats,
) -> None:
    """Write the turned map's mean RGB to `result` (N, 3): over cones of half_width (N,) radians.

    Narrow ones read the map (H, W, 3) itself, the others the power of the cosine with their
    variance, a quarter of the half width squared along each axis.
    """
    for i in range(len(directions)):
        x, y, z = turned(directions, i, cos_yaw, sin_yaw)
        if half_width[i] <= MIRROR_HALF_WIDTH:
            red, green, blue = map_radiance(raw_map, x, y, z)
        else:
            exponent = max(4.0 / (half_width[i] * half_width[i]) - 1.0, 1.0)
            level = level_of_exponent(exponent)
            red, green, blue = round_lobe(
                sharp, order, texels, sides, firsts, x, y, z, level, BOX, 0.0
            )
        result[i, 0] = red * strength
        result[i, 1] = green * strength
        result[i, 2] = blue * strength
