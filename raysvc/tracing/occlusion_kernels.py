"""Inner loops of ambient occlusion."""

import math

import numpy as np

from raysvc.jit import inlined, kernel
from raysvc.tracing.offset_kernels import offset_origin
from raysvc.types import Doubles, Floats, Ints, Longs

Vec3 = tuple[float, float, float]
SAME_NORMAL = 0.9
"""Cosine between normals of pixels that are taken to be one surface."""


@inlined
def basis(n: Vec3) -> tuple[Vec3, Vec3]:
    """Two unit vectors perpendicular to a unit vector and to each other.

    Duff et al. 2017, "Building an Orthonormal Basis, Revisited", JCGT 6(1).
    """
    sign = math.copysign(1.0, n[2])
    a = -1.0 / (sign + n[2])
    b = n[0] * n[1] * a
    return (1.0 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]), (
        b,
        sign + n[1] * n[1] * a,
        -n[1],
    )


@kernel
def cosine_rays(
    position: Floats,
    geometric_normal: Floats,
    normal: Floats,
    tile: Ints,
    samples: Doubles,
    origins: Floats,
    directions: Floats,
) -> None:
    """Fill origins and directions (N * K, 3): K cosine-weighted rays from each of N points.

    A direction below the triangle is mirrored to its other side.
    """
    count = len(samples)
    for n in range(len(position)):
        axis = (float(normal[n, 0]), float(normal[n, 1]), float(normal[n, 2]))
        ng = (
            float(geometric_normal[n, 0]),
            float(geometric_normal[n, 1]),
            float(geometric_normal[n, 2]),
        )
        tangent, bitangent = basis(axis)
        for k in range(count):
            # Both coordinates move with the tile: 16 tiles make a finer lattice, not a turned one.
            u = (samples[k, 0] + tile[n] / (16.0 * count)) % 1.0
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
            offset_origin(position, geometric_normal, n, np.float32(1.0), origins, at)


@kernel
def tile_mean(
    visible: Floats, depth: Floats, normal: Floats, depth_step: Floats, mean: Floats
) -> None:
    """Fill mean (H, W) with averages of the 4 x 4 pixels about each that show its surface."""
    height, width = visible.shape
    for row in range(height):
        for col in range(width):
            z = depth[row, col]
            mean[row, col] = visible[row, col]
            if not np.isfinite(z):
                continue
            total, count = 0.0, 0
            for y in range(max(row - 2, 0), min(row + 2, height)):
                for x in range(max(col - 2, 0), min(col + 2, width)):
                    same = (
                        normal[row, col, 0] * normal[y, x, 0]
                        + normal[row, col, 1] * normal[y, x, 1]
                        + normal[row, col, 2] * normal[y, x, 2]
                    ) > SAME_NORMAL
                    far = abs(row - y) + abs(col - x) + 1
                    if same and abs(depth[y, x] - z) <= depth_step[row, col] * far:
                        total += visible[y, x]
                        count += 1
            if count > 0:
                mean[row, col] = total / count


@kernel
def borrow(
    visible: Floats,
    depth: Floats,
    normal: Floats,
    depth_step: Floats,
    pixel: Longs,
    point_depth: Floats,
    point_normal: Floats,
    borrowed: Floats,
) -> None:
    """Fill borrowed (N,) with means of the 3 x 3 pixels about each point on its surface, or -1.

    The points lie within pixels (N,) but not at their centres.
    """
    height, width = visible.shape
    for n in range(len(pixel)):
        row, col = pixel[n] // width, pixel[n] % width
        total, count = 0.0, 0
        for y in range(max(row - 1, 0), min(row + 2, height)):
            for x in range(max(col - 1, 0), min(col + 2, width)):
                same = (
                    point_normal[n, 0] * normal[y, x, 0]
                    + point_normal[n, 1] * normal[y, x, 1]
                    + point_normal[n, 2] * normal[y, x, 2]
                ) > SAME_NORMAL
                if same and abs(depth[y, x] - point_depth[n]) <= 2.0 * depth_step[y, x]:
                    total += visible[y, x]
                    count += 1
        borrowed[n] = total / count if count > 0 else -1.0
