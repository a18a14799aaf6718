"""Lights that have a size, and therefore soft shadows: what they are, and the sun as one.

What such a light would give with nothing in its way is known without noise; rays only say what part
of it arrives (Heitz, Hill and McGuire 2018, "Combining Analytic Direct Illumination and Stochastic
Shadows").
"""

from typing import NamedTuple, Protocol

import numpy as np

from raysvc.lighting.direct import reflected
from raysvc.lighting.direct_kernels import directions_to_disc
from raysvc.lighting.sun import SunLight
from raysvc.shading.surface import Surface
from raysvc.types import Doubles, Floats, Longs

RIM_RAYS = 6
"""With so many an edge that none of them sees hides at most 4 % of a disc."""


class ShadowRays(NamedTuple):
    """One ray from each of M points to a place of a light, float32."""

    directions: Floats
    """(M, 3) unit."""
    distance: Floats
    """(M,) metres to the light, inf for what is nowhere."""


class AreaLight(Protocol):
    """A light with a size."""

    @property
    def rim(self) -> Doubles:
        """(R, 2) samples near its edges: where they are all lit or all dark, so is most of it."""

    def unshadowed(self, surface: Surface) -> Floats:
        """(N, 3) radiance that points return of it with nothing in the way."""

    def rays(self, surface: Surface, point: Longs, samples: Doubles) -> ShadowRays:
        """Rays from points (M,) of a surface to places that samples (M, 2) in 0..1 stand for."""


class SunDisc:
    """The sun of an environment."""

    rim: Doubles = np.stack([np.full(RIM_RAYS, 0.9), np.arange(RIM_RAYS) / RIM_RAYS], axis=1)
    """(RIM_RAYS, 2)."""

    def __init__(self, sun: SunLight) -> None:
        self._sun = sun
        towards = np.array(sun.direction)
        across = np.cross(towards, [0.0, 0.0, 1.0] if abs(towards[2]) < 0.7 else [1.0, 0.0, 0.0])
        across /= np.linalg.norm(across)
        self._axes = np.stack([across, np.cross(towards, across), towards])

    def unshadowed(self, surface: Surface) -> Floats:
        """(N, 3) radiance that points return of it with nothing in the way."""
        sun = self._sun
        to_light = np.tile(np.array(sun.direction, np.float32), (surface.size, 1))
        irradiance = np.tile(np.array(sun.irradiance, np.float32), (surface.size, 1))
        return reflected(surface, to_light, irradiance, sun.angular_radius_rad)

    def rays(self, surface: Surface, point: Longs, samples: Doubles) -> ShadowRays:
        """Rays from points (M,) of a surface to places of the disc, even by its area."""
        directions = np.empty((len(point), 3), np.float32)
        directions_to_disc(self._axes, self._sun.angular_radius_rad, samples, directions)
        return ShadowRays(directions, np.full(len(point), np.inf, np.float32))
