"""Inner loops of ambient occlusion."""

import math

import numpy as np

from raysvc.geometry.basis_kernels import basis
from raysvc.jit import kernel
from raysvc.shading.surface import Surface
from raysvc.tracing.offset_kernels import offset_origin
from raysvc.types import Doubles, Floats, Ints

TILES = 16
"""How many shifts of the pattern there are."""
TILE_STEP = 29.0 / 128.0
"""Of the second coordinate from one shift to the next: with it 4 to 64 samples and all their shifts
together have the least diaphony (Zinterhof 1976), half of what the golden ratio gives."""


@kernel
def cosine_rays(
    surface: Surface,
    tile: Ints,
    samples: Doubles,
    origins: Floats,
    directions: Floats,
) -> None:
    """Fill origins and directions (N * K, 3): K cosine-weighted rays from each of N points.

    A direction below the triangle is mirrored to its other side.
    """
    count = len(samples)
    for n in range(len(surface.position)):
        axis = (
            float(surface.normal[n, 0]),
            float(surface.normal[n, 1]),
            float(surface.normal[n, 2]),
        )
        ng = (
            float(surface.geometric_normal[n, 0]),
            float(surface.geometric_normal[n, 1]),
            float(surface.geometric_normal[n, 2]),
        )
        tangent, bitangent = basis(axis)
        for k in range(count):
            # Both coordinates move with the tile: all tiles make a finer lattice, not a turned one.
            u = (samples[k, 0] + tile[n] / (TILES * count)) % 1.0
            v = (samples[k, 1] + tile[n] * TILE_STEP) % 1.0
            r, phi = math.sqrt(u), 2.0 * math.pi * v
            x, y, z = r * math.cos(phi), r * math.sin(phi), math.sqrt(max(1.0 - u, 0.0))
            dx = x * tangent[0] + y * bitangent[0] + z * axis[0]
            dy = x * tangent[1] + y * bitangent[1] + z * axis[1]
            dz = x * tangent[2] + y * bitangent[2] + z * axis[2]
            below = dx * ng[0] + dy * ng[1] + dz * ng[2]
            if below < 0.0:
                dx, dy, dz = dx - 2 * below * ng[0], dy - 2 * below * ng[1], dz - 2 * below * ng[2]
            at = n * count + k
            directions[at, 0], directions[at, 1], directions[at, 2] = dx, dy, dz
            offset_origin(
                surface.position,
                surface.geometric_normal,
                surface.clearance,
                n,
                np.float32(1.0),
                origins,
                at,
            )
