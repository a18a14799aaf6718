"""Light that leaves points towards whoever looks at them.

emission + sun and punctual lights, shadowed
         + the environment's diffuse lobe, occluded
         + the specular lobe: what a mirror ray meets where the surface is glossy, else the
           environment
"""

from dataclasses import dataclass

import numpy as np

from raysvc.frame.prepared import Prepared
from raysvc.frame.settings import Settings
from raysvc.frame.statistics import Ledger
from raysvc.lighting.direct import arriving, reflected
from raysvc.lighting.sun import SunLight
from raysvc.scene import PunctualLight
from raysvc.shading.surface import Surface
from raysvc.tracing.occlusion import pattern, visibility
from raysvc.tracing.reflection import mirror_rays, rays_from
from raysvc.types import Doubles, Floats, Ints

GLOSSY = 0.4
"""Roughness up to which the mirror ray alone says what a surface reflects of the scene."""
MATT = 0.75
"""Roughness from which it says nothing, and occlusion only darkens the environment's lobe."""
MIRRORED = slice(None, None, 4)
"""The part of the occlusion pattern that is enough for what is seen in a mirror."""
FAINT = 0.025
"""Specular albedo below which a lookup's error is a fraction of a percent of white."""
LEAST_REFLECTION = 1.0 / 256.0
"""Reflections that can add less than this part of what they show are not traced."""


@dataclass(frozen=True, slots=True, eq=False)
class Reflection:
    """What mirror rays met: radiance (N, 3), and how much (N,) of the specular lobe it stands
    for."""

    radiance: Floats
    share: Floats


class Illumination:
    """Everything that lights a frame's points; its methods take chunks and may run on many
    threads."""

    def __init__(
        self,
        prepared: Prepared,
        settings: Settings,
        occlusion_radius_m: float,
        spread: float,
        ledger: Ledger,
    ) -> None:
        """`spread`: how fast a pixel's footprint widens along its ray, in metres per metre."""
        self._prepared, self._settings, self._ledger = prepared, settings, ledger
        self._radius_m, self._spread = occlusion_radius_m, spread
        self._pattern: Doubles = pattern(settings.occlusion_samples, settings.seed)
        sun = prepared.light.sun
        self._lights: list[SunLight | PunctualLight] = [
            *([sun] if sun is not None else []),
            *prepared.scene.lights,
        ]

    def direct(self, surface: Surface) -> Floats:
        """(N, 3) radiance from the sun and punctual lights."""
        total = np.zeros((surface.size, 3), np.float32)
        for light in self._lights:
            to_light, distance, irradiance = arriving(light, surface.position)
            radius_rad = light.angular_radius_rad if isinstance(light, SunLight) else 0.0
            radiance = reflected(surface, to_light, irradiance, radius_rad)
            if self._settings.shadows:
                lit = np.flatnonzero(np.einsum("nk->n", radiance))
                # A ray that starts off the surface must not pass a light that is near it.
                reach = distance[lit] * np.float32(0.9999)
                rays = rays_from(surface, to_light[lit], reach, lit)
                self._ledger.count("shadow", len(lit))
                radiance[lit] *= self._prepared.world.transmittance(rays)[:, None]
            total += radiance
        return total

    def occlusion(self, surface: Surface, tile: Ints, part: slice = slice(None)) -> Floats:
        """(N,) part of the hemisphere that is free near each point; 1 without occlusion samples."""
        samples = self._pattern[part]
        if not len(samples):
            return np.ones(surface.size, np.float32)
        self._ledger.count("occlusion", surface.size * len(samples))
        return visibility(self._prepared.world, surface, tile, samples, self._radius_m)

    def reflection(self, surface: Surface, footprint: Floats, bounces: int) -> Reflection:
        """What glossy points show of the scene by one mirror ray each, followed `bounces` times."""
        radiance = np.zeros((surface.size, 3), np.float32)
        share = np.zeros(surface.size, np.float32)
        if bounces == 0:
            return Reflection(radiance, share)
        gloss = glossiness(surface.roughness)
        strength = gloss * self._prepared.light.specular_albedo(surface).max(axis=1)
        shiny = np.flatnonzero((strength > LEAST_REFLECTION) & ~surface.unlit)
        mirror = surface.chosen(shiny)
        rays = mirror_rays(mirror)
        self._ledger.count("reflection", len(shiny))
        hits = self._prepared.world.nearest(rays)
        met = np.flatnonzero(hits.triangle >= 0)
        if not len(met):
            return Reflection(radiance, share)
        from_ = shiny[met]
        # The footprint grows with the distance, more where the mirror is rough and its lobe wide.
        widening = self._spread + mirror.roughness[met] ** 2
        seen_footprint = footprint[from_] + hits.t[met] * widening
        seen = self._prepared.tables.surface(
            hits.triangle[met],
            hits.barycentric[met],
            rays.directions[met],
            seen_footprint.astype(np.float32),
            self._settings.texture_filter,
        )
        radiance[from_] = self.leaving(seen, seen_footprint, bounces - 1)
        share[from_] = gloss[from_]
        return Reflection(radiance, share)

    def leaving(self, surface: Surface, footprint: Floats, bounces: int) -> Floats:
        """(N, 3) radiance that leaves points which a reflection shows."""
        tile = np.zeros(surface.size, np.int32)
        return self.combined(
            surface,
            self.direct(surface),
            self.occlusion(surface, tile, MIRRORED),
            self.reflection(surface, footprint, bounces),
        )

    def combined(
        self, surface: Surface, direct: Floats, visible: Floats, reflection: Reflection
    ) -> Floats:
        """(N, 3) radiance from its parts and the environment's lobes."""
        light, samples = self._prepared.light, self._settings.ibl_lobe_samples
        visible = visible * surface.occlusion
        total = surface.emissive + direct
        total += light.diffuse(surface, samples) * interreflected(visible, surface.base_colour)
        albedo = light.specular_albedo(surface)
        lobe = self._specular_lobe(surface, albedo)
        total += specular(surface, lobe, visible, reflection, albedo)
        shown: Floats = np.where(surface.unlit[:, None], surface.base_colour, total)
        return shown

    def _specular_lobe(self, surface: Surface, albedo: Floats) -> Floats:
        """(N, 3) the environment through the specular lobe, by one lookup where that is faint."""
        light, samples = self._prepared.light, self._settings.ibl_lobe_samples
        lobe = np.empty((surface.size, 3), np.float32)
        faint = albedo.max(axis=1) < FAINT
        for chosen, lookups in ((faint, 1), (~faint, samples)):
            index = np.flatnonzero(chosen)
            lobe[index] = light.specular(surface.chosen(index), lookups)
        return lobe


def glossiness(roughness: Floats) -> Floats:
    """(N,) 1 for surfaces whose reflection is that of a mirror ray, 0 for matt ones, smooth
    between."""
    x = np.clip((MATT - roughness) / (MATT - GLOSSY), 0.0, 1.0)
    smooth: Floats = (x * x * (3.0 - 2.0 * x)).astype(np.float32)
    return smooth


def specular(
    surface: Surface,
    environment: Floats,
    visible: Floats,
    reflection: Reflection,
    albedo: Floats,
) -> Floats:
    """(N, 3) radiance of the specular lobe.

    A glossy surface whose mirror ray met nothing shows the environment whole; a matt one shows it
    as far as ambient occlusion lets it (Lagarde and de Rousiers 2014, "Moving Frostbite to PBR",
    section 4.10.2).
    """
    cosine = np.einsum("nk,nk->n", surface.normal, surface.to_viewer)
    power = np.exp2(-16.0 * surface.roughness - 1.0)
    free = np.clip(np.power(np.maximum(cosine + visible, 0.0), power) - 1.0 + visible, 0.0, 1.0)
    gloss = glossiness(surface.roughness)
    open_ = np.maximum(gloss - reflection.share, 0.0) + (1.0 - gloss) * free
    traced = reflection.radiance * reflection.share[:, None]
    radiance: Floats = environment * open_[:, None] + albedo * traced
    return radiance


def interreflected(visible: Floats, albedo: Floats) -> Floats:
    """(N, 3) occlusion with the light that bounces back from the occluders, if they look like the
    surface.

    Jimenez et al. 2016, "Practical Real-Time Strategies for Accurate Indirect Occlusion", equation
    18.
    """
    open_ = visible[:, None]
    a = 2.0404 * albedo - 0.3324
    b = -4.7951 * albedo + 0.6417
    c = 2.7552 * albedo + 0.6903
    brighter: Floats = np.maximum(open_, ((open_ * a + b) * open_ + c) * open_)
    return brighter
