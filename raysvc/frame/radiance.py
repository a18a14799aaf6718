"""Light that points return of what lights them from outside the scene.

emission + sun and punctual lights, shadowed
         + the environment's diffuse lobe, occluded
         + the environment's specular lobe, as far as the scene does not stand before it: that is
           for `raysvc.frame.reflections` to say

All of it is darkened where there is varnish, which adds the lights and the environment through its
own lobe.
"""

from typing import NamedTuple

import numpy as np

from raysvc.frame.prepared import Prepared
from raysvc.frame.settings import Settings
from raysvc.frame.statistics import Ledger
from raysvc.lighting.boundary_albedo import boundary_albedo
from raysvc.lighting.clearcoat import Varnish
from raysvc.lighting.direct import arriving, reflected
from raysvc.lighting.sun import SunLight
from raysvc.scene import PunctualLight
from raysvc.shading.footprint import Footprint
from raysvc.shading.surface import Surface
from raysvc.tracing.occlusion import pattern, visibility
from raysvc.tracing.reflection import rays_from
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
    visible: Floats
    """(N,) part of the hemisphere that is free."""
    radiance: Floats
    """(N, 3) emission, lights, the environment's diffuse lobe, and varnish."""
    lobe: Floats
    """(N, 3) the environment through the specular lobe, with nothing but varnish in the way."""
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
        sun = prepared.light.sun
        self._lights: list[SunLight | PunctualLight] = [
            *([sun] if sun is not None else []),
            *prepared.scene.lights,
        ]

    def direct(self, surface: Surface) -> Floats:
        """(N, 3) radiance from the sun and punctual lights."""
        total = np.zeros((surface.size, 3), np.float32)
        varnish = Varnish.of(surface)
        coat, point = varnish.surface, varnish.point
        for light in self._lights:
            to_light, distance, irradiance = arriving(light, surface.position)
            radius_rad = light.angular_radius_rad if isinstance(light, SunLight) else 0.0
            radiance = reflected(surface, to_light, irradiance, radius_rad)
            varnish.laid_over(
                radiance, reflected(coat, to_light[point], irradiance[point], radius_rad)
            )
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

    def lit(self, surface: Surface, footprint: Footprint, direct: Floats, visible: Floats) -> Lit:
        """Put together what lights N points: `direct` (N, 3), `visible` (N,) of the environment."""
        light, samples = self._prepared.light, self._settings.ibl_lobe_samples
        visible = visible * surface.occlusion
        diffuse = light.diffuse(surface, samples)
        radiance = surface.emissive + diffuse * interreflected(visible, surface.base_colour)
        albedo = light.specular_albedo(surface)
        lobe = self._specular_lobe(surface, albedo)
        varnish = Varnish.of(surface)
        coat = self.coat_lobe(varnish)
        gloss = glossiness(varnish.surface.roughness)
        free = specular_occlusion(varnish.surface, visible[varnish.point])
        coat *= (gloss + (1.0 - gloss) * free)[:, None]
        varnish.laid_over(radiance, coat)
        varnish.laid_over(lobe, np.zeros_like(coat))
        varnish.laid_over(albedo, np.zeros_like(coat))
        radiance += direct
        inside = insides(surface)
        if len(inside):
            # Nothing of the environment is inside a solid, and there light may be reflected whole.
            lobe[inside] = 0.0
            albedo[inside] = boundary_albedo(surface.chosen(inside))[0]
        return Lit(surface, footprint, visible, radiance, lobe, albedo)

    def lit_in_mirror(self, surface: Surface, footprint: Footprint) -> Lit:
        """Light N points that a reflection shows."""
        tile = np.zeros(surface.size, np.int32)
        return self.lit(
            surface, footprint, self.direct(surface), self.occlusion(surface, tile, MIRRORED)
        )

    def coat_lobe(self, varnish: Varnish) -> Floats:
        """(K, 3) the environment through the lobe of K coats, with nothing in the way."""
        return self._specular_lobe(varnish.surface, varnish.share)

    def _specular_lobe(self, surface: Surface, albedo: Floats) -> Floats:
        """(N, 3) the environment through the specular lobe, by one lookup where that is faint."""
        light, samples = self._prepared.light, self._settings.ibl_lobe_samples
        lobe = np.empty((surface.size, 3), np.float32)
        faint = albedo.max(axis=1) < FAINT
        for chosen, lookups in ((faint, 1), (~faint, samples)):
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


def specular_occlusion(surface: Surface, visible: Floats) -> Floats:
    """(N,) part of the specular lobe that is free where `visible` (N,) of the hemisphere is.

    Lagarde and de Rousiers 2014, "Moving Frostbite to PBR", section 4.10.2.
    """
    cosine = np.einsum("nk,nk->n", surface.normal, surface.to_viewer)
    power = np.exp2(-16.0 * surface.roughness - 1.0)
    free: Floats = np.power(np.maximum(cosine + visible, 0.0), power) - 1.0 + visible
    return np.clip(free, 0.0, 1.0)


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
