"""Directional albedo of the boundary of a solid: what it reflects and lets through of constant
light.

    reflected    F0 A + B                                    A, B of `albedo.py` from outside
    transmitted  transmission c_diff (1 - F0) T              T = A through a thin sheet

From inside A, B and T depend on the index of refraction, for beyond the critical angle everything
is reflected. The tables' axis along the cosine has that angle in its middle, whatever the index,
and above it goes by the cosine of the refracted ray: on it a smooth boundary looks the same for
every index. They are integrated once per process, the same each time, and not before a scene has a
solid.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from raysvc.lighting.albedo import albedo_tables
from raysvc.lighting.boundary_albedo_kernels import (
    boundary_albedos,
    integrate_inside,
    integrate_outside,
)
from raysvc.shading.surface import Surface
from raysvc.types import Doubles, Floats

IOR_STEPS = 13
ROUGHNESS_STEPS = 25
COSINE_STEPS = 65
QUADRATURE_SAMPLES = 233


@dataclass(frozen=True, slots=True, eq=False)
class BoundaryTables:
    """Read-only tables over the index of refraction (even in `ior_place`), roughness (even) and
    cosine."""

    outside: Doubles
    """(IOR_STEPS, ROUGHNESS_STEPS, COSINE_STEPS, 1): T, over sqrt(N.V)."""
    inside: Doubles
    """(IOR_STEPS, ROUGHNESS_STEPS, COSINE_STEPS, 3): A, B, T, over `inside_place`."""


@lru_cache(maxsize=1)
def boundary_tables() -> BoundaryTables:
    """Integrate the tables, or return those of an earlier call."""
    roughness = np.linspace(0.0, 1.0, ROUGHNESS_STEPS)
    outside = np.empty((IOR_STEPS, ROUGHNESS_STEPS, COSINE_STEPS, 1))
    integrate_outside(roughness, QUADRATURE_SAMPLES, outside)
    inside = np.empty((IOR_STEPS, ROUGHNESS_STEPS, COSINE_STEPS, 3))
    integrate_inside(roughness, QUADRATURE_SAMPLES, inside)
    outside.setflags(write=False)
    inside.setflags(write=False)
    return BoundaryTables(outside, inside)


def boundary_albedo(surface: Surface) -> tuple[Floats, Floats]:
    """Shares of constant light that a surface with `Surface.glass` reflects and lets through.

    Returns
    -------
    (N, 3), (N, 3) float32: by the mirror lobe, on the viewer's side, and by that behind. What is
    diffused is neither.
    """
    tables = boundary_tables()
    reflected = np.empty((surface.size, 3), np.float32)
    transmitted = np.empty((surface.size, 3), np.float32)
    boundary_albedos(
        albedo_tables().specular, tables.outside, tables.inside, surface, reflected, transmitted
    )
    return reflected, transmitted
