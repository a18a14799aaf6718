"""Directional albedo of the BRDF: what a surface shows under light that is 1 from everywhere.

    specular   integral of F V D N.L           = F0 A(N.V, roughness) + B(N.V, roughness)
    diffuse    integral of (1 - F) N.L c / pi  = c (1 - F0) (1 - C(N.V))

A and B are the terms of Karis's split sum (2013), here of glTF's own formula; C is the mean of (1 -
V.H)^5 over the cosine lobe. The tables are integrated once per process, the same each time.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from raysvc.lighting.albedo_kernels import (
    diffuse_albedos,
    integrate_diffuse,
    integrate_specular,
    specular_albedos,
)
from raysvc.shading.surface import Surface
from raysvc.types import Doubles, Floats

ROUGHNESS_STEPS = 49
COSINE_STEPS = 64
QUADRATURE_SAMPLES = 1597


@dataclass(frozen=True, slots=True, eq=False)
class AlbedoTables:
    """Read-only tables over sqrt(N.V), in even steps of roughness and root, both 0 to 1."""

    specular: Doubles
    """(ROUGHNESS_STEPS, COSINE_STEPS, 2): A, B."""
    diffuse: Doubles
    """(COSINE_STEPS,): C."""


@lru_cache(maxsize=1)
def albedo_tables() -> AlbedoTables:
    """Integrate the tables, or return those of an earlier call."""
    cosines = np.linspace(0.0, 1.0, COSINE_STEPS) ** 2
    roughness = np.linspace(0.0, 1.0, ROUGHNESS_STEPS)
    specular = np.empty((ROUGHNESS_STEPS, COSINE_STEPS, 2))
    integrate_specular(cosines, roughness, QUADRATURE_SAMPLES, specular)
    diffuse = np.empty(COSINE_STEPS)
    integrate_diffuse(cosines, QUADRATURE_SAMPLES, diffuse)
    specular.setflags(write=False)
    diffuse.setflags(write=False)
    return AlbedoTables(specular, diffuse)


def specular_albedo(surface: Surface) -> Floats:
    """Share (N, 3) float32 of constant light that the specular lobe returns: F0 A + B."""
    albedo = np.empty((surface.size, 3), np.float32)
    specular_albedos(
        albedo_tables().specular,
        surface,
        albedo,
    )
    return albedo


def diffuse_albedo(surface: Surface) -> Floats:
    """Share (N, 3) float32 of constant light that the diffuse lobe returns: c (1 - F0) (1 - C)."""
    albedo = np.empty((surface.size, 3), np.float32)
    diffuse_albedos(
        albedo_tables().diffuse,
        surface,
        albedo,
    )
    return albedo
