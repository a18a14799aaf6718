"""A clear sky with a sun 45 degrees high, behind the default camera's left shoulder.

Luminance is that of the CIE Standard General Sky, type 12, "clear, low turbidity" (ISO
15469:2004); the colour goes from a pale horizon to a deep blue. The sun is larger than the real
one (0.27 degrees) so that it is a few texels wide, with the radiance that gives the right
irradiance.
"""

import numpy as np

from raysvc.builtin.lat_long import irradiance, texel_directions
from raysvc.scene import Environment
from raysvc.types import Doubles

WIDTH, HEIGHT = 1024, 512
SUN_DIRECTION = np.array([-0.5, np.sqrt(0.5), 0.5])
"""Unit, towards the sun."""
SUN_RADIUS_DEG = 0.45
SUN_COLOUR = np.array([1.0, 0.93, 0.82])
SUN_TO_SKY = 3.6
"""Irradiance of level ground by the sun, over that by the sky."""
LEVEL_RADIOSITY = 1.5
"""Irradiance of level ground over pi, as luminance: what white paper would show."""
ZENITH_COLOUR = np.array([0.50, 0.96, 2.15])
HORIZON_COLOUR = np.array([0.84, 1.02, 1.20])
"""Colours of luminance about 1."""
GROUND_ALBEDO = np.array([0.19, 0.18, 0.145])
HAZE_DEG = 5.0
"""Depth below the horizon within which the ground fades into it."""
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def clear_sky() -> Environment:
    """Return the environment, (512, 1024, 3)."""
    up = np.array([0.0, 1.0, 0.0])
    sky = _sky(texel_directions(HEIGHT, WIDTH))
    sky *= np.pi * LEVEL_RADIOSITY / (1.0 + SUN_TO_SKY) / (irradiance(sky, up) @ LUMINANCE)
    sun = _sun_coverage() * SUN_COLOUR
    sun *= SUN_TO_SKY * (irradiance(sky, up) @ LUMINANCE) / (irradiance(sun, up) @ LUMINANCE)
    return Environment((_with_ground(sky, sun) + sun).astype(np.float32), name="clear_sky")


def _sky(directions: Doubles) -> Doubles:
    """Relative radiance (H, W, 3); directions below the horizon get that of the horizon."""
    up = np.maximum(directions[..., 1:2], 0.01)
    from_sun = np.arccos(np.clip(directions @ SUN_DIRECTION, -1.0, 1.0))[..., None]
    gradation = 1.0 - np.exp(-0.32 / up)
    indicatrix = (
        1.0 + 10.0 * (np.exp(-3.0 * from_sun) - np.exp(-1.5 * np.pi)) + 0.45 * np.cos(from_sun) ** 2
    )
    haze = np.exp(-3.5 * up)
    colour = ZENITH_COLOUR + haze * (HORIZON_COLOUR - ZENITH_COLOUR)
    return np.asarray(gradation * indicatrix * colour)


def _sun_coverage() -> Doubles:
    """(H, W, 1) fraction of each texel that the sun's disc covers, by 16 x 16 samples."""
    fine = 16
    rows, columns = _texels_near_sun()
    v = (rows[0] + (np.arange(fine * len(rows)) + 0.5) / fine) / HEIGHT
    u = (columns[0] + (np.arange(fine * len(columns)) + 0.5) / fine) / WIDTH
    azimuth, polar = 2.0 * np.pi * (u - 0.5), np.pi * v[:, None]
    cosine = (
        np.sin(polar) * (np.sin(azimuth) * SUN_DIRECTION[0] - np.cos(azimuth) * SUN_DIRECTION[2])
        + np.cos(polar) * SUN_DIRECTION[1]
    )
    inside = cosine > np.cos(np.radians(SUN_RADIUS_DEG))
    coverage = np.zeros((HEIGHT, WIDTH, 1))
    blocks = inside.reshape(len(rows), fine, len(columns), fine)
    coverage[np.ix_(rows, columns)] = blocks.mean(axis=(1, 3))[..., None]
    return coverage


def _texels_near_sun() -> tuple[np.ndarray, np.ndarray]:
    cosine = texel_directions(HEIGHT, WIDTH) @ SUN_DIRECTION
    rows, columns = np.nonzero(cosine > np.cos(np.radians(SUN_RADIUS_DEG + 1.0)))
    return np.arange(rows.min(), rows.max() + 1), np.arange(columns.min(), columns.max() + 1)


def _with_ground(sky: Doubles, sun: Doubles) -> Doubles:
    """Replace what is below the horizon by a plain lit by sun and sky, fading into the haze."""
    lit = irradiance(sky, np.array([0.0, 1.0, 0.0])) + irradiance(sun, np.array([0.0, 1.0, 0.0]))
    ground = GROUND_ALBEDO * lit / np.pi
    elevation = np.degrees(np.arcsin(texel_directions(HEIGHT, WIDTH)[..., 1:2]))
    below = 1.0 - np.exp(np.minimum(elevation, 0.0) / HAZE_DEG)
    return sky + below * (ground - sky)
