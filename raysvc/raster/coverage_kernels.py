"""Which pixel's centre shows what a sample elsewhere shows."""

import numpy as np

from raysvc.geometry.vector_kernels import Vec3, cross, dot, plus, row3, unit_or
from raysvc.jit import inlined, kernel
from raysvc.raster.edge_kernels import SAME_NORMAL
from raysvc.types import Doubles, Floats, Ints, Longs

OTHER_TRIANGLE = 16.0
"""Squared pixels of distance by which a centre on another triangle of the surface is worse."""


@inlined
def normal_of(positions: Floats, triangles: Ints, triangle: int) -> Vec3:
    """Unit normal of a triangle, 0 if it has none."""
    a = row3(positions, triangles[triangle, 0])
    b = plus(row3(positions, triangles[triangle, 1]), a, -1.0)
    c = plus(row3(positions, triangles[triangle, 2]), a, -1.0)
    return unit_or(cross(b, c), (0.0, 0.0, 0.0))


@kernel
def find_alike(
    shown: Ints,
    positions: Floats,
    triangles: Ints,
    part: Ints,
    pixel: Longs,
    triangle: Ints,
    offsets: Doubles,
    alike: Longs,
) -> None:
    """Fill alike (P, S) with the pixel whose centre shows what a sample shows.

    Of the 3 x 3 about the sample's pixel those come first that show its triangle, then those that
    show one of the same part that faces the same way, and of these the nearest to the sample; where
    there is none it is the sample's own.

    Parameters
    ----------
    shown
        (H, W) triangle at the centre of each pixel, -1 for none
    positions, triangles, part
        (V, 3) and (F, 3) of the scene; (F,) number of each triangle's object and material
    pixel
        (P,) row * W + col of pixels with samples
    triangle, offsets
        (P, S) what the samples show, -1 for nothing; (S, 2) where they are, from the centre
    """
    height, width = shown.shape
    for n in range(len(pixel)):
        row, col = pixel[n] // width, pixel[n] % width
        for s in range(len(offsets)):
            alike[n, s] = pixel[n]
            f, least = triangle[n, s], np.inf
            for y in range(max(row - 1, 0), min(row + 2, height)):
                for x in range(max(col - 1, 0), min(col + 2, width)):
                    across = x - col - offsets[s, 0]
                    down = y - row - offsets[s, 1]
                    apart = across * across + down * down
                    g = shown[y, x]
                    if f != g:
                        apart += OTHER_TRIANGLE
                        if f < 0 or g < 0 or part[f] != part[g] or apart >= least:
                            continue
                        cosine = dot(
                            normal_of(positions, triangles, f), normal_of(positions, triangles, g)
                        )
                        if cosine < SAME_NORMAL:
                            continue
                    if apart < least:
                        least = apart
                        alike[n, s] = y * width + x
