"""Rays from what the camera sees to what it shows of the rest: reflected, and let through.

A ray leaves every shiny point, and one goes through every point of glass; what they meet is lit
like everything else, and may mirror and let through in turn. `bounces` limits how often a path is
reflected, MAX_BOUNDARIES how much glass it goes through. Where a reflected ray meets nothing, the
environment's lobe is seen whole; one that is let through sees the environment behind.

Rough surfaces are no mirrors: from a picture's points a ray goes into the lobe, another one from
each pixel of a tile, and `raysvc.tracing.gloss` takes the mean over neighbours. Beyond, and where
there are no neighbours, it is the ray of the smooth surface, and the lobe only widens what it sees.

Nothing is left to chance: a ray is not followed where it can add less than LEAST_THROUGHPUT of what
it brings.
"""

import copy
from typing import Final, NamedTuple

import numpy as np

from raysvc import records
from raysvc.accel.base import Hits, Rays
from raysvc.frame.passes import ORGANISATIONS
from raysvc.frame.points import Seen
from raysvc.frame.prepared import Prepared
from raysvc.frame.probe_light import ProbeLight
from raysvc.frame.radiance import Illumination, Lit, glossiness, insides
from raysvc.frame.reflections import (
    Reflection,
    Transmission,
    mirrored_light,
    own_light,
    transmitted_light,
)
from raysvc.frame.settings import Settings
from raysvc.frame.statistics import Ledger
from raysvc.lighting.albedo import specular_albedo
from raysvc.lighting.boundary_albedo import boundary_albedo
from raysvc.lighting.brushed_light import round_roughness
from raysvc.lighting.clearcoat import Varnish
from raysvc.lighting.lamps import highlight
from raysvc.lighting.lobe_kernels import lobe_rays
from raysvc.lighting.sun import LUMINANCE
from raysvc.lighting.transmission_kernels import transmitted_rays
from raysvc.shading.surface import Surface
from raysvc.tracing import differentials as differential
from raysvc.tracing.ray_differentials import RayDifferentials
from raysvc.tracing.reflection import mirror_rays, rays_from
from raysvc.types import Doubles, Floats, Longs

WIDENING = 0.29
"""Tangent of half the angle of the cone that stands for a lobe when what it shows is filtered, as
a part of the lobe's half width in radians."""
BLURRED = 0.25
"""Of a lobe's half width: by how much it widens the highlights that it shows (compare Jendersie and
Grosch 2019, "Microfacet Model Regularization for Robust Light Transport")."""
LEAST_THROUGHPUT = 1.0 / 256.0
"""Of a ray: what it brings changes a pixel by less than this part of it."""
MAX_BOUNDARIES = 12
"""Surfaces of glass that one path goes through; behind the last one is nothing."""


class Depth(NamedTuple):
    """How far a path has come."""

    bounce: int = 1
    """Number of its next reflection."""
    boundary: int = 1
    """Number of the next surface of glass that it goes through."""


FROM_THE_CAMERA: Final = Depth()


class Followed(NamedTuple):
    """What R rays brought."""

    hits: Hits
    """Of all R."""
    met: Longs
    """(M,) numbers of the rays that met something."""
    surface: Surface
    """The M points that they met."""
    radiance: Floats
    """(M, 3) that arrives from there."""
    own: Floats
    """(M, 3) of it what comes by no further ray."""


class SecondaryRays:
    """Follows rays from points; its methods take chunks and may run on many threads."""

    def __init__(
        self,
        prepared: Prepared,
        settings: Settings,
        illumination: Illumination,
        ledger: Ledger,
        *,
        narrowest_rad: float = 0.0,
    ) -> None:
        """Through glass the environment is seen by cones of at least half a width of
        `narrowest_rad`: a little is enough for its sun not to be seen."""
        self._prepared, self._settings, self._ledger = prepared, settings, ledger
        self._illumination = illumination
        self._organise = ORGANISATIONS[settings.passes, settings.trees]
        self._narrowest_rad = np.float32(narrowest_rad)
        self._probe: ProbeLight | None = None

    def lit_by(self, illumination: Illumination) -> "SecondaryRays":
        """Return these rays, and the probe that they show, with points lit by another's seed."""
        other = copy.copy(self)
        other._illumination = illumination
        return other

    def show(self, probe: ProbeLight) -> None:
        """From now on let a captured probe tell what is reflected, and no rays."""
        self._probe = probe

    def reflected(
        self,
        seen: Seen,
        albedo: Floats,
        samples: Doubles | None = None,
        throughput: Floats | None = None,
        depth: Depth = FROM_THE_CAMERA,
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
        depth
            of the paths that have led here
        """
        surface = seen.surface
        if self._probe is not None:
            return self._shown_by(self._probe, surface)
        reflection = Reflection.none(surface.size)
        if depth.bounce > self._settings.bounce_limit:
            return reflection
        gloss = glossiness(round_roughness(surface))
        passed = albedo * gloss[:, None]
        if throughput is not None:
            passed *= throughput
        shiny = np.flatnonzero((passed.max(axis=1) > LEAST_THROUGHPUT) & ~surface.unlit)
        mirror = records.chosen(seen, shiny)
        if samples is None:
            rays = mirror_rays(mirror.surface)
            half_width = 2.0 * round_roughness(mirror.surface) ** 2
        else:
            directions = np.empty((len(shiny), 3), np.float32)
            weight, half_width = np.empty((2, len(shiny)), np.float32)
            lobe_rays(mirror.surface, samples[shiny], directions, weight, half_width)
            reflection.weight[shiny] = weight
            rays = rays_from(mirror.surface, directions, _endless(shiny))
        differentials = differential.reflected(
            self._prepared.tables.geometry,
            mirror.triangle,
            mirror.surface,
            rays.directions,
            mirror.arriving,
            mirror.footprint,
            WIDENING * half_width,
        )
        self._ledger.count("reflection", len(shiny))
        followed = self._follow(
            rays,
            differentials,
            half_width,
            # Rough surfaces have the highlights of lamps already.
            1.0 - highlight(round_roughness(mirror.surface)),
            passed[shiny],
            depth._replace(bounce=depth.bounce + 1),
        )
        from_ = shiny[followed.met]
        energy = float(np.einsum("nk,nk,k->", passed[from_], followed.own, LUMINANCE))
        self._ledger.bounce(depth.bounce, len(shiny), energy)
        reflection.radiance[from_] = followed.radiance
        reflection.share[from_] = gloss[from_]
        pixel = _pixels_per_radian(differentials, followed.hits.t)
        reflection.spread_px[shiny] = half_width * pixel
        reflection.lobe_px[shiny] = 2.0 * round_roughness(mirror.surface) ** 2 * pixel
        _show(reflection, shiny, followed)
        if surface.coat.size:
            self._reflect_in_varnish(seen, throughput, depth, reflection)
        return reflection

    def _shown_by(self, probe: ProbeLight, surface: Surface) -> Reflection:
        """What N points mirror of a probe: the part of their lobe of which else rays would tell."""
        reflection = Reflection.none(surface.size)
        gloss = glossiness(round_roughness(surface))
        shiny = np.flatnonzero((gloss > 0.0) & ~surface.unlit)
        mirror = surface.chosen(shiny)
        albedo = specular_albedo(mirror)
        lobe = probe.lobe(mirror, albedo)
        reflection.radiance[shiny] = lobe / np.maximum(albedo, np.float32(1e-6))
        reflection.share[shiny] = gloss[shiny]
        varnish = Varnish.of(surface)
        if len(varnish.point):
            coat = probe.lobe(varnish.surface, np.repeat(varnish.share, 3, axis=1))
            coat -= self._illumination.coat_lobe(varnish)
            coat *= varnish.share * glossiness(varnish.surface.roughness)[:, None]
            reflection.varnish[varnish.point] = coat
        return reflection

    def _reflect_in_varnish(
        self, seen: Seen, throughput: Floats | None, depth: Depth, reflection: Reflection
    ) -> None:
        """Follow the mirror's rays of coats, which see the scene before the environment."""
        varnish = Varnish.of(seen.surface)
        point = varnish.point
        coat = records.chosen(seen, point)._replace(surface=varnish.surface)
        share = np.repeat(varnish.share, 3, axis=1)
        passed = None if throughput is None else throughput[point]
        mirrored = self.reflected(coat, share, None, passed, depth)
        scene = mirrored.radiance - self._illumination.coat_lobe(varnish)
        reflection.varnish[point] = varnish.share * mirrored.share[:, None] * scene

    def transmitted(
        self,
        seen: Seen,
        samples: Doubles | None = None,
        throughput: Floats | None = None,
        depth: Depth = FROM_THE_CAMERA,
    ) -> Transmission:
        """Follow one ray through each of N points that let light through; see `reflected`."""
        surface = seen.surface
        transmission = Transmission.none(surface.size)
        if not surface.glass.size or depth.boundary > MAX_BOUNDARIES:
            return transmission
        clear = np.flatnonzero((surface.transmission > 0) & ~surface.unlit)
        pane = records.chosen(seen, clear)
        albedo = boundary_albedo(pane.surface)[1]
        varnish = Varnish.of(pane.surface)
        varnish.laid_over(albedo, np.zeros((len(varnish.point), 3), np.float32))
        passed = albedo if throughput is None else albedo * throughput[clear]

        eta = np.where(pane.surface.glass.solid, pane.surface.glass.eta, np.float32(1.0))
        directions = np.empty((len(clear), 3), np.float32)
        weight, half_width = np.empty((2, len(clear)), np.float32)
        chosen = np.empty((0, 2)) if samples is None else samples[clear]
        transmitted_rays(pane.surface, eta, chosen, directions, weight, half_width)
        # At total reflection nothing comes through.
        go = np.flatnonzero((passed.max(axis=1) > LEAST_THROUGHPUT) & (weight > 0))
        pane, index = records.chosen(pane, go), clear[go]
        half_width = half_width[go]
        rays = rays_from(pane.surface, directions[go], _endless(go))
        differentials = differential.refracted(
            self._prepared.tables.geometry,
            pane.triangle,
            pane.surface,
            rays.directions,
            pane.arriving,
            pane.footprint,
            WIDENING * half_width,
            eta[go],
        )
        self._ledger.count("refraction", len(go))
        followed = self._follow(
            rays,
            differentials,
            half_width,
            np.ones(len(go), np.float32),
            passed[go],
            depth._replace(boundary=depth.boundary + 1),
        )
        transmission.albedo[clear] = albedo
        transmission.weight[clear] = weight
        missed = np.flatnonzero(followed.hits.triangle < 0)
        transmission.radiance[index[missed]] = self._prepared.light.cone(
            rays.directions[missed], np.maximum(half_width[missed], self._narrowest_rad)
        )
        transmission.radiance[index[followed.met]] = followed.radiance
        pixel = _pixels_per_radian(differentials, followed.hits.t)
        transmission.spread_px[index] = half_width * pixel
        transmission.lobe_px[index] = 2.0 * pane.surface.roughness**2 * pixel
        return transmission

    def _follow(
        self,
        rays: Rays,
        differentials: RayDifferentials,
        half_width: Floats,
        seen_of_lamps: Floats,
        throughput: Floats,
        depth: Depth,
    ) -> Followed:
        """Follow R rays, and those that they give rise to.

        half_width (R,) radians, of the cone that each stands for; seen_of_lamps (R,), what part of
        lamps' emission they see; throughput (R, 3), the part of what they bring that reaches the
        picture.
        """
        tables = self._prepared.tables

        def shade(index: Longs, hits: Hits) -> Lit:
            directions, arriving = rays.directions[index], records.chosen(differentials, index)
            footprint = differential.footprint_at(
                tables.geometry, hits.triangle, hits.t, directions, arriving
            )
            surface = tables.surface(
                hits.triangle,
                hits.barycentric,
                directions,
                footprint,
                self._settings.texture_filter,
            )
            # What is seen through a wide lobe is seen from many sides: its highlights widen.
            alpha2 = surface.roughness**4 + (BLURRED * half_width[index]) ** 2
            widened = np.minimum(np.sqrt(np.sqrt(alpha2)), np.float32(1.0))
            lamp = self._prepared.lamps.shines[hits.triangle]
            glow = np.where(lamp, seen_of_lamps[index], np.float32(1.0))
            emissive = surface.emissive * glow[:, None]
            surface = surface._replace(
                roughness=widened,
                emissive=emissive,
                mirrored=differential.mirrored(
                    tables.geometry, hits.triangle, surface, arriving, footprint
                ),
            )
            return self._illumination.lit_in_mirror(self._prepared.lobes_of(surface), footprint)

        hits, met, lit = self._organise(
            self._prepared.world,
            rays,
            self._prepared.scene.material_of_triangle,
            shade,
            self._ledger,
        )
        points = Seen(
            lit.surface, hits.triangle[met], lit.footprint, records.chosen(differentials, met)
        )
        throughput = throughput[met]
        reflection = self.reflected(points, lit.albedo, None, throughput, depth)
        transmission = self.transmitted(points, None, throughput, depth)
        own = own_light(lit, reflection)
        radiance = own + mirrored_light(lit, reflection) + transmitted_light(transmission)
        inside = insides(lit.surface)
        if len(inside):
            absorption = lit.surface.glass.absorption[inside]
            left = np.exp(-absorption * hits.t[met[inside], None])
            radiance[inside] *= left
            own[inside] *= left
        return Followed(hits, met, lit.surface, radiance, own)


def _endless(index: Longs) -> Floats:
    return np.full(len(index), np.inf, np.float32)


def _pixels_per_radian(differentials: RayDifferentials, t: Floats) -> Floats:
    """(R,) how many pixels a radian covers at t (R,), seen from where the rays begin."""
    angle = differential.pixel_angle(differentials, t)
    return np.divide(np.float32(1.0), np.maximum(angle, np.float32(1e-9)), dtype=np.float32)


def _show(reflection: Reflection, shiny: Longs, followed: Followed) -> None:
    """Write down what mirrors show; a lobe wider than a pixel shows no edges."""
    met = followed.met
    sharp = np.flatnonzero(reflection.spread_px[shiny[met]] < 0.5)
    at = shiny[met[sharp]]
    reflection.triangle[at] = followed.hits.triangle[met[sharp]]
    reflection.distance[at] = followed.hits.t[met[sharp]]
    reflection.normal[at] = followed.surface.normal[sharp]
