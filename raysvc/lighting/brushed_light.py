"""Which parts of a brushed lobe are looked up, and what a round lobe in its place would be like."""

import functools

import numpy as np

from raysvc.lighting.albedo_kernels import GOLDEN
from raysvc.lighting.brdf import MIN_ALPHA
from raysvc.shading.surface import Surface
from raysvc.types import Doubles, Floats

LOOKUPS_PER_ROUND_LOBE = 16
"""Of the environment under a brushed lobe, for each round lobe that a round one is looked up by."""


@functools.cache
def brushed_lattice(lookups: int) -> Doubles:
    """Return points (lookups, 2) of the unit disc, evenly spread, each on a strip of its own.

    Strips are as large as each other and stand across the first axis, so that a lobe many times as
    long as wide still has all of its lookups side by side.
    """
    number = np.arange(lookups)
    along = np.linspace(-1.0, 1.0, 4097)
    chord = np.sqrt(1.0 - along**2)
    area = 0.5 + (along * chord + np.arcsin(along)) / np.pi
    x = np.interp((number + 0.5) / lookups, area, along)
    across = 2.0 * ((number * GOLDEN + 0.5) % 1.0) - 1.0
    lattice: Doubles = np.stack([x, across * np.sqrt(1.0 - x * x)], axis=1)
    lattice.setflags(write=False)
    return lattice


def round_roughness(surface: Surface) -> Floats:
    """(N,) roughness of round lobes with as much solid angle as those of points."""
    if not surface.brushed.size:
        return surface.roughness
    across = np.maximum(surface.roughness.astype(np.float64) ** 2, MIN_ALPHA)
    along = across + (1.0 - across) * surface.brushed.strength.astype(np.float64) ** 2
    alike = ((along * across) ** 0.25).astype(np.float32)
    return np.where(surface.brushed.strength > 0.0, alike, surface.roughness)
