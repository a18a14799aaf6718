"""Light that comes from one place: the sun of an environment, and punctual lights."""

import math

import numpy as np

from raysvc.lighting.direct_kernels import reflect_light
from raysvc.lighting.sun import SunLight
from raysvc.scene import PunctualLight
from raysvc.shading.surface import Surface
from raysvc.types import Floats


def arriving(light: SunLight | PunctualLight, position: Floats) -> tuple[Floats, Floats, Floats]:
    """Light that reaches points when nothing is in its way.

    Parameters
    ----------
    light
        point and spot lights fall with the square of the distance, end smoothly at their range and
        between the cones (KHR_lights_punctual); sun and directional lights are the same everywhere
    position
        (N, 3) float32 in world space

    Returns
    -------
    to_light
        (N, 3) float32 unit, towards the light (the centre of the sun)
    distance
        (N,) float32 in metres, inf for lights that are nowhere
    irradiance
        (N, 3) float32, linear Rec.709, at a surface that faces the light
    """
    count = len(position)
    if isinstance(light, SunLight) or light.kind == "directional":
        if isinstance(light, SunLight):
            towards, strength = np.array(light.direction), light.irradiance
        else:
            towards, strength = -np.array(light.direction), light.intensity
        return (
            np.tile(np.asarray(towards, np.float32), (count, 1)),
            np.full(count, np.inf, np.float32),
            np.tile(np.asarray(strength, np.float32), (count, 1)),
        )

    away = np.asarray(light.position, np.float64) - position
    distance = np.sqrt(np.einsum("nk,nk->n", away, away))
    away /= np.maximum(distance, 1e-12)[:, None]
    fade = np.clip(1.0 - (distance / light.range_m) ** 4, 0.0, 1.0)
    fade /= np.maximum(distance, 1e-6) ** 2
    if light.kind == "spot":
        inner, outer = math.cos(light.inner_cone_rad), math.cos(light.outer_cone_rad)
        along = -(away @ np.asarray(light.direction, np.float64))
        fade *= np.clip((along - outer) / max(inner - outer, 1e-3), 0.0, 1.0) ** 2
    irradiance = fade[:, None] * np.asarray(light.intensity, np.float64)
    return (
        away.astype(np.float32),
        distance.astype(np.float32),
        irradiance.astype(np.float32),
    )


def reflected(
    surface: Surface, to_light: Floats, irradiance: Floats, angular_radius_rad: float
) -> Floats:
    """Radiance towards the viewer of a light that nothing shadows.

    Parameters
    ----------
    surface
        N points
    to_light, irradiance
        (N, 3), (N, 3) float32 as `arriving` gives them
    angular_radius_rad
        of the disc that the light is; 0 is a point. The disc widens highlights. In the mirror limit
        a disc has no highlight, for there the environment shows its picture of it.

    Returns
    -------
    (N, 3) float32; nothing for light from behind the triangle or behind the shading normal
    """
    radiance = np.empty((surface.size, 3), np.float32)
    reflect_light(
        surface,
        to_light,
        irradiance,
        float(angular_radius_rad),
        radiance,
    )
    return radiance
