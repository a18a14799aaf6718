"""Reading a cube of pictures in the directions of a lat-long map."""

import math

from raysvc.jit import inlined, kernel
from raysvc.types import Doubles, Floats

BORDER = 1
"""Pixels around each face that show what the next one does."""


@inlined
def face_of(axes: Doubles, x: float, y: float, z: float) -> int:
    """Number of the face through which a direction goes: the one that it is nearest to."""
    best, nearest = 0, -2.0
    for face in range(6):
        along = axes[face, 2, 0] * x + axes[face, 2, 1] * y + axes[face, 2, 2] * z
        if along > nearest:
            best, nearest = face, along
    return best


@kernel
def resample_cube(
    faces: Floats, axes: Doubles, detail: int, begin: int, end: int, result: Floats
) -> None:
    """Write rows begin..end of a lat-long map (H, W, 3): means of detail x detail lookups a texel.

    faces (6, S + 2 BORDER, S + 2 BORDER, 3) are square pictures, row 0 at the top; axes (6, 3, 3)
    their unit right, up and forward.
    """
    height, width = result.shape[0], result.shape[1]
    size = faces.shape[1] - 2 * BORDER
    share = 1.0 / (detail * detail)
    for row in range(begin, end):
        for column in range(width):
            red, green, blue = 0.0, 0.0, 0.0
            for part in range(detail * detail):
                polar = (row + (part // detail + 0.5) / detail) * math.pi / height
                around = (column + (part % detail + 0.5) / detail) / width - 0.5
                azimuth = 2.0 * math.pi * around
                x, y = math.sin(polar) * math.sin(azimuth), math.cos(polar)
                z = -math.sin(polar) * math.cos(azimuth)
                face = face_of(axes, x, y, z)
                right = axes[face, 0, 0] * x + axes[face, 0, 1] * y + axes[face, 0, 2] * z
                up = axes[face, 1, 0] * x + axes[face, 1, 1] * y + axes[face, 1, 2] * z
                forward = axes[face, 2, 0] * x + axes[face, 2, 1] * y + axes[face, 2, 2] * z
                # From the first pixel centre; the border keeps all four pixels inside
                u = 0.5 * size * (1.0 + right / forward) + BORDER - 0.5
                v = 0.5 * size * (1.0 - up / forward) + BORDER - 0.5
                left, top = int(u), int(v)
                s, t = u - left, v - top
                for corner in range(4):
                    i, j = top + corner // 2, left + corner % 2
                    weight = (t if corner // 2 else 1.0 - t) * (s if corner % 2 else 1.0 - s)
                    red += weight * faces[face, i, j, 0]
                    green += weight * faces[face, i, j, 1]
                    blue += weight * faces[face, i, j, 2]
            result[row, column, 0] = red * share
            result[row, column, 1] = green * share
            result[row, column, 2] = blue * share
