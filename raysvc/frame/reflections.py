"""What points mirror of the scene.

A ray leaves every shiny point, and what it meets is lit and may mirror in turn, as often as the
settings' `bounces` say. Where the ray meets nothing, the environment's specular lobe is seen whole.
Rough surfaces are no mirrors: from a picture's points a ray goes into the lobe, another one from
each pixel of a tile, and `raysvc.tracing.gloss` takes the mean over neighbours. Beyond, and where
there are no neighbours, it is the mirror's ray, and the lobe only widens the footprint.

Nothing is left to chance: a ray is not followed where it can add less than LEAST_THROUGHPUT of what
it brings.
"""

from typing import NamedTuple

import numpy as np

from raysvc import records
from raysvc.accel.base import Hits
from raysvc.frame.passes import ORGANISATIONS
from raysvc.frame.points import Seen
from raysvc.frame.prepared import Prepared
from raysvc.frame.radiance import Illumination, Lit, specular_occlusion
from raysvc.frame.settings import Settings
from raysvc.frame.statistics import Ledger
from raysvc.lighting.lobe_kernels import lobe_rays
from raysvc.lighting.sun import LUMINANCE
from raysvc.shading.surface import Surface
from raysvc.tracing.differentials import footprint_at, pixel_angle, reflected
from raysvc.tracing.reflection import mirror_rays, rays_from
from raysvc.types import Doubles, Floats, Ints, Longs

GLOSSY = 0.4
"""Roughness up to which rays alone say what a surface reflects of the scene."""
MATT = 0.75
"""Roughness from which they say nothing, and occlusion only darkens the environment's lobe."""
WIDENING = 0.29
"""Tangent of half the angle of the cone that stands for a lobe when what it shows is filtered, as
a part of the lobe's half width in radians."""
BLURRED = 0.25
"""Of a lobe's half width: by how much it widens the highlights that it shows (compare Jendersie and
Grosch 2019, "Microfacet Model Regularization for Robust Light Transport")."""
LEAST_THROUGHPUT = 1.0 / 256.0
"""Of a ray: what it brings changes a pixel by less than this part of it."""


class Reflection(NamedTuple):
    """What N points mirror of the scene."""

    radiance: Floats
    """(N, 3) that arrives through the specular lobe from what is met."""
    share: Floats
    """(N,) part of the lobe in which something is met; the rest is the environment's."""
    weight: Floats
    """(N,) how much the ray counts in the mean of the rays of its lobe; 1 for mirrors."""
    spread_px: Floats
    """(N,) half width of the lobe where the ray ends, in pixels; -1 where there was no ray."""
    triangle: Ints
    """(N,) what a mirror shows: the triangle, or -1. Rough surfaces show none."""
    distance: Floats
    """(N,) metres to it, inf where there is none."""
    normal: Floats
    """(N, 3) its shading normal, 0 where there is none."""

    @staticmethod
    def none(count: int) -> "Reflection":
        """Points that mirror nothing."""
        return Reflection(
            np.zeros((count, 3), np.float32),
            np.zeros(count, np.float32),
            np.ones(count, np.float32),
            np.full(count, -1.0, np.float32),
            np.full(count, -1, np.int32),
            np.full(count, np.inf, np.float32),
            np.zeros((count, 3), np.float32),
        )


class Reflections:
    """Follows rays from shiny points; its methods take chunks and may run on many threads."""

    def __init__(
        self,
        prepared: Prepared,
        settings: Settings,
        illumination: Illumination,
        ledger: Ledger,
    ) -> None:
        self._prepared, self._settings, self._ledger = prepared, settings, ledger
        self._illumination = illumination
        self._organise = ORGANISATIONS[settings.passes, settings.trees]

    def of(
        self,
        seen: Seen,
        albedo: Floats,
        samples: Doubles | None = None,
        throughput: Floats | None = None,
        bounce: int = 1,
    ) -> Reflection:
        """Follow one ray from each of N points that are shiny enough.

        Parameters
        ----------
        seen
            the points
        albedo
            (N, 3) of the specular lobe
        samples
            (N, 2) in 0..1: where in the lobe each ray goes; None for the mirror's ray
        throughput
            (N, 3) part of the points' light that reaches the picture; 1 by default
        bounce
            how many rays have led here, this one included
        """
        surface = seen.surface
        reflection = Reflection.none(surface.size)
        if bounce > self._settings.bounce_limit:
            return reflection
        gloss = glossiness(surface.roughness)
        passed = albedo * gloss[:, None]
        if throughput is not None:
            passed *= throughput
        shiny = np.flatnonzero((passed.max(axis=1) > LEAST_THROUGHPUT) & ~surface.unlit)
        mirror = surface.chosen(shiny)
        if samples is None:
            rays = mirror_rays(mirror)
            half_width = 2.0 * mirror.roughness**2
        else:
            directions = np.empty((len(shiny), 3), np.float32)
            weight, half_width = np.empty((2, len(shiny)), np.float32)
            lobe_rays(mirror, samples[shiny], directions, weight, half_width)
            reflection.weight[shiny] = weight * np.where(
                half_width > 0, (2.0 * mirror.roughness**2 / np.maximum(half_width, 1e-9)) ** 2, 1
            )
            rays = rays_from(mirror, directions, np.full(len(shiny), np.inf, np.float32))
        self._ledger.count("reflection", len(shiny))

        tables = self._prepared.tables
        differentials = reflected(
            tables.geometry,
            seen.triangle[shiny],
            mirror,
            rays.directions,
            records.chosen(seen.arriving, shiny),
            records.chosen(seen.footprint, shiny),
            WIDENING * half_width,
        )

        def shade(index: Longs, hits: Hits) -> Lit:
            directions = rays.directions[index]
            footprint = footprint_at(
                tables.geometry,
                hits.triangle,
                hits.t,
                directions,
                records.chosen(differentials, index),
            )
            met = tables.surface(
                hits.triangle,
                hits.barycentric,
                directions,
                footprint,
                self._settings.texture_filter,
            )
            # What is seen through a wide lobe is seen from many sides: its highlights widen.
            alpha2 = met.roughness**4 + (BLURRED * half_width[index]) ** 2
            met = met._replace(roughness=np.minimum(np.sqrt(np.sqrt(alpha2)), np.float32(1.0)))
            return self._illumination.lit_in_mirror(met, footprint)

        hits, met, lit = self._organise(
            self._prepared.world,
            rays,
            self._prepared.scene.material_of_triangle,
            shade,
            self._ledger,
        )
        from_ = shiny[met]
        met_in_turn = Seen(
            lit.surface, hits.triangle[met], lit.footprint, records.chosen(differentials, met)
        )
        deeper = self.of(met_in_turn, lit.albedo, None, passed[from_], bounce=bounce + 1)
        own = own_light(lit, deeper)
        energy = float(np.einsum("nk,nk,k->", passed[from_], own, LUMINANCE))
        self._ledger.bounce(bounce, len(shiny), energy)
        reflection.radiance[from_] = own + mirrored_light(lit, deeper)
        reflection.share[from_] = gloss[from_]
        reflection.spread_px[shiny] = half_width / np.maximum(
            pixel_angle(differentials, hits.t), np.float32(1e-9)
        )
        self._describe(reflection, shiny, hits, met, lit.surface)
        return reflection

    def _describe(
        self,
        reflection: Reflection,
        shiny: Longs,
        hits: Hits,
        met: Longs,
        seen: Surface,
    ) -> None:
        """Say what mirrors show."""
        sharp = np.flatnonzero(reflection.spread_px[shiny[met]] < 0.5)
        at = shiny[met[sharp]]
        reflection.triangle[at] = hits.triangle[met[sharp]]
        reflection.distance[at] = hits.t[met[sharp]]
        reflection.normal[at] = seen.normal[sharp]


def glossiness(roughness: Floats) -> Floats:
    """(N,) 1 for surfaces whose reflection rays alone tell, 0 for matt ones, smooth between."""
    x = np.clip((MATT - roughness) / (MATT - GLOSSY), 0.0, 1.0)
    smooth: Floats = (x * x * (3.0 - 2.0 * x)).astype(np.float32)
    return smooth


def own_light(lit: Lit, reflection: Reflection) -> Floats:
    """(N, 3) radiance of points without what they mirror of the scene.

    Where a glossy surface's ray met nothing it shows the environment whole; a matt one shows it as
    far as ambient occlusion lets it.
    """
    surface = lit.surface
    free = specular_occlusion(surface, lit.visible)
    gloss = glossiness(surface.roughness)
    open_ = np.maximum(gloss - reflection.share, 0.0) + (1.0 - gloss) * free
    radiance = lit.radiance + lit.lobe * open_[:, None]
    shown: Floats = np.where(surface.unlit[:, None], surface.base_colour, radiance)
    return shown


def mirrored_light(lit: Lit, reflection: Reflection) -> Floats:
    """(N, 3) radiance that points mirror of the scene; unlit ones mirror nothing."""
    radiance: Floats = lit.albedo * (reflection.radiance * reflection.share[:, None])
    return radiance


def leaving(lit: Lit, reflection: Reflection) -> Floats:
    """(N, 3) radiance that leaves points towards whoever looks at them."""
    return own_light(lit, reflection) + mirrored_light(lit, reflection)
