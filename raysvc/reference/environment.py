"""An environment as a light of paths: the whole map, sun included, drawn where it is bright."""

import math

import numpy as np

from raysvc.lighting.sun import LUMINANCE
from raysvc.reference.environment_kernels import SkyTables, look_up, sample_sky
from raysvc.reference.lights import LightSamples
from raysvc.scene import Environment
from raysvc.types import Doubles, Floats


class EnvironmentLight:
    """Light from an environment, turned and scaled. Immutable; safe to use from many threads.

    Parameters
    ----------
    environment
        what is far away
    yaw_deg
        turns it counter-clockwise seen from above
    strength
        scales all of its light
    """

    def __init__(
        self, environment: Environment, yaw_deg: float = 0.0, strength: float = 1.0
    ) -> None:
        yaw = math.radians(yaw_deg)
        radiance = np.ascontiguousarray(environment.radiance)
        height, width, _ = radiance.shape
        luminance = _with_poles(radiance @ LUMINANCE.astype(np.float32))
        angles = np.clip((np.arange(height + 2) - 0.5) / height, 0.0, 1.0) * math.pi
        solid = -np.diff(np.cos(angles))
        columns = np.cumsum(_cell_means(luminance), axis=1)
        rows = np.cumsum(columns[:, -1] * solid)
        light = float(rows[-1])
        self.is_dark = not light * strength > 0.0
        """There is nothing to draw."""
        scale = 1.0 if light == 0.0 else 1.0 / light
        self._tables = SkyTables(
            radiance,
            luminance,
            solid / np.diff(angles) * (scale * width / math.tau),
            rows,
            columns.reshape(-1),
            np.array([math.cos(yaw), math.sin(yaw), strength]),
        )

    def look_up(self, directions: Floats) -> tuple[Floats, Doubles]:
        """Radiance (N, 3) float32 along unit directions (N, 3) float32, and the density per
        steradian (N,) float64 with which `sample` draws each.
        """
        radiance = np.empty((len(directions), 3), np.float32)
        density = np.empty(len(directions))
        look_up(self._tables, directions, radiance, density)
        return radiance, density

    def sample(self, place: Doubles) -> LightSamples:
        """Draw N directions for random numbers `place` (N, 2) in 0..1; not if `is_dark`."""
        samples = LightSamples.empty(len(place))
        sample_sky(self._tables, place, samples.to_light, samples.radiance, samples.density)
        samples.distance.fill(np.inf)
        return samples


def _with_poles(luminance: Floats) -> Floats:
    """(H + 2, W) with a line for either pole: there the map is the mean of opposite texels."""
    width = luminance.shape[1]
    lines = []
    for row in (luminance[0], luminance[-1]):
        # Half a turn away; between two texels where the width is odd
        opposite = (np.roll(row, width // 2) + np.roll(row, width - width // 2)) / 2
        lines.append((row + opposite) / 2)
    return np.concatenate([lines[:1], luminance, lines[1:]]).astype(np.float32)


def _cell_means(luminance: Floats) -> Doubles:
    """(H + 1, W) mean of a cell's four corners; the last column's right neighbour is the first."""
    lines = luminance[:-1].astype(np.float64) + luminance[1:]
    means: Doubles = (lines + np.roll(lines, -1, axis=1)) / 4.0
    return means
