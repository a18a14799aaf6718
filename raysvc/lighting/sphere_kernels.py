"""Lookups of an environment: boxes of its tables, and points of its map."""

import math

import numpy as np

from raysvc.imaging.sat_spline_kernels import box_mean_rgb, quadratic_mean_rgb, tent_mean_rgb
from raysvc.jit import inlined, kernel
from raysvc.types import Doubles, Floats

BAND = (0.68, 0.73)
"""Between these |y| a lookup moves from the cylinder around Y to the one around X."""

MAX_SINE = 0.9
"""Of half the height of the largest box."""


@inlined
def turns_of(across: float, ahead: float) -> float:
    """Angle of atan2(across, ahead) in turns, -0.5..0.5, to 2e-6: less than 1/200 of a texel.

    Polynomial of Abramowitz and Stegun 4.4.49, on one octant.
    """
    wide, far = abs(across), abs(ahead)
    least, most = min(wide, far), max(wide, far, 1e-30)
    t = least / most
    t2 = t * t
    angle = -0.01172120 * t2 + 0.05265332
    angle = angle * t2 - 0.11643287
    angle = angle * t2 + 0.19354346
    angle = angle * t2 - 0.33262347
    angle = (angle * t2 + 0.99997726) * t * (0.5 / math.pi)
    if wide > far:
        angle = 0.25 - angle
    if ahead < 0.0:
        angle = 0.5 - angle
    return -angle if across < 0.0 else angle


@inlined
def _cylinder_mean(
    tables: Doubles, order: int, which: int, along: float, turn: float, solid_angle: float
) -> tuple[float, float, float]:
    """RGB under a filter with the variance of a box that is square on the sphere.

    Takes the direction as its part along the axis and its turn to the right of the centre column.
    The box is never smaller than a texel.
    """
    edge = 1 if order == 1 else order + 1
    rows, columns = tables.shape[1] - edge, tables.shape[2] - edge
    # A square of half height h has 4 sin^2 h steradians, exactly while it clears the axis
    sin_h = min(0.5 * math.sqrt(solid_angle), MAX_SINE)
    cos_h = math.sqrt(1.0 - sin_h * sin_h)
    radius = math.sqrt(max(1.0 - along * along, 0.0))
    high = 1.0 if along >= cos_h else along * cos_h + radius * sin_h
    low = -1.0 if along <= -cos_h else along * cos_h - radius * sin_h
    wide = solid_angle / (high - low) * (0.5 / math.pi)

    half_rows = 0.5 * max((high - low) * 0.5 * rows, 1.0)
    row = min(max((0.5 - 0.25 * (high + low)) * rows, half_rows), rows - half_rows)
    half_columns = 0.5 * min(max(wide * columns, 1.0), columns * 1.0)
    column = (turn + 0.5) * columns
    # The variance of n boxes is n times that of one
    if order == 1:
        return box_mean_rgb(tables, which, row, column, half_rows, half_columns)
    if order == 2:
        half_rows, half_columns = half_rows * math.sqrt(0.5), half_columns * math.sqrt(0.5)
        return tent_mean_rgb(tables, which, row, column, half_rows, half_columns)
    half_rows, half_columns = half_rows * math.sqrt(1 / 3), half_columns * math.sqrt(1 / 3)
    return quadratic_mean_rgb(tables, which, row, column, half_rows, half_columns)


@kernel
def narrow_radiance(
    tables: Doubles, order: int, x: float, y: float, z: float, solid_angle: float
) -> tuple[float, float, float]:
    """Mean RGB over about `solid_angle` steradians around the unit direction (x, y, z).

    Tables are those of `sphere_table` of that order; of order 2 and 3 the filter reaches farther
    than the box, with its variance, and must not reach an axis: up to 0.1 steradians.
    """
    begin, end = BAND
    share = min(max((end - abs(y)) / (end - begin), 0.0), 1.0)
    share = share * share * (3.0 - 2.0 * share)
    red, green, blue = 0.0, 0.0, 0.0
    if share > 0.0:
        red, green, blue = _cylinder_mean(tables, order, 0, y, turns_of(x, -z), solid_angle)
    if share < 1.0:
        r, g, b = _cylinder_mean(tables, order, 1, x, turns_of(y, -z), solid_angle)
        red, green, blue = r + (red - r) * share, g + (green - g) * share, b + (blue - b) * share
    return red, green, blue


@inlined
def _row_rgb(radiance: Floats, row: int, column: float) -> tuple[float, float, float]:
    """RGB at a fractional column of a row; beyond a pole it is the row half a turn away."""
    height, width = radiance.shape[0], radiance.shape[1]
    if row < 0 or row >= height:
        row = 0 if row < 0 else height - 1
        column += 0.5 * width
    j = math.floor(column)
    u = column - j
    left, right = int(j) % width, (int(j) + 1) % width
    return (
        radiance[row, left, 0] * (1.0 - u) + radiance[row, right, 0] * u,
        radiance[row, left, 1] * (1.0 - u) + radiance[row, right, 1] * u,
        radiance[row, left, 2] * (1.0 - u) + radiance[row, right, 2] * u,
    )


@inlined
def map_place(x: float, y: float, z: float, height: int, width: int) -> tuple[float, float]:
    """Row and column of a lat-long map in which a unit direction lies; texel centres are whole."""
    # atan2 keeps the digits that acos loses at the poles
    row = math.atan2(math.sqrt(x * x + z * z), y) / math.pi * height - 0.5
    column = (math.atan2(x, -z) / (2.0 * math.pi) + 0.5) * width - 0.5
    return row, column


@inlined
def map_radiance_at(radiance: Floats, row: float, column: float) -> tuple[float, float, float]:
    """RGB of a lat-long map (H, W, 3) at a place as `map_place` gives it, bilinear."""
    i = math.floor(row)
    v = row - i
    red, green, blue = _row_rgb(radiance, int(i), column)
    r, g, b = _row_rgb(radiance, int(i) + 1, column)
    return red * (1.0 - v) + r * v, green * (1.0 - v) + g * v, blue * (1.0 - v) + b * v


@inlined
def map_radiance(radiance: Floats, x: float, y: float, z: float) -> tuple[float, float, float]:
    """RGB of a lat-long map (H, W, 3) in the unit direction (x, y, z), bilinear."""
    row, column = map_place(x, y, z, radiance.shape[0], radiance.shape[1])
    return map_radiance_at(radiance, row, column)


@inlined
def turned(vectors: Floats, i: int, cos_yaw: float, sin_yaw: float) -> tuple[float, float, float]:
    """Row i of world vectors (N, 3) in the map's frame."""
    x, y, z = float(vectors[i, 0]), float(vectors[i, 1]), float(vectors[i, 2])
    return cos_yaw * x - sin_yaw * z, y, sin_yaw * x + cos_yaw * z


@kernel
def map_radiances(
    radiance: Floats,
    directions: Floats,
    cos_yaw: float,
    sin_yaw: float,
    strength: float,
    result: Floats,
) -> None:
    """Write the turned map's RGB along world `directions` (N, 3) to `result` (N, 3)."""
    for i in range(len(directions)):
        x, y, z = turned(directions, i, cos_yaw, sin_yaw)
        red, green, blue = map_radiance(radiance, x, y, z)
        result[i, 0] = red * strength
        result[i, 1] = green * strength
        result[i, 2] = blue * strength


@kernel
def spread_to_x_cylinder(radiance: Floats, detail: int, shared: Doubles) -> None:
    """Add the light of a lat-long map (H, W, 3) to `shared` (rows, columns, RGB + solid angle).

    Every texel is cut into parts, `detail` down and up to as many across, and each part's light is
    shared bilinearly by the four texels of the cylinder around X next to it.
    """
    height, width = radiance.shape[0], radiance.shape[1]
    rows, columns = shared.shape[0], shared.shape[1]
    last = 0
    sines, cosines = np.empty(0), np.empty(0)
    for part_row in range(height * detail):
        i = part_row // detail
        polar = (part_row + 0.5) / (height * detail) * math.pi
        cosine, sine = math.cos(polar), math.sin(polar)
        top, bottom = part_row / (height * detail), (part_row + 1) / (height * detail)
        band = math.cos(top * math.pi) - math.cos(bottom * math.pi)
        # As many parts across as make them about square
        parts = max(math.ceil(sine * 2.0 * detail * height / width), 1)
        part_angle = band * 2.0 * math.pi / (width * parts)
        if parts != last:
            azimuths = ((np.arange(width * parts) + 0.5) / (width * parts) - 0.5) * 2.0 * math.pi
            sines, cosines, last = np.sin(azimuths), np.cos(azimuths), parts
        for part_column in range(width * parts):
            j = part_column // parts
            x, ahead = sine * sines[part_column], sine * cosines[part_column]
            row = (0.5 - 0.5 * x) * rows - 0.5
            column = (turns_of(cosine, ahead) + 0.5) * columns - 0.5
            below, right = math.floor(row), math.floor(column)
            v, u = row - below, column - right
            upper, lower = max(int(below), 0), min(int(below) + 1, rows - 1)
            left = int(right) if right >= 0 else columns - 1
            other = left + 1 if left + 1 < columns else 0
            for k in range(4):
                r = lower if k >= 2 else upper
                c = other if k % 2 == 1 else left
                share = part_angle * (v if k >= 2 else 1.0 - v) * (u if k % 2 == 1 else 1.0 - u)
                shared[r, c, 0] += share * radiance[i, j, 0]
                shared[r, c, 1] += share * radiance[i, j, 1]
                shared[r, c, 2] += share * radiance[i, j, 2]
                shared[r, c, 3] += share
