"""Light along random paths (Kajiya 1986, "The Rendering Equation"), a wave of paths at a time.

At each point that a path reaches, light is looked for in three ways: drawn from the environment,
drawn from triangles that shine, and from every punctual light. Then the path goes on in a direction
drawn from the BRDF, and what it meets, the environment or something that shines, is light too.
Light found in two ways is weighted (`weight_kernels`), so that together they count it once.

All arithmetic on paths is kernels over the arrays of one wave; rays are answered by the wave.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from raysvc.accel.base import Hits, Rays
from raysvc.lighting.direct import arriving
from raysvc.lighting.rescattering import with_rescattering
from raysvc.parallel import Control
from raysvc.reference.choices import choices_of
from raysvc.reference.emitters import Emitters, emission_of
from raysvc.reference.environment import EnvironmentLight
from raysvc.reference.lights import LightSamples
from raysvc.reference.scattering_kernels import reflect_samples, scatter
from raysvc.reference.sequence_kernels import pairs
from raysvc.reference.weight_kernels import mis_weights
from raysvc.scene import PunctualLight
from raysvc.shading.scene_tables import SceneTables
from raysvc.shading.surface import Surface
from raysvc.tracing.reflection import rays_from, rays_towards
from raysvc.tracing.world import World
from raysvc.types import Bools, Doubles, Floats, Longs, Words

IN_PIXEL, ON_LENS, COVERAGE = range(3)
"""Dimensions of random numbers that a camera ray takes."""
DIRECTION, CHOICE, SKY, EMITTER, ON_EMITTER = range(3, 8)
"""Those of the first point of a path. CHOICE is the lobe, and whether the ray that goes on stops at
what covers only a part of what is behind it."""
PER_POINT: Final = 5
"""Those of the next point come after so many."""


@dataclass(frozen=True, slots=True, eq=False)
class Draws:
    """Random numbers of N paths, each with its pixel's key (N,) and its sample's number (N,)."""

    key: Words
    index: Words

    def pairs(self, dimension: int) -> Doubles:
        """(N, 2) in 0..1."""
        points = np.empty((len(self.key), 2))
        pairs(self.key, dimension, self.index, points)
        return points

    def chosen(self, index: Longs | Bools) -> "Draws":
        """Return those of some paths."""
        return Draws(self.key[index], self.index[index])


@dataclass(frozen=True, slots=True, eq=False)
class Lights:
    """Everything that a scene is lit by."""

    environment: EnvironmentLight
    emitters: Emitters
    punctual: Sequence[PunctualLight]


@dataclass(frozen=True, slots=True, eq=False)
class Wave:
    """N paths on their way, each at a ray.

    Attributes
    ----------
    path
        (N,) number of the camera ray that a path began with
    draws
        random numbers
    throughput
        (N, 3) float32: what part of the light that comes along its ray the pixel sees
    density
        (N,) float64 per steradian with which the ray was drawn; inf of a camera ray
    rays, hits
        (N) rays and what they have met
    absorption
        (N, 3) float32 per metre along the ray; no rows in a scene without glass
    """

    path: Longs
    draws: Draws
    throughput: Floats
    density: Doubles
    rays: Rays
    hits: Hits
    absorption: Floats

    def chosen(self, index: Longs | Bools) -> "Wave":
        """Return some of the paths."""
        rays, hits = self.rays, self.hits
        return Wave(
            self.path[index],
            self.draws.chosen(index),
            self.throughput[index],
            self.density[index],
            Rays(rays.origins[index], rays.directions[index], rays.t_max[index]),
            Hits(hits.t[index], hits.triangle[index], hits.barycentric[index]),
            self.absorption[index] if len(self.absorption) else self.absorption,
        )


class PathTracer:
    """Follows paths through a scene. Immutable; safe to use from many threads."""

    def __init__(
        self,
        world: World,
        tables: SceneTables,
        lights: Lights,
        bounces: int,
        count: Callable[[str, int], None],
        *,
        rescatters: bool = False,
    ) -> None:
        """Take what paths meet.

        `bounces`: how often a path goes on from a point that it has lit. `count` is told how many
        rays of a kind were traced. `rescatters`: specular lobes are compensated
        (`lighting.rescattering`).
        """
        self._world, self._tables, self._lights = world, tables, lights
        self._bounces, self._count, self._rescatters = bounces, count, rescatters

    def trace(self, rays: Rays, draws: Draws, control: Control) -> tuple[Floats, Bools]:
        """Follow one path from each of N camera rays.

        Returns radiance (N, 3) float32, and whether (N,) anything was met: what is behind the scene
        is left out. Raises Cancelled, DeadlineExceeded.
        """
        count = len(rays)
        radiance = np.zeros((count, 3), np.float32)
        self._count("primary", count)
        hits = self._world.drawn(rays, draws.pairs(COVERAGE)[:, 0], from_camera=True)
        met: Bools = hits.triangle >= 0
        wave = Wave(
            np.arange(count),
            draws,
            np.ones((count, 3), np.float32),
            np.full(count, np.inf),
            rays,
            hits,
            np.zeros((count if self._tables.glassy else 0, 3), np.float32),
        ).chosen(met)
        for point in range(self._bounces + 1):
            if not len(wave.path):
                break
            control.check()
            surface = self._surface(wave)
            wave = attenuated(wave, surface)
            radiance[wave.path] += self._shining(wave, surface)
            if surface.unlit.any():
                lit = np.flatnonzero(~surface.unlit)
                wave, surface = wave.chosen(lit), surface.chosen(lit)
            first, choice = point * PER_POINT, choices_of(surface)
            radiance[wave.path] += self._direct(wave, surface, choice, first)
            wave = self._onward(wave, surface, choice, first)
            missed = np.flatnonzero(wave.hits.triangle < 0)
            radiance[wave.path[missed]] += self._sky(wave.chosen(missed))
            wave = wave.chosen(wave.hits.triangle >= 0)
        shines = np.flatnonzero(self._lights.emitters.shines[wave.hits.triangle])
        wave = wave.chosen(shines)
        surface = self._surface(wave)
        radiance[wave.path] += self._shining(attenuated(wave, surface), surface)
        return radiance, met

    def _surface(self, wave: Wave) -> Surface:
        """What the paths have met; textures at their finest, for samples filter them."""
        hits = wave.hits
        surface = self._tables.surface(hits.triangle, hits.barycentric, wave.rays.directions)
        return with_rescattering(surface) if self._rescatters else surface

    def _shining(self, wave: Wave, surface: Surface) -> Floats:
        """(N, 3) light that the surfaces themselves give off."""
        other = self._lights.emitters.density(wave.hits.triangle, surface, wave.hits.t)
        emission = emission_of(surface) * _weights(wave.density, other)[:, None]
        shown: Floats = np.where(surface.unlit[:, None], surface.base_colour, emission)
        return wave.throughput * shown

    def _sky(self, wave: Wave) -> Floats:
        """(N, 3) light from the environment, for paths that have met nothing."""
        radiance, other = self._lights.environment.look_up(wave.rays.directions)
        far = np.full(len(radiance), np.inf, np.float32)
        radiance *= left_after(wave.absorption, far)
        return wave.throughput * radiance * _weights(wave.density, other)[:, None]

    def _direct(self, wave: Wave, surface: Surface, choice: Doubles, first: int) -> Floats:
        """(N, 3) light that comes to the points straight from where there is some."""
        draws, lights, position = wave.draws, self._lights, surface.position
        total = np.zeros((surface.size, 3), np.float32)
        if not lights.environment.is_dark:
            samples = lights.environment.sample(draws.pairs(first + SKY))
            total += self._arriving(wave, surface, choice, samples)
        if not lights.emitters.is_dark:
            pick, place = draws.pairs(first + EMITTER)[:, 0], draws.pairs(first + ON_EMITTER)
            samples = lights.emitters.sample(position, pick, place)
            total += self._arriving(wave, surface, choice, samples)
        for light in lights.punctual:
            alone = np.full(surface.size, np.inf)
            to_light, distance, irradiance = arriving(light, position)
            samples = LightSamples(to_light, distance, irradiance, alone)
            total += self._arriving(wave, surface, choice, samples)
        return total

    def _arriving(
        self, wave: Wave, surface: Surface, choice: Doubles, samples: LightSamples
    ) -> Floats:
        """(N, 3) what pixels see of light samples, as far as nothing is in their way."""
        contribution = np.empty((surface.size, 3), np.float32)
        reflect_samples(
            surface,
            choice,
            samples.to_light,
            samples.radiance,
            samples.density,
            wave.throughput,
            contribution,
        )
        lit = np.flatnonzero(contribution.any(axis=1))
        rays = rays_towards(surface, samples.to_light[lit], samples.distance[lit], lit)
        self._count("shadow", len(lit))
        absorption = absorption_ahead(wave, surface, samples.to_light, lit)
        left = left_after(absorption, samples.distance[lit])
        through = self._world.transmittance(rays, through_glass=False)
        contribution[lit] *= through[:, None] * left
        return contribution

    def _onward(self, wave: Wave, surface: Surface, choice: Doubles, first: int) -> Wave:
        """Send paths on from the points, and find what they meet; those that end are left out."""
        numbers = wave.draws.pairs(first + CHOICE)
        directions = np.empty((surface.size, 3), np.float32)
        throughput, density = wave.throughput.copy(), np.empty(surface.size)
        scatter(
            surface,
            choice,
            wave.draws.pairs(first + DIRECTION),
            numbers[:, 0],
            directions,
            throughput,
            density,
        )
        goes_on = np.flatnonzero(throughput.any(axis=1))
        far = np.full(len(goes_on), np.inf, np.float32)
        rays = rays_from(surface, directions[goes_on], far, goes_on)
        self._count("path", len(goes_on))
        return Wave(
            wave.path[goes_on],
            wave.draws.chosen(goes_on),
            throughput[goes_on],
            density[goes_on],
            rays,
            self._world.drawn(rays, numbers[goes_on, 1]),
            absorption_ahead(wave, surface, directions, goes_on),
        )


def attenuated(wave: Wave, surface: Surface) -> Wave:
    """Absorb what the glass between a path's last point and this one absorbs."""
    if not surface.glass.size:
        return wave
    inside = surface.glass.solid & ~surface.glass.entering & (surface.transmission > 0.0)
    absorption = np.where(inside[:, None], surface.glass.absorption, wave.absorption)
    throughput = wave.throughput * left_after(absorption, wave.hits.t)
    return replace(wave, throughput=throughput, absorption=absorption)


def absorption_ahead(wave: Wave, surface: Surface, directions: Floats, index: Longs) -> Floats:
    """(K, 3) per metre where paths `index` (K,) go from their points in `directions` (N, 3)."""
    if not surface.glass.size:
        return wave.absorption
    behind = np.einsum("kc,kc->k", surface.geometric_normal[index], directions[index]) < 0.0
    into = behind & surface.glass.solid[index] & surface.glass.entering[index]
    ahead = np.where(into[:, None], surface.glass.absorption[index], np.float32(0.0))
    return np.where(behind[:, None], ahead, wave.absorption[index])


def left_after(absorption: Floats, distance: Floats) -> Floats | np.float32:
    """What is left (N, 3) of light after (N,) metres of glass; 1 in a scene without."""
    if not len(absorption):
        return np.float32(1.0)
    some = absorption > 0.0
    depth = absorption * np.where(some, distance[:, None], np.float32(0.0))
    left: Floats = np.exp(-depth)
    return left


def _weights(own: Doubles, other: Doubles) -> Floats:
    """(N,) float32 of light that was found with density `own` and might have been with `other`."""
    weight = np.empty(len(own), np.float32)
    mis_weights(own, other, weight)
    return weight
