"""An environment as a light: its sun apart, the rest filtered."""

import math
import threading
import time
from dataclasses import dataclass, replace
from typing import Final, Literal, get_args

import numpy as np

from raysvc.lighting import albedo
from raysvc.lighting.area_resampling import resampled
from raysvc.lighting.brdf import MIRROR_ROUGHNESS
from raysvc.lighting.brushed_light import LOOKUPS_PER_ROUND_LOBE, brushed_lattice
from raysvc.lighting.brushed_light_kernels import brushed_light
from raysvc.lighting.brute_kernels import brute_diffuse, brute_specular
from raysvc.lighting.ggx_lobes import cosine_lobe, ggx_lobes
from raysvc.lighting.image_kernels import COSINE, diffuse_light, specular_light
from raysvc.lighting.lobe_fit import fitted_lobes, split_sum_lobes
from raysvc.lighting.lobe_levels import DEGREE, LobeFamily, LobeLevels
from raysvc.lighting.phong_kernels import cone_radiances, phong_radiances
from raysvc.lighting.phong_lobes import phong_lobes
from raysvc.lighting.soft_map import soft_map
from raysvc.lighting.soft_map_kernels import SoftMap
from raysvc.lighting.sphere_kernels import map_radiances
from raysvc.lighting.sphere_table import SphereTable, sphere_table
from raysvc.lighting.sun import SunLight, extract_suns
from raysvc.lighting.zonal import ZonalMap
from raysvc.parallel import Control, for_chunks
from raysvc.scene import Environment
from raysvc.shading.surface import Surface
from raysvc.types import Doubles, Floats, Ints

Method = Literal["sat", "sh9", "split_sum", "brute"]
METHODS: Final[tuple[Method, ...]] = get_args(Method)

BRUTE_LOOKUPS = 1024
"""Of a lobe by brute force."""


@dataclass(frozen=True, slots=True)
class Filtering:
    """How an environment is filtered."""

    method: Method = "sat"
    """`sat`: narrow lobes out of summed-area tables, the others out of levels; `sh9`: the same,
    but diffuse light from nine spherical harmonics; `split_sum`: one round lobe about R for a
    specular lobe, as prefiltered maps have it; `brute`: many points of the map per lobe."""
    order: int = 2
    """Of the tables, 1 to 3: box, tent, quadratic."""
    builder: str = "fused"
    """Of the tables, one of `sat_builders.BUILDERS`."""
    lookups: int = 4
    """Round lobes per specular lobe, one of `lobe_fit.LOOKUPS`."""


class ImageLight:
    """Light from an environment, turned and scaled. Safe to use from many threads; immutable but
    for what it keeps to answer with, which is the same whenever it is made.

    Parameters
    ----------
    environment
        what is far away
    yaw_deg
        turns it counter-clockwise seen from above
    strength
        scales all of its light
    filtering
        how lobes are looked up
    control
        threads on which it is made, one by default; the bits are the same with any number
    """

    def __init__(
        self,
        environment: Environment,
        yaw_deg: float = 0.0,
        strength: float = 1.0,
        filtering: Filtering | None = None,
        control: Control | None = None,
    ) -> None:
        start = time.perf_counter()
        yaw = math.radians(yaw_deg)
        self._turn = (math.cos(yaw), math.sin(yaw))
        self._strength = float(strength)
        self.filtering = filtering = filtering or Filtering()
        self._map = np.ascontiguousarray(environment.radiance)
        suns, self.rest = extract_suns(self._map)
        self._harmonics = ZonalMap.of(resampled(self.rest, 2 * DEGREE, 4 * DEGREE), DEGREE)
        self._phong: LobeLevels | None = None
        self._phong_lock = threading.Lock()
        self._tables_with_suns: Doubles | None = None
        self._with_suns_lock = threading.Lock()
        levels, table = self._filtered(control or Control(threads=1))
        self._narrow = (table.tables, filtering.order)
        self.lobes = (*self._narrow, *levels)
        self._cosine = int(levels.sides[COSINE]), int(levels.firsts[COSINE])
        if filtering.method == "sh9":
            nine = LobeFamily((cosine_lobe()[:3],), (ggx_lobes().sides[COSINE],))
            levels = LobeLevels.of(self._harmonics, nine)
            self._cosine = int(levels.sides[0]), 0
        self._diffuse = levels.texels
        self._albedo = albedo.albedo_tables()
        self.passes = table.passes
        """Of the builder over a table, in as many sums as the order says."""
        self.seconds = time.perf_counter() - start
        """What filtering took."""
        self.suns: tuple[SunLight, ...] = tuple(self._placed(sun) for sun in suns)
        """Small lights of the environment in the world; `diffuse` and `specular` are without."""

    def _filtered(self, control: Control) -> tuple[LobeLevels, SphereTable]:
        """Levels and tables, beside each other: each has parts that do not use several threads."""
        levels: list[LobeLevels] = []
        tables: list[SphereTable] = []

        def make(begin: int, _: int) -> None:
            if begin == 0:
                levels.append(LobeLevels.of(self._harmonics, ggx_lobes()))
            else:
                order, builder = self.filtering.order, self.filtering.builder
                tables.append(sphere_table(self.rest, order, builder))

        for_chunks(2, 1, make, control)
        return levels[0], tables[0]

    def _placed(self, sun: SunLight) -> SunLight:
        """Turn a sun out of the map's frame, and scale it."""
        red, green, blue = (v * self._strength for v in sun.irradiance)
        return replace(sun.turned(*self._turn), irradiance=(red, green, blue))

    def radiance(self, directions: Floats) -> Floats:
        """Radiance (N, 3) float32 of the map with its sun, along unit directions (N, 3) float32."""
        result = np.empty((len(directions), 3), np.float32)
        map_radiances(self._map, directions, *self._turn, self._strength, result)
        return result

    def make_phong(self) -> float:
        """Make the levels of Phong's lobes, which cones and brushed surfaces read.

        They are made when first asked for, by one thread while the others wait. Returns the seconds
        that it took, 0 where they are there.
        """
        with self._phong_lock:
            if self._phong is not None:
                return 0.0
            start = time.perf_counter()
            self._phong = LobeLevels.of(self._harmonics, phong_lobes())
            return time.perf_counter() - start

    def _power_lobes(self) -> tuple[Doubles, int, Floats, Ints, Ints]:
        """What narrow and wide powers of the cosine are read from."""
        self.make_phong()
        assert self._phong is not None
        return (*self._narrow, *self._phong)

    def phong(self, directions: Floats, exponent: float) -> Floats:
        """Mean radiance (N, 3) float32 of all but the suns under cos^exponent about directions.

        Directions are (N, 3) float32 unit; an exponent is at least 1, for which this is the
        irradiance over pi.
        """
        result = np.empty((len(directions), 3), np.float32)
        phong_radiances(
            *self._power_lobes(),
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
            *self._power_lobes(),
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
        if self.filtering.method == "brute":
            brute_diffuse(
                self.rest,
                BRUTE_LOOKUPS,
                self._albedo.diffuse,
                *self._turn,
                self._strength,
                surface,
                result,
            )
            return result
        diffuse_light(
            self._diffuse,
            *self._cosine,
            self._albedo.diffuse,
            *self._turn,
            self._strength,
            surface,
            result,
        )
        return result

    def specular(self, surface: Surface, lookups: int | None = None) -> Floats:
        """Radiance that the specular lobe returns, with nothing in the way.

        It is without the suns, except up to MIRROR_ROUGHNESS: there it is the map itself, suns
        included. Lobes are averaged over what pixels see mirrored (`Surface.mirrored`).

        Parameters
        ----------
        surface
            N points
        lookups
            round lobes per point, one of `lobe_fit.LOOKUPS`, instead of those of the filtering

        Returns
        -------
        (N, 3) float32
        """
        result = np.empty((surface.size, 3), np.float32)
        if self.filtering.method == "brute":
            self._brute_specular(surface, result)
            return result
        specular_light(
            *self.lobes,
            self._map,
            self._albedo.specular,
            self._fits(lookups),
            self._tables_for_mirrors(surface),
            *self._turn,
            self._strength,
            surface,
            result,
        )
        if surface.brushed.size:
            brushed_light(
                *self._power_lobes(),
                self._albedo.specular,
                brushed_lattice(LOOKUPS_PER_ROUND_LOBE * (lookups or self.filtering.lookups)),
                *self._turn,
                self._strength,
                surface,
                result,
            )
        return result

    def _tables_for_mirrors(self, surface: Surface) -> Doubles:
        """Tables of the map with its suns, if mirrors read them; else others of their kind."""
        texel_sr = 4.0 * math.pi / (self._map.shape[0] * self._map.shape[1])
        wide = surface.mirrored.pixel_sr > texel_sr
        if wide.any() and (wide & (surface.roughness <= MIRROR_ROUGHNESS)).any():
            return self._with_suns()
        return self._narrow[0]

    def _with_suns(self) -> Doubles:
        """Made when first asked for, by one thread while the others wait: few mirrors need it."""
        with self._with_suns_lock:
            if self._tables_with_suns is None:
                self._tables_with_suns = sphere_table(self._map, 1, self.filtering.builder).tables
            return self._tables_with_suns

    def _fits(self, lookups: int | None) -> Floats:
        if self.filtering.method == "split_sum":
            return split_sum_lobes()
        return fitted_lobes(lookups or self.filtering.lookups)

    def _brute_specular(self, surface: Surface, result: Floats) -> None:
        """Write the specular lobe's radiance, a mirror's from the map itself."""
        rough = surface.roughness > MIRROR_ROUGHNESS
        for chosen, map_, lookups in ((rough, self.rest, BRUTE_LOOKUPS), (~rough, self._map, 1)):
            index = np.flatnonzero(chosen)
            part = np.empty((len(index), 3), np.float32)
            brute_specular(
                map_,
                lookups,
                self._albedo.specular,
                *self._turn,
                self._strength,
                surface.chosen(index),
                part,
            )
            result[index] = part

    def specular_albedo(self, surface: Surface) -> Floats:
        """Share (N, 3) float32 of constant light that the specular lobe returns."""
        return albedo.specular_albedo(surface)
