"""A sun, taken out of an environment so that it can cast shadows and need not be filtered.

A few texels with most of the light spoil every filtered lookup near them, and no number of lobe
samples finds them; as a light with a direction they are exact (reference: Debevec 2005, median cut,
in the degenerate case of one light).
"""

import math
from dataclasses import dataclass

import numpy as np

from raysvc.lighting.lat_long import texel_directions, texel_solid_angles
from raysvc.scene.light import Vector
from raysvc.types import Doubles, Floats

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Of linear Rec.709."""

MIN_PEAK_OVER_MEAN = 20.0
"""Weaker peaks are filtered well enough where they are."""
PART_OF_PEAK = 0.05
"""Texels above this part of the peak belong to the sun."""
MAX_EXTENT_RAD = math.radians(6.0)
"""Larger lights are softboxes and windows: they stay in the map."""
SEARCH_RAD = math.radians(8.0)
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


def extract_sun(radiance: Floats) -> tuple[SunLight | None, Floats]:
    """Find the sun of a lat-long map and take it out.

    Parameters
    ----------
    radiance
        (H, W, 3) float32, as `raysvc.scene.Environment` holds it

    Returns
    -------
    sun
        in the map's own frame, or None if no small region dominates
    rest
        (H, W, 3) float32: the map with the sun's disc filled by the mean of its surroundings. Sun
        and rest together light a surface that faces the sun as the map did. The same array if there
        is no sun.
    """
    height, width, _ = radiance.shape
    per_row = texel_solid_angles(height, width)
    luminance = radiance @ LUMINANCE.astype(np.float32)
    light = float(luminance.sum(axis=1, dtype=np.float64) @ per_row)
    peak = float(luminance.max())
    if peak * 4.0 * math.pi < MIN_PEAK_OVER_MEAN * light or light == 0.0:
        return None, radiance

    # Bright texels near the peak, their centre and extent
    row, column = np.unravel_index(int(luminance.argmax()), luminance.shape)
    towards = texel_directions(int(row) + 0.5, int(column) + 0.5, height, width)
    rows, columns, directions = _texels_within(towards, SEARCH_RAD, height, width)
    bright = luminance[rows, columns] > PART_OF_PEAK * peak
    flux = (luminance[rows, columns] * per_row[rows])[bright]
    towards = flux @ directions[bright]
    towards /= np.linalg.norm(towards)
    extent = float(np.arccos(np.clip(directions[bright] @ towards, -1.0, 1.0)).max())
    if extent > MAX_EXTENT_RAD or flux.sum() < MIN_SHARE * light:
        return None, radiance

    # Split the disc around them into its surroundings' radiance and an excess, the sun
    texel = math.pi / height
    border = extent + 1.5 * texel
    rows, columns, directions = _texels_within(towards, border + 2.0 * texel, height, width)
    angles = np.arccos(np.clip(directions @ towards, -1.0, 1.0))
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
    x, y, z = (float(v) for v in towards)
    red, green, blue = (float(v) for v in irradiance)
    return SunLight((x, y, z), (red, green, blue), math.sqrt(2.0 * spread)), rest


def _texels_within(
    towards: Doubles, radius: float, height: int, width: int
) -> tuple[np.ndarray, np.ndarray, Doubles]:
    """Rows, columns and directions (K, 3) of texels within `radius` of a direction."""
    polar = math.acos(min(max(float(towards[1]), -1.0), 1.0))
    first = max(int((polar - radius) / math.pi * height), 0)
    last = min(int((polar + radius) / math.pi * height) + 1, height)
    rows, columns = np.mgrid[first:last, 0:width]
    directions = texel_directions(rows + 0.5, columns + 0.5, height, width)
    near = directions @ towards >= math.cos(radius)
    return rows[near], columns[near], directions[near]
