"""Reading an environment under round lobes of any width."""

import math

from raysvc.geometry.octahedral_kernels import octahedral_direction, octahedral_place
from raysvc.jit import inlined, kernel
from raysvc.lighting.sphere_kernels import map_radiance, narrow_radiance
from raysvc.types import Doubles, Floats, Ints

WIDEST = 0.1
"""Steradians of a filter out of tables that is widened by a pixel."""


@kernel
def unfold(lat_long: Floats, side: int, first: int, texels: Floats) -> None:
    """Resample a lat-long map to an octahedral image of `side` texels with a border of one.

    It goes to rows from `first` on of `texels`.
    """
    for i in range(side + 2):
        for j in range(side + 2):
            x, y, z = octahedral_direction((j - 0.5) / side, (i - 0.5) / side)
            red, green, blue = map_radiance(lat_long, x, y, z)
            # A kernel cut off at some degree undershoots a little beside what is bright
            texels[first + i, j, 0] = max(red, 0.0)
            texels[first + i, j, 1] = max(green, 0.0)
            texels[first + i, j, 2] = max(blue, 0.0)


@inlined
def level_radiance(
    texels: Floats, side: int, first: int, u: float, v: float
) -> tuple[float, float, float]:
    """RGB of one level at an octahedral place, bilinear."""
    row, column = v * side + 0.5, u * side + 0.5
    i, j = int(row), int(column)
    down, right = row - i, column - j
    a, b = (1.0 - down) * (1.0 - right), (1.0 - down) * right
    c, d = down * (1.0 - right), down * right
    i += first
    return (
        a * texels[i, j, 0]
        + b * texels[i, j + 1, 0]
        + c * texels[i + 1, j, 0]
        + d * texels[i + 1, j + 1, 0],
        a * texels[i, j, 1]
        + b * texels[i, j + 1, 1]
        + c * texels[i + 1, j, 1]
        + d * texels[i + 1, j + 1, 1],
        a * texels[i, j, 2]
        + b * texels[i, j + 1, 2]
        + c * texels[i + 1, j, 2]
        + d * texels[i + 1, j + 1, 2],
    )


@inlined
def lobe_radiance(
    texels: Floats, sides: Ints, firsts: Ints, x: float, y: float, z: float, level: float
) -> tuple[float, float, float]:
    """RGB of an environment under the lobe of a fractional level about a direction, not zero.

    Arrays are those of `lobe_levels.LobeLevels`; levels outside of it count as its nearest.
    """
    u, v = octahedral_place(x, y, z)
    level = min(max(level, 0.0), len(sides) - 1.0)
    k = min(int(level), len(sides) - 2)
    part = level - k
    red, green, blue = level_radiance(texels, sides[k], firsts[k], u, v)
    r, g, b = level_radiance(texels, sides[k + 1], firsts[k + 1], u, v)
    return red + (r - red) * part, green + (g - green) * part, blue + (b - blue) * part


@inlined
def round_lobe(
    sharp: Doubles,
    order: int,
    texels: Floats,
    sides: Ints,
    firsts: Ints,
    x: float,
    y: float,
    z: float,
    level: float,
    narrowest: float,
    pixel_sr: float,
) -> tuple[float, float, float]:
    """RGB under the round lobe of a level about a direction, not zero.

    Below level 0 it is a filter out of tables, of `narrowest` steradians at level 0 and half of
    that at the next one below; between -1 and 0 filter and lobe fade into each other. Filters are
    averaged over a pixel of `pixel_sr` besides: variances of boxes add as their areas do. Lobes are
    not, for they are wide themselves, and the next wider one has longer tails than a pixel.
    """
    if level >= 0.0:
        return lobe_radiance(texels, sides, firsts, x, y, z, level)
    scale = 1.0 / math.sqrt(x * x + y * y + z * z)
    solid_angle = narrowest * math.exp(math.log(2.0) * level)
    solid_angle = min(solid_angle + pixel_sr, max(solid_angle, WIDEST))
    red, green, blue = narrow_radiance(sharp, order, x * scale, y * scale, z * scale, solid_angle)
    if level > -1.0:
        part = level + 1.0
        r, g, b = lobe_radiance(texels, sides, firsts, x, y, z, 0.0)
        red, green, blue = (
            red + (r - red) * part,
            green + (g - green) * part,
            blue + (b - blue) * part,
        )
    return red, green, blue
