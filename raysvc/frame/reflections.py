"""What rays from a point have brought, and how that becomes light that leaves it."""

from typing import NamedTuple

import numpy as np

from raysvc.frame.radiance import Lit, glossiness
from raysvc.lighting.brushed_light import round_roughness
from raysvc.types import Floats, Ints


class Reflection(NamedTuple):
    """What N points mirror of the scene."""

    radiance: Floats
    """(N, 3) that arrives through the specular lobe from what is met."""
    share: Floats
    """(N,) part of the lobe in which something is met; the rest is the environment's."""
    weight: Floats
    """(N,) how much the ray counts in the mean of the rays of its lobe; 1 for mirrors."""
    spread_px: Floats
    """(N,) half width of the ray's cone where it ends, in pixels; -1 where there was no ray."""
    lobe_px: Floats
    """(N,) that of a ray in the middle of the lobe; -1 where there was no ray."""
    triangle: Ints
    """(N,) what a mirror shows: the triangle, or -1. Rough surfaces show none."""
    distance: Floats
    """(N,) metres to it, inf where there is none."""
    normal: Floats
    """(N, 3) its shading normal, 0 where there is none."""
    varnish: Floats
    """(N, 3) radiance by which varnish shows more of the scene than of the environment there."""

    @staticmethod
    def none(count: int) -> "Reflection":
        """Points that mirror nothing."""
        return Reflection(
            np.zeros((count, 3), np.float32),
            np.zeros(count, np.float32),
            np.ones(count, np.float32),
            np.full(count, -1.0, np.float32),
            np.full(count, -1.0, np.float32),
            np.full(count, -1, np.int32),
            np.full(count, np.inf, np.float32),
            np.zeros((count, 3), np.float32),
            np.zeros((count, 3), np.float32),
        )


class Transmission(NamedTuple):
    """What N points show of what is behind them."""

    radiance: Floats
    """(N, 3) that arrives from behind: of the scene, or of the environment."""
    albedo: Floats
    """(N, 3) share of constant light from behind that comes through."""
    weight: Floats
    """(N,) how much the ray counts in the mean of the rays of its lobe; 1 for smooth glass."""
    spread_px: Floats
    """(N,) half width of the ray's cone where it ends, in pixels; -1 where there was no ray."""
    lobe_px: Floats
    """(N,) that of a ray in the middle of the lobe; -1 where there was no ray."""

    @staticmethod
    def none(count: int) -> "Transmission":
        """Points that let nothing through."""
        return Transmission(
            np.zeros((count, 3), np.float32),
            np.zeros((count, 3), np.float32),
            np.ones(count, np.float32),
            np.full(count, -1.0, np.float32),
            np.full(count, -1.0, np.float32),
        )


def own_light(lit: Lit, reflection: Reflection) -> Floats:
    """(N, 3) radiance of points without what they mirror of the scene.

    Where a glossy surface's ray met nothing it shows the environment whole. A matt one shows the
    part of it that a diffuse one would, and what hides the rest as from all directions alike.
    """
    surface = lit.surface
    gloss = glossiness(round_roughness(surface))[:, None]
    open_ = np.maximum(gloss - reflection.share[:, None], 0.0) + (1.0 - gloss) * lit.sky
    radiance = lit.radiance + lit.lobe * open_ + lit.albedo * lit.bounced * (1.0 - gloss)
    shown: Floats = np.where(surface.unlit[:, None], surface.base_colour, radiance)
    return shown


def mirrored_light(lit: Lit, reflection: Reflection) -> Floats:
    """(N, 3) radiance that points mirror of the scene; unlit ones mirror nothing."""
    mirrored: Floats = lit.albedo * (reflection.radiance * reflection.share[:, None])
    return mirrored + reflection.varnish


def transmitted_light(transmission: Transmission) -> Floats:
    """(N, 3) radiance that comes through points from behind."""
    return transmission.albedo * transmission.radiance


def leaving(lit: Lit, reflection: Reflection, transmission: Transmission) -> Floats:
    """(N, 3) radiance that leaves points towards whoever looks at them."""
    shown = own_light(lit, reflection) + mirrored_light(lit, reflection)
    return shown + transmitted_light(transmission)
