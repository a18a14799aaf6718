"""Suns: small lights, taken out of an environment to cast shadows and need no filtering.

A few texels with most of the light spoil every filtered lookup near them, and no number of lobe
samples finds them; as lights with a direction they are exact (reference: Debevec 2005, median cut,
in the degenerate case of few lights).
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from raysvc.lighting.lat_long import texel_directions, texel_solid_angles
from raysvc.scene.light import Vector
from raysvc.types import Bools, Doubles, Floats, Longs

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Of linear Rec.709."""

MIN_PEAK_OVER_MEAN = 20.0
"""Weaker peaks are filtered well enough where they are."""
PART_OF_PEAK = 0.05
"""Texels above this part of the peak belong to the sun."""
MAX_EXTENT_RAD = math.radians(6.0)
"""Larger lights are softboxes and windows: they stay in the map."""
SEARCH_RAD = math.radians(8.0)
MOST = 4
"""Suns of a map: each costs shadow rays."""
TRIES = 16
"""Peaks that are looked at; those of larger lights are passed over."""
MIN_SHARE = 0.01
"""Of the map's light; less is not worth shadow rays."""


@dataclass(frozen=True, slots=True)
class SunLight:
    """A bright disc at infinity."""

    direction: Vector
    """Unit, towards the sun."""
    irradiance: Vector
    """Linear RGB at a surface that faces it."""
    angular_radius_rad: float

    def turned(self, cos_yaw: float, sin_yaw: float) -> "SunLight":
        """Return it in the world, in which the map is turned counter-clockwise seen from above."""
        x, y, z = self.direction
        turned = (cos_yaw * x + sin_yaw * z, y, cos_yaw * z - sin_yaw * x)
        return replace(self, direction=turned)


def extract_suns(radiance: Floats) -> tuple[tuple[SunLight, ...], Floats]:
    """Find the small lights of a lat-long map and take them out.

    Parameters
    ----------
    radiance
        (H, W, 3) float32, as `raysvc.scene.Environment` holds it

    Returns
    -------
    suns
        in the map's own frame, the one with the highest peak first; none if no small region stands
        out
    rest
        (H, W, 3) float32: the map with the suns' discs filled by the mean of their surroundings.
        Suns and rest together light a surface that faces a sun as the map did. The same array if
        there is no sun.
    """
    light = float(_luminances(radiance).sum(axis=1, dtype=np.float64) @ _per_row(radiance))
    suns: list[SunLight] = []
    rest, passed = radiance, np.zeros(radiance.shape[:2], bool)
    for _ in range(TRIES):
        if len(suns) == MOST:
            break
        luminance = np.where(passed, np.float32(0.0), _luminances(rest))
        left = float(luminance.sum(axis=1, dtype=np.float64) @ _per_row(rest))
        peak = float(luminance.max())
        if peak * 4.0 * math.pi < MIN_PEAK_OVER_MEAN * left or left == 0.0:
            break
        found = _bright_region(luminance, peak)
        small = found.extent <= MAX_EXTENT_RAD and not _touches(passed, found)
        passed[found.rows, found.columns] = True
        if small and found.flux >= MIN_SHARE * light:
            sun, rest = _taken_out(rest, found)
            suns.append(sun)
    return tuple(suns), rest


@dataclass(frozen=True, slots=True)
class _Region:
    """Bright texels around a peak."""

    towards: Doubles
    extent: float
    """Radians from there to the farthest of them."""
    flux: float
    rows: Longs
    columns: Longs


def _bright_region(luminance: Floats, peak: float) -> _Region:
    """Texels near a map's peak of more than PART_OF_PEAK of it."""
    height, width = luminance.shape
    row, column = np.unravel_index(int(luminance.argmax()), luminance.shape)
    towards = texel_directions(int(row) + 0.5, int(column) + 0.5, height, width)
    rows, columns, directions = _texels_within(towards, SEARCH_RAD, height, width)
    bright = luminance[rows, columns] > PART_OF_PEAK * peak
    flux = (luminance[rows, columns] * texel_solid_angles(height, width)[rows])[bright]
    towards = flux @ directions[bright]
    towards /= np.linalg.norm(towards)
    extent = float(np.arccos(np.clip(directions[bright] @ towards, -1.0, 1.0)).max())
    return _Region(towards, extent, float(flux.sum()), rows[bright], columns[bright])


def _touches(passed: Bools, region: _Region) -> bool:
    """Is any texel next to a region one that was looked at, in a larger light or a sun?"""
    height, width = passed.shape
    rows = np.clip(region.rows[:, None] + np.array([-1, 0, 1, 0, 0]), 0, height - 1)
    columns = (region.columns[:, None] + np.array([0, -1, 0, 1, 0])) % width
    return bool(passed[rows, columns].any())


def _taken_out(radiance: Floats, region: _Region) -> tuple[SunLight, Floats]:
    """Split a disc around a region into its surroundings' radiance and an excess, the sun."""
    height, width, _ = radiance.shape
    per_row, texel = _per_row(radiance), math.pi / height
    border = region.extent + 1.5 * texel
    rows, columns, directions = _texels_within(region.towards, border + 2.0 * texel, height, width)
    angles = np.arccos(np.clip(directions @ region.towards, -1.0, 1.0))
    inside = angles <= border
    pixels = radiance[rows, columns].astype(np.float64)
    weights = per_row[rows]
    around = weights[~inside] @ pixels[~inside] / max(weights[~inside].sum(), 1e-30)
    facing = np.cos(angles[inside]) * weights[inside]
    # No channel of a sun is negative
    around = np.minimum(around, facing @ pixels[inside] / facing.sum())
    irradiance = facing @ (pixels[inside] - around)

    rest = radiance.copy()
    rest[rows[inside], columns[inside]] = around
    # A uniform disc has mean squared radius r^2 / 2; a texel's own size counts
    brightness = np.maximum((pixels[inside] - around) @ LUMINANCE, 0.0) * weights[inside]
    spread = float(brightness @ angles[inside] ** 2 / brightness.sum()) + texel * texel / 6.0
    x, y, z = (float(v) for v in region.towards)
    red, green, blue = (float(v) for v in irradiance)
    return SunLight((x, y, z), (red, green, blue), math.sqrt(2.0 * spread)), rest


def _luminances(radiance: Floats) -> Floats:
    luminances: Floats = radiance @ LUMINANCE.astype(np.float32)
    return luminances


def _per_row(radiance: Floats) -> Doubles:
    return texel_solid_angles(radiance.shape[0], radiance.shape[1])


def _texels_within(
    towards: Doubles, radius: float, height: int, width: int
) -> tuple[Longs, Longs, Doubles]:
    """Rows, columns and directions (K, 3) of texels within `radius` of a direction."""
    polar = math.acos(min(max(float(towards[1]), -1.0), 1.0))
    first = max(int((polar - radius) / math.pi * height), 0)
    last = min(int((polar + radius) / math.pi * height) + 1, height)
    rows, columns = np.mgrid[first:last, 0:width]
    directions = texel_directions(rows + 0.5, columns + 0.5, height, width)
    near = directions @ towards >= math.cos(radius)
    return rows[near], columns[near], directions[near]
