"""An environment as a light: its sun apart, the rest filtered through summed-area tables."""

import math
from dataclasses import replace

import numpy as np

from raysvc.lighting import albedo
from raysvc.lighting.image_kernels import diffuse_light, specular_light
from raysvc.lighting.lobe_pattern import cosine_pattern, visible_normal_pattern
from raysvc.lighting.soft_map import soft_map
from raysvc.lighting.soft_map_kernels import SoftMap
from raysvc.lighting.sphere_kernels import cone_radiances, map_radiances
from raysvc.lighting.sphere_table import SphereTable
from raysvc.lighting.sun import SunLight, extract_sun
from raysvc.scene import Environment
from raysvc.shading.surface import Surface
from raysvc.types import Floats

DIFFUSE_LIFT = 1.07
SPECULAR_LIFT = 0.92
"""Height that a lookup's box keeps above the horizon, in halves of the box."""


class ImageLight:
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
        self._turn = (math.cos(yaw), math.sin(yaw))
        self._strength = float(strength)
        self._map = np.ascontiguousarray(environment.radiance)
        sun, rest = extract_sun(self._map)
        self._table = SphereTable.of(rest)
        self._albedo = albedo.albedo_tables()
        self.sun: SunLight | None = self._placed(sun) if sun else None
        """The environment's sun in the world, or None; `diffuse` and `specular` are without it."""

    def _placed(self, sun: SunLight) -> SunLight:
        """Turn a sun out of the map's frame, and scale it."""
        (cosine, sine), (x, y, z) = self._turn, sun.direction
        red, green, blue = (v * self._strength for v in sun.irradiance)
        return replace(
            sun,
            direction=(cosine * x + sine * z, y, cosine * z - sine * x),
            irradiance=(red, green, blue),
        )

    def radiance(self, directions: Floats) -> Floats:
        """Radiance (N, 3) float32 of the map with its sun, along unit directions (N, 3) float32."""
        result = np.empty((len(directions), 3), np.float32)
        map_radiances(self._map, directions, *self._turn, self._strength, result)
        return result

    def cone(self, directions: Floats, half_width: Floats) -> Floats:
        """Mean radiance (N, 3) float32 of cones about unit directions (N, 3).

        half_width (N,) float32 radians; up to the mirror's it is the map, sun included, beyond it
        is without the sun.
        """
        result = np.empty((len(directions), 3), np.float32)
        cone_radiances(
            self._table.sharp,
            self._table.soft,
            self._map,
            directions,
            half_width,
            *self._turn,
            self._strength,
            result,
        )
        return result

    def softened(self, solid_angle: float) -> SoftMap:
        """Return all but the sun, for lookups that each stand for `solid_angle` steradians."""
        return soft_map(self._table, solid_angle, self._turn, self._strength)

    def diffuse(self, surface: Surface, samples: int) -> Floats:
        """Radiance that the diffuse lobe returns of all but the sun, with nothing in the way.

        Parameters
        ----------
        surface
            N points
        samples
            lookups per point, at least 1

        Returns
        -------
        (N, 3) float32
        """
        result = np.empty((surface.size, 3), np.float32)
        diffuse_light(
            self._table.sharp,
            self._table.soft,
            self._albedo.diffuse,
            cosine_pattern(samples),
            DIFFUSE_LIFT,
            *self._turn,
            self._strength,
            surface,
            result,
        )
        return result

    def specular(self, surface: Surface, samples: int) -> Floats:
        """Radiance that the specular lobe returns, with nothing in the way.

        It is without the sun, except up to MIRROR_ROUGHNESS: there it is the map itself, sun
        included.

        Parameters
        ----------
        surface
            N points
        samples
            lookups per point, at least 1

        Returns
        -------
        (N, 3) float32
        """
        result = np.empty((surface.size, 3), np.float32)
        specular_light(
            self._table.sharp,
            self._table.soft,
            self._map,
            self._albedo.specular,
            visible_normal_pattern(samples),
            SPECULAR_LIFT,
            *self._turn,
            self._strength,
            surface,
            result,
        )
        return result

    def specular_albedo(self, surface: Surface) -> Floats:
        """Share (N, 3) float32 of constant light that the specular lobe returns."""
        return albedo.specular_albedo(surface)
