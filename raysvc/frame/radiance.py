"""Light that points return of what lights them from outside the scene.

emission + sun and punctual lights, shadowed
         + the environment's diffuse lobe, occluded, and what the occluders send instead
         + the environment's specular lobe, as far as the scene does not stand before it: that is
           for `raysvc.frame.reflections` to say

All of it is darkened where there is varnish, which adds the lights and the environment through its
own lobe.
"""

import copy
from typing import NamedTuple

import numpy as np

from raysvc.frame.direct_light import DirectLight
from raysvc.frame.prepared import Prepared
from raysvc.frame.radiosity import RAYS, radiosity
from raysvc.frame.settings import Settings
from raysvc.frame.statistics import Ledger
from raysvc.lighting.albedo import diffuse_albedo
from raysvc.lighting.ambient import Ambient, mean_of_rays
from raysvc.lighting.boundary_albedo import boundary_albedo
from raysvc.lighting.clearcoat import Varnish
from raysvc.lighting.image_light import ImageLight
from raysvc.lighting.soft_map import solid_angle_of_rays
from raysvc.parallel import Control
from raysvc.shading.footprint import Footprint
from raysvc.shading.surface import Surface
from raysvc.tracing.occlusion import occlusion_rays, pattern
from raysvc.types import Doubles, Floats, Ints, Longs

GLOSSY = 0.4
"""Roughness up to which rays alone say what a surface reflects of the scene."""
MATT = 0.75
"""Roughness from which they say nothing, and occlusion only darkens the environment's lobe."""
MIRRORED = slice(None, None, 4)
"""The part of the occlusion pattern that is enough for what is seen in a mirror."""
FAINT = 0.025
"""Specular albedo below which a lookup's error is a fraction of a percent of white."""


class Lit(NamedTuple):
    """N points with all light but what they mirror of the scene; linear Rec.709, float32."""

    surface: Surface
    footprint: Footprint
    sky: Floats
    """(N, 3) part of the environment's light that nothing hides, by colour."""
    radiance: Floats
    """(N, 3) emission, lights, the environment's diffuse lobe, and varnish."""
    lobe: Floats
    """(N, 3) the environment through the specular lobe, with nothing but varnish in the way."""
    bounced: Floats
    """(N, 3) radiance of what hides the environment, on the mean of all directions."""
    albedo: Floats
    """(N, 3) share of constant light that the specular lobe returns, through varnish."""


class Illumination:
    """Everything that lights a frame's points; its methods take chunks and may run on many
    threads."""

    def __init__(
        self,
        prepared: Prepared,
        settings: Settings,
        occlusion_radius_m: float,
        ledger: Ledger,
    ) -> None:
        self._prepared, self._settings, self._ledger = prepared, settings, ledger
        self._radius_m = occlusion_radius_m
        self._pattern: Doubles = pattern(settings.occlusion_samples, settings.seed)
        self._sent: Floats = np.zeros((0, 3), np.float32)
        angle = solid_angle_of_rays(settings.occlusion_samples)
        self._soft = prepared.light.softened(angle)
        self.direct = DirectLight(prepared, settings.shadows, settings.seed, ledger)

    def seeded(self, settings: Settings) -> "Illumination":
        """Return this illumination, as far as it has settled, with the seed of other settings."""
        other = copy.copy(self)
        other._pattern = pattern(settings.occlusion_samples, settings.seed)
        other.direct = DirectLight(self._prepared, settings.shadows, settings.seed, self._ledger)
        return other

    def settle(self, control: Control) -> None:
        """Find what light surfaces send to each other; `ambient` needs it."""
        patches = self._prepared.patches
        if patches is None:
            return
        self._ledger.count("occlusion", len(patches.triangle) * RAYS)
        self._sent = radiosity(
            patches,
            self._on_patch,
            self._prepared.world,
            self._soft,
            self.direct.roughly,
            self._prepared.lamps.shines,
            self._settings.seed,
            control,
        )

    def _on_patch(
        self, triangle: Ints, barycentric: Floats, directions: Floats, footprint: Footprint
    ) -> Surface:
        surface = self._prepared.tables.surface(triangle, barycentric, directions, footprint, "mip")
        return self._prepared.lobes_of(surface)

    def ambient(self, surface: Surface, tile: Ints, part: slice = slice(None)) -> Ambient:
        """What arrives from all around at N points; everything, without occlusion samples."""
        samples, patches = self._pattern[part], self._prepared.patches
        if patches is None:
            return Ambient.open(surface.size)
        rays = occlusion_rays(surface, tile, samples, self._radius_m)
        self._ledger.count("occlusion", len(rays))
        hits, through = self._prepared.world.hiding(rays)
        shape = surface.size, len(samples)
        return mean_of_rays(
            self._soft,
            rays.directions.reshape(*shape, 3),
            through.reshape(shape),
            patches.met(hits, rays.directions).reshape(shape),
            self._sent,
        )

    def lit(
        self,
        surface: Surface,
        footprint: Footprint,
        direct: Floats,
        ambient: Ambient,
        mirrored: bool = False,
    ) -> Lit:
        """Put together what lights N points: `direct` (N, 3), and what arrives from all around."""
        light = self._prepared.light
        sky, bounced = (a * surface.occlusion[:, None] for a in (ambient.sky, ambient.bounced))
        radiance = surface.emissive + light.diffuse(surface) * sky
        radiance += diffuse_albedo(surface) * bounced
        albedo = light.specular_albedo(surface)
        lobe = specular_lobe(light, surface, albedo, mirrored)
        varnish = Varnish.of(surface)
        coat = self.coat_lobe(varnish)
        gloss = glossiness(varnish.surface.roughness)[:, None]
        coat *= gloss + (1.0 - gloss) * sky[varnish.point]
        coat += bounced[varnish.point] * (1.0 - gloss)
        varnish.laid_over(radiance, coat)
        varnish.laid_over(lobe, np.zeros_like(coat))
        varnish.laid_over(albedo, np.zeros_like(coat))
        radiance += direct
        inside = insides(surface)
        if len(inside):
            # Nothing of the environment is inside a solid, and there light may be reflected whole.
            lobe[inside] = bounced[inside] = 0.0
            albedo[inside] = boundary_albedo(surface.chosen(inside))[0]
        return Lit(surface, footprint, sky, radiance, lobe, bounced, albedo)

    def lit_in_mirror(self, surface: Surface, footprint: Footprint) -> Lit:
        """Light N points that a reflection shows."""
        tile = np.zeros(surface.size, np.int32)
        return self.lit(
            surface, footprint, self.direct.of(surface), self.ambient(surface, tile, MIRRORED), True
        )

    def coat_lobe(self, varnish: Varnish) -> Floats:
        """(K, 3) the environment through the lobe of K coats, with nothing in the way."""
        return specular_lobe(self._prepared.light, varnish.surface, varnish.share)


def specular_lobe(
    light: ImageLight, surface: Surface, albedo: Floats, mirrored: bool = False
) -> Floats:
    """(N, 3) a light through the specular lobe, by one lookup where its albedo (N, 3) is faint.

    So are lobes of brushed points that a mirror shows, which many rays meet.
    """
    lobe = np.empty((surface.size, 3), np.float32)
    simple = albedo.max(axis=1) < FAINT
    if mirrored and surface.brushed.size:
        simple |= surface.brushed.strength > 0.0
    for chosen, lookups in ((simple, 1), (~simple, light.filtering.lookups)):
        index = np.flatnonzero(chosen)
        lobe[index] = light.specular(surface.chosen(index), lookups)
    return lobe


def insides(surface: Surface) -> Longs:
    """Which of the points are seen from inside of a solid of glass."""
    glass = surface.glass
    if not glass.size:
        return np.zeros(0, np.int64)
    return np.flatnonzero(glass.solid & ~glass.entering & (surface.transmission > 0))


def glossiness(roughness: Floats) -> Floats:
    """(N,) 1 for surfaces whose reflection rays alone tell, 0 for matt ones, smooth between."""
    x = np.clip((MATT - roughness) / (MATT - GLOSSY), 0.0, 1.0)
    smooth: Floats = (x * x * (3.0 - 2.0 * x)).astype(np.float32)
    return smooth
