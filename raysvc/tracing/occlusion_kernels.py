"""Inner loops of ambient occlusion."""

import math

import numpy as np

from raysvc.geometry.basis_kernels import basis
from raysvc.jit import kernel
from raysvc.shading.surface import Surface
from raysvc.tracing.offset_kernels import offset_origin
from raysvc.types import Doubles, Floats, Ints, Longs

TILES = 4
"""How many shifts of the pattern there are."""
SAME_NORMAL = 0.9
"""Cosine between normals of pixels that are taken to be one surface."""


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
            v = (samples[k, 1] + tile[n] * 0.38196601125) % 1.0
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


@kernel
def neighbours_mean(
    visible: Floats,
    depth: Floats,
    normal: Floats,
    depth_step: Floats,
    pixel: Longs,
    point_depth: Floats,
    point_normal: Floats,
    before: int,
    after: int,
    mean: Floats,
) -> None:
    """Fill mean (N,) of points in pixels (N,) with what the pixels about each say of its surface.

    Those are `before` rows and columns before the pixel to `after` behind it, as far as they know
    (visible >= 0) and show the point's surface; -1 where there is none.
    """
    height, width = visible.shape
    for n in range(len(pixel)):
        row, col = pixel[n] // width, pixel[n] % width
        total, count = 0.0, 0
        for y in range(max(row - before, 0), min(row + after + 1, height)):
            for x in range(max(col - before, 0), min(col + after + 1, width)):
                if visible[y, x] < 0.0:
                    continue
                same = (
                    point_normal[n, 0] * normal[y, x, 0]
                    + point_normal[n, 1] * normal[y, x, 1]
                    + point_normal[n, 2] * normal[y, x, 2]
                ) > SAME_NORMAL
                far = abs(row - y) + abs(col - x) + 1
                if same and abs(depth[y, x] - point_depth[n]) <= depth_step[y, x] * far:
                    total += visible[y, x]
                    count += 1
        mean[n] = total / count if count > 0 else -1.0
