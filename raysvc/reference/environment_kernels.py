"""Directions out of a lat-long map, as often as they are bright.

The map is bilinear between the centres of its texels, and so is its luminance: within a cell
between four centres a place is drawn exactly in proportion to it (a product of linear densities).
Cells are drawn by their light: mean luminance times solid angle. The density then is luminance
times a factor of the cell's row; only the sine of the polar angle, constant within a cell to the
first order, keeps it from being exactly proportional to the light.
"""

import math
from typing import NamedTuple

import numpy as np

from raysvc.geometry.vector_kernels import row3
from raysvc.jit import inlined, kernel
from raysvc.lighting.sphere_kernels import map_place, map_radiance_at
from raysvc.types import Doubles, Floats


class SkyTables(NamedTuple):
    """A map (H, W, 3) and where it is bright.

    Lines of latitude are the map's rows and the poles: line 0 is +Y, line i + 1 is row i at the
    polar angle (i + 0.5) pi / H, line H + 1 is -Y. Cell (i, j) lies between lines i and i + 1 and
    the centres of columns j and j + 1.
    """

    radiance: Floats
    """(H, W, 3)."""
    luminance: Floats
    """(H + 2, W) along the lines."""
    row_factor: Doubles
    """(H + 1,) density over polar angle and azimuth, per luminance."""
    rows: Doubles
    """(H + 1,) running sum of the light of rows of cells."""
    columns: Doubles
    """((H + 1) W,) running sum of mean luminances within each row of cells, row after row."""
    turn: Doubles
    """(3,) cosine and sine of the map's yaw; what scales its light."""


@inlined
def _first_above(sums: Doubles, begin: int, count: int, wanted: float) -> int:
    """Index of the first of `count` running sums, from `begin` on, that exceeds `wanted`."""
    low, high = begin, begin + count - 1
    while low < high:
        middle = (low + high) // 2
        if sums[middle] > wanted:
            high = middle
        else:
            low = middle + 1
    return low


@inlined
def _rest(sums: Doubles, index: int, begin: int, wanted: float) -> float:
    """Where `wanted` lies between the sums before and at `index`, from 0 to 1: a new number."""
    before = sums[index - 1] if index > begin else 0.0
    rest: float = (wanted - before) / max(sums[index] - before, 1e-300)
    return min(max(rest, 0.0), 1.0)


@inlined
def linear_place(begin: float, end: float, u: float) -> float:
    """Place in 0..1 by a density that goes linearly from `begin` to `end`, by inversion."""
    total = begin + end
    if total <= 0.0:
        return u
    root = math.sqrt(begin * begin + u * (end * end - begin * begin))
    return min(u * total / (begin + root), 1.0) if u > 0.0 else 0.0


@inlined
def _cell_place(sky: SkyTables, u: float, v: float) -> tuple[int, float, float]:
    """Row of cells for two random numbers, place in it from 0 to 1, and the column."""
    rows, columns, luminance = sky.rows, sky.columns, sky.luminance
    width = luminance.shape[1]
    i = _first_above(rows, 0, len(rows), u * rows[len(rows) - 1])
    y = _rest(rows, i, 0, u * rows[len(rows) - 1])
    wanted = v * columns[(i + 1) * width - 1]
    j = _first_above(columns, i * width, width, wanted)
    x = _rest(columns, j, i * width, wanted)
    left, right = j - i * width, (j + 1 - i * width) % width
    a, b = np.float64(luminance[i, left]), np.float64(luminance[i, right])
    c, d = np.float64(luminance[i + 1, left]), np.float64(luminance[i + 1, right])
    y = linear_place(a + b, c + d, y)
    return i, y, left + linear_place(a + (c - a) * y, b + (d - b) * y, x)


@inlined
def _line_row(line: int, height: int) -> float:
    """Row of the map at which a line of latitude lies, as `map_place` counts rows."""
    return min(max(line - 1.0, -0.5), height - 0.5)


@inlined
def _density(sky: SkyTables, row: float, column: float) -> float:
    """Density per steradian of `sample_sky` at a place of the map."""
    luminance = sky.luminance
    height, width = luminance.shape[0] - 2, luminance.shape[1]
    i = min(max(math.floor(row) + 1, 0), height)
    begin, end = _line_row(i, height), _line_row(i + 1, height)
    y = min(max((row - begin) / (end - begin), 0.0), 1.0)
    j = math.floor(column)
    x = column - j
    left, right = int(j) % width, (int(j) + 1) % width
    above = luminance[i, left] * (1.0 - x) + luminance[i, right] * x
    below = luminance[i + 1, left] * (1.0 - x) + luminance[i + 1, right] * x
    sine = math.sin((row + 0.5) / height * math.pi)
    density: float = (above * (1.0 - y) + below * y) * sky.row_factor[i] / max(sine, 1e-12)
    return density


@kernel
def look_up(sky: SkyTables, directions: Floats, radiance: Floats, density: Doubles) -> None:
    """Write the turned map's RGB (N, 3) along world directions (N, 3), and with what density (N,)
    `sample_sky` draws them.
    """
    cos_yaw, sin_yaw, strength = sky.turn[0], sky.turn[1], sky.turn[2]
    height, width = sky.radiance.shape[0], sky.radiance.shape[1]
    for n in range(len(directions)):
        dx, y, dz = row3(directions, n)
        x, z = cos_yaw * dx - sin_yaw * dz, sin_yaw * dx + cos_yaw * dz
        row, column = map_place(x, y, z, height, width)
        red, green, blue = map_radiance_at(sky.radiance, row, column)
        radiance[n, 0] = red * strength
        radiance[n, 1] = green * strength
        radiance[n, 2] = blue * strength
        density[n] = _density(sky, row, column)


@kernel
def sample_sky(
    sky: SkyTables, place: Doubles, directions: Floats, radiance: Floats, density: Doubles
) -> None:
    """Draw N directions of the world for random numbers `place` (N, 2).

    Fills unit directions (N, 3), the radiance there over the density (N, 3), and the density per
    steradian (N,).
    """
    cos_yaw, sin_yaw, strength = sky.turn[0], sky.turn[1], sky.turn[2]
    height, width = sky.radiance.shape[0], sky.radiance.shape[1]
    for n in range(len(place)):
        i, y, column = _cell_place(sky, place[n, 0], place[n, 1])
        begin, end = _line_row(i, height), _line_row(i + 1, height)
        row = begin + (end - begin) * y
        polar = (row + 0.5) / height * math.pi
        azimuth = ((column + 0.5) / width - 0.5) * 2.0 * math.pi
        sine = math.sin(polar)
        x, up, z = sine * math.sin(azimuth), math.cos(polar), -sine * math.cos(azimuth)
        red, green, blue = map_radiance_at(sky.radiance, row, column)
        found = _density(sky, row, column)
        scale = strength / found if found > 0.0 else 0.0
        density[n] = found
        radiance[n, 0] = red * scale
        radiance[n, 1] = green * scale
        radiance[n, 2] = blue * scale
        directions[n, 0] = cos_yaw * x + sin_yaw * z
        directions[n, 1] = up
        directions[n, 2] = cos_yaw * z - sin_yaw * x
