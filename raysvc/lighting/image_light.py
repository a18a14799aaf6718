"""An environment as a light: its sun apart, the rest filtered."""

import math
from dataclasses import replace
from functools import cached_property

import numpy as np

from raysvc.lighting import albedo
from raysvc.lighting.ggx_lobes import COSINE, ggx_lobes
from raysvc.lighting.image_kernels import diffuse_light, specular_light
from raysvc.lighting.lobe_fit import fitted_lobes
from raysvc.lighting.lobe_levels import DEGREE, LobeLevels
from raysvc.lighting.phong_kernels import cone_radiances, phong_radiances
from raysvc.lighting.phong_lobes import phong_lobes
from raysvc.lighting.soft_map import soft_map
from raysvc.lighting.soft_map_kernels import SoftMap
from raysvc.lighting.sphere_kernels import map_radiances
from raysvc.lighting.sphere_table import sphere_table
from raysvc.lighting.sun import SunLight, extract_suns
from raysvc.lighting.zonal import ZonalMap, resampled
from raysvc.scene import Environment
from raysvc.shading.surface import Surface
from raysvc.types import Floats


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
        suns, self.rest = extract_suns(self._map)
        self._harmonics = ZonalMap.of(resampled(self.rest, 2 * DEGREE), DEGREE)
        levels = LobeLevels.of(self._harmonics, ggx_lobes())
        self._sharp = sphere_table(self.rest)
        self.lobes = (self._sharp, *levels)
        self._cosine = int(levels.sides[COSINE]), int(levels.firsts[COSINE])
        self._albedo = albedo.albedo_tables()
        self.suns: tuple[SunLight, ...] = tuple(self._placed(sun) for sun in suns)
        """Small lights of the environment in the world; `diffuse` and `specular` are without."""

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

    @cached_property
    def _phong(self) -> LobeLevels:
        """Made when first asked for: surfaces have no need of it."""
        return LobeLevels.of(self._harmonics, phong_lobes())

    def phong(self, directions: Floats, exponent: float) -> Floats:
        """Mean radiance (N, 3) float32 of all but the suns under cos^exponent about directions.

        Directions are (N, 3) float32 unit; an exponent is at least 1, for which this is the
        irradiance over pi.
        """
        result = np.empty((len(directions), 3), np.float32)
        phong_radiances(
            self._sharp,
            *self._phong,
            directions,
            float(exponent),
            *self._turn,
            self._strength,
            result,
        )
        return result

    def cone(self, directions: Floats, half_width: Floats) -> Floats:
        """Mean radiance (N, 3) float32 of cones about unit directions (N, 3).

        half_width (N,) float32 radians; up to the mirror's it is the map, sun included, beyond it
        is without the sun.
        """
        result = np.empty((len(directions), 3), np.float32)
        cone_radiances(
            self._sharp,
            *self._phong,
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
        return soft_map(self._harmonics, solid_angle, self._turn, self._strength)

    def diffuse(self, surface: Surface) -> Floats:
        """Radiance that the diffuse lobe returns of all but the suns, with nothing in the way.

        Parameters
        ----------
        surface
            N points

        Returns
        -------
        (N, 3) float32
        """
        result = np.empty((surface.size, 3), np.float32)
        diffuse_light(
            self.lobes[1],
            *self._cosine,
            self._albedo.diffuse,
            *self._turn,
            self._strength,
            surface,
            result,
        )
        return result

    def specular(self, surface: Surface, samples: int) -> Floats:
        """Radiance that the specular lobe returns, with nothing in the way.

        It is without the suns, except up to MIRROR_ROUGHNESS: there it is the map itself, suns
        included.

        Parameters
        ----------
        surface
            N points
        samples
            lookups per point, one of `lobe_fit.LOOKUPS`

        Returns
        -------
        (N, 3) float32
        """
        result = np.empty((surface.size, 3), np.float32)
        specular_light(
            *self.lobes,
            self._map,
            self._albedo.specular,
            fitted_lobes(samples),
            *self._turn,
            self._strength,
            surface,
            result,
        )
        return result

    def specular_albedo(self, surface: Surface) -> Floats:
        """Share (N, 3) float32 of constant light that the specular lobe returns."""
        return albedo.specular_albedo(surface)
