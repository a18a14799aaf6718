"""Triangles as plain coordinates, in the order in which a structure fetches them."""

import numpy as np

from raysvc.jit import kernel
from raysvc.types import Floats, Ints

TRIANGLE_BYTES = 36
"""What a traversal fetches for a triangle's test."""


@kernel
def gather_corners(positions: Floats, indices: Ints, order: Ints, corners: Floats) -> None:
    """Fill corners (9 N,) with the nine coordinates of each triangle of order (N,), in
    that order.
    """
    for n in range(len(order)):
        for corner in range(3):
            vertex = indices[order[n], corner]
            for k in range(3):
                corners[9 * n + 3 * corner + k] = positions[vertex, k]


@kernel
def bounds_of(corners: Floats, bounds: Floats) -> None:
    """Fill bounds (F, 6), the least and the greatest coordinates, from corners (9 F,)."""
    for f in range(len(bounds)):
        for k in range(3):
            a, b, c = corners[9 * f + k], corners[9 * f + 3 + k], corners[9 * f + 6 + k]
            bounds[f, k] = min(a, min(b, c))
            bounds[f, 3 + k] = max(a, max(b, c))


def corners_of(positions: Floats, indices: Ints, order: Ints) -> Floats:
    """(9 N,) float32: the coordinates of the triangles of order (N,), in that order."""
    corners = np.empty(9 * len(order), np.float32)
    gather_corners(positions, indices, order, corners)
    return corners
