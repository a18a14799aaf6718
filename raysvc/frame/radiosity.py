"""Light that surfaces send to each other: a coarse solution, to be seen only through final gathers.

Every patch of the scene (`raysvc.tracing.patches`) is lit at a few points by lights and
environment. Rays from those points say which other patches it sees, and along the same rays light
goes on from patch to patch until hardly any is left (radiosity with form factors by Monte Carlo:
Cohen and Wallace 1993, "Radiosity and Realistic Image Synthesis", chapters 4 and 5). Whatever
surfaces reflect, they are taken to reflect the same everywhere.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from raysvc import records
from raysvc.lighting.albedo import diffuse_albedo, specular_albedo
from raysvc.lighting.ambient_kernels import gather_patches, gather_sky
from raysvc.lighting.soft_map_kernels import SoftMap
from raysvc.parallel import Control, map_chunks
from raysvc.shading.footprint import Footprint
from raysvc.shading.surface import Surface
from raysvc.tracing.occlusion import occlusion_rays, pattern
from raysvc.tracing.occlusion_kernels import TILES
from raysvc.tracing.patches import SAMPLES, Patches
from raysvc.tracing.world import World
from raysvc.types import Bools, Floats, Ints

RAYS = 4
"""From each sample of a patch."""
CHUNK = 1 << 11
"""Patches at a time."""
LEAST_CHANGE = 0.004
"""Light goes on until a bounce adds less than this part of all."""
MAX_BOUNCES = 32


class _Sent(NamedTuple):
    """P patches, by the means over their samples."""

    emitted: Floats
    """(P, 3) radiance that does not come from other patches: their own and what lights send."""
    albedo: Floats
    """(P, 3)."""
    patch: Ints
    """(P, R) patches that rays meet, or -1."""
    hidden: Floats
    """(P, R) part of a ray's light that stays with what it meets."""


def radiosity(
    patches: Patches,
    evaluate: Callable[[Ints, Floats, Floats, Footprint], Surface],
    world: World,
    soft: SoftMap,
    direct: Callable[[Surface], Floats],
    lamp: Bools,
    seed: int,
    control: Control,
) -> Floats:
    """(P, 3) float32 radiance of each patch.

    Parameters
    ----------
    evaluate
        points of triangles (N,) at barycentrics (N, 2), that rays in directions (N, 3) meet
    soft
        the environment, for `solid_angle_of_rays(RAYS * SAMPLES)`
    direct
        what points return of lights
    lamp
        (F,) triangles that are among those lights
    """
    samples = pattern(RAYS, seed)

    def some(begin: int, end: int) -> _Sent:
        part = slice(begin * SAMPLES, end * SAMPLES)
        triangle, towards = patches.triangle[part], patches.towards[part]
        footprint = Footprint.points(len(triangle))
        footprint.blur[:] = 0.5 * patches.size_m
        surface = evaluate(triangle, patches.barycentric[part], -towards, footprint)
        tile = np.tile(np.arange(SAMPLES, dtype=np.int32) % TILES, end - begin)
        rays = occlusion_rays(surface, tile, samples, np.inf)
        hits, through = world.hiding(rays)
        met = patches.met(hits, rays.directions)
        # Points look for lamps themselves.
        surface.emissive[lamp[triangle]] = 0.0
        return _sent(surface, soft, direct, rays.directions, through, met)

    parts = map_chunks(patches.count, CHUNK, some, control)
    return _settled(records.joined(parts)) if parts else np.zeros((0, 3), np.float32)


def _sent(
    surface: Surface,
    soft: SoftMap,
    direct: Callable[[Surface], Floats],
    directions: Floats,
    through: Floats,
    met: Ints,
) -> _Sent:
    """What patches send for a start; SAMPLES points and their rays follow each other for each."""
    arriving = np.empty((surface.size, 3), np.float32)
    gather_sky(
        soft,
        directions.reshape(surface.size, RAYS, 3),
        through.reshape(surface.size, RAYS),
        arriving,
    )
    # What a white Lambertian surface shows is the irradiance over pi.
    arriving *= surface.occlusion[:, None]
    arriving += direct(_white(surface))
    albedo = diffuse_albedo(surface) + specular_albedo(surface)
    emitted = surface.emissive + albedo * arriving
    emitted = np.where(surface.unlit[:, None], surface.base_colour, emitted)
    albedo = np.where(surface.unlit[:, None], np.float32(0.0), albedo)

    def mean(values: Floats) -> Floats:
        of_patches: Floats = np.einsum("psk->pk", values.reshape(-1, SAMPLES, 3))
        return of_patches / np.float32(SAMPLES)

    return _Sent(
        mean(emitted),
        mean(albedo),
        met.reshape(-1, SAMPLES * RAYS),
        1.0 - through.reshape(-1, SAMPLES * RAYS),
    )


def _white(surface: Surface) -> Surface:
    """Return the same points of a white surface that reflects alike in all directions."""
    return surface._replace(
        base_colour=np.ones_like(surface.base_colour),
        metallic=np.zeros_like(surface.metallic),
        roughness=np.ones_like(surface.roughness),
        dielectric_f0=np.zeros_like(surface.dielectric_f0),
    )


def _settled(sent: _Sent) -> Floats:
    """(P, 3) radiance when light has gone from patch to patch often enough (Jacobi's method)."""
    radiance, arriving = sent.emitted.copy(), np.empty_like(sent.emitted)
    for _ in range(MAX_BOUNCES):
        gather_patches(sent.patch, sent.hidden, radiance, arriving)
        brighter = sent.emitted + sent.albedo * arriving
        change = float(np.abs(brighter - radiance).sum(dtype=np.float64))
        radiance = brighter
        if change <= LEAST_CHANGE * float(radiance.sum(dtype=np.float64)):
            break
    return radiance
