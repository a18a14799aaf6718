"""Light that comes straight from lights: punctual ones, whose shadows are hard, and areas.

What part of an area arrives, rays to places all over it say. A picture's points share theirs with
their neighbours (`raysvc.frame.shadows`); the others, such as those that a mirror shows, take as
many as they need alone.
"""

import numpy as np

from raysvc.accel.base import Rays
from raysvc.frame.prepared import Prepared
from raysvc.frame.statistics import Ledger
from raysvc.lighting.area_light import AreaLight, SunDisc
from raysvc.lighting.clearcoat import Varnish
from raysvc.lighting.direct import arriving, reflected
from raysvc.scene import PunctualLight
from raysvc.shading.surface import Surface
from raysvc.tracing.reflection import rays_towards
from raysvc.tracing.tile_pattern import tile_points
from raysvc.types import Bools, Doubles, Floats, Longs

ALONE = 16
"""Rays to an area from a point without neighbours, where those to its rim disagree."""
SHORT_OF_LIGHT = np.float32(0.9999)
"""Part of the way to a light that a ray goes, so that it does not meet the light itself."""


def unshadowed(light: AreaLight, surface: Surface) -> Floats:
    """(N, 3) radiance that points and their varnish return of a light with nothing in its way."""
    radiance = light.unshadowed(surface)
    varnish = Varnish.of(surface)
    varnish.laid_over(radiance, light.unshadowed(varnish.surface))
    return radiance


class DirectLight:
    """The lights of a frame; its methods take chunks and may run on many threads."""

    def __init__(self, prepared: Prepared, shadows: bool, seed: int, ledger: Ledger) -> None:
        """Without `shadows` nothing is in the way of any light."""
        self._world, self._shadows, self._ledger = prepared.world, shadows, ledger
        self._samples: Doubles = tile_points(seed)
        self._punctual: tuple[PunctualLight, ...] = prepared.scene.lights
        discs = [SunDisc(sun) for sun in prepared.light.suns]
        self.areas: tuple[AreaLight, ...] = (*discs, *prepared.lamps.lights)

    def of(self, surface: Surface) -> Floats:
        """(N, 3) radiance that points without neighbours return."""
        total = self.punctual(surface)
        for light in self.areas:
            radiance = unshadowed(light, surface)
            lit = np.flatnonzero(radiance.any(axis=1))
            radiance[lit] *= self.alone(light, surface, lit)[:, None]
            total += radiance
        return total

    def roughly(self, surface: Surface) -> Floats:
        """(N, 3) radiance that points return if only their mean counts: one ray for each light.

        Those next to each other send it to different places.
        """
        total = self.punctual(surface)
        samples = self._samples[np.arange(surface.size) % ALONE]
        for light in self.areas:
            radiance = unshadowed(light, surface)
            lit = np.flatnonzero(radiance.any(axis=1))
            radiance[lit] *= self.part(light, surface, lit, samples[lit])[:, None]
            total += radiance
        return total

    def punctual(self, surface: Surface) -> Floats:
        """(N, 3) radiance that points return of the punctual lights."""
        total = np.zeros((surface.size, 3), np.float32)
        varnish = Varnish.of(surface)
        coat, point = varnish.surface, varnish.point
        for light in self._punctual:
            to_light, distance, irradiance = arriving(light, surface.position)
            radiance = reflected(surface, to_light, irradiance, 0.0)
            varnish.laid_over(radiance, reflected(coat, to_light[point], irradiance[point], 0.0))
            lit = np.flatnonzero(radiance.any(axis=1))
            radiance[lit] *= self._through(surface, to_light[lit], distance[lit], lit)[:, None]
            total += radiance
        return total

    def alone(self, light: AreaLight, surface: Surface, point: Longs) -> Floats:
        """(M,) part of an area's light that arrives at points (M,), by the same rays everywhere."""

        def mean(some: Longs, samples: Doubles) -> tuple[Floats, Bools]:
            parts = [
                self.part(light, surface, some, np.broadcast_to(sample, (len(some), 2)))
                for sample in samples
            ]
            return np.mean(parts, axis=0, dtype=np.float32), np.ptp(parts, axis=0) > 0.0

        part, torn = mean(point, light.rim)
        part[torn], _ = mean(point[torn], self._samples[:ALONE])
        return part

    def part(self, light: AreaLight, surface: Surface, point: Longs, samples: Doubles) -> Floats:
        """(M,) part of an area's light that one ray from each of the points (M,) says arrives.

        Samples (M, 2) in 0..1 say to which place of the light it goes.
        """
        if not self._shadows:
            return np.ones(len(point), np.float32)
        rays = light.rays(surface, point, samples)
        # Nothing arrives from below the triangle.
        facing = surface.geometric_normal[point]
        up = np.flatnonzero(np.einsum("mk,mk->m", facing, rays.directions) > 0.0)
        if len(up) == len(point):
            return self._through(surface, rays.directions, rays.distance, point)
        part = np.zeros(len(point), np.float32)
        part[up] = self._through(surface, rays.directions[up], rays.distance[up], point[up])
        return part

    def _through(
        self, surface: Surface, to_light: Floats, distance: Floats, index: Longs
    ) -> Floats:
        """(M,) part of the light that nothing keeps from points `index` (M,)."""
        if not self._shadows:
            return np.ones(len(index), np.float32)
        rays = rays_towards(surface, to_light, distance, index)
        rays = Rays(rays.origins, rays.directions, rays.t_max * SHORT_OF_LIGHT)
        self._ledger.count("shadow", len(index))
        return self._world.transmittance(rays)
