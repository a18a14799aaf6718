"""Unit vectors, and the normals that a file does not give (specification, section 3.7.2.1).

Work goes in blocks of triangles that stay in the processor's cache.
"""

from collections.abc import Iterator

import numpy as np

from raysvc.types import Bools, Doubles, Floats, Longs

_UP = np.array([0.0, 1.0, 0.0])
AT_ONCE = 1 << 14
"""Triangles or vertices of a block."""


def unit(vectors: Doubles) -> tuple[Doubles, Bools]:
    """Return (N, 3) float64 unit vectors and which of them are (the others are 0).

    Scaled by the largest component first, so that nothing overflows or underflows.
    """
    finite = np.isfinite(vectors).all(axis=1, keepdims=True)
    clean = np.where(finite, vectors, 0.0)
    largest = np.abs(clean).max(axis=1, initial=0.0, keepdims=True)
    scaled = clean / np.where(largest > 0, largest, 1.0)
    length = np.sqrt(np.einsum("nk,nk->n", scaled, scaled))[:, None]
    return scaled / np.where(length > 0, length, 1.0), largest[:, 0] > 0


def cross(a: Doubles, b: Doubles) -> Doubles:
    """Return (N, 3) cross products; several times faster than NumPy's own for few and for many."""
    product = np.empty(a.shape)
    for axis in range(3):
        one, two = (axis + 1) % 3, (axis + 2) % 3
        np.multiply(a[:, one], b[:, two], out=product[:, axis])
        product[:, axis] -= a[:, two] * b[:, one]
    return product


def blocks(count: int, at_once: int = AT_ONCE) -> Iterator[slice]:
    """Yield consecutive ranges of at most `at_once`, or 1, that cover 0..count."""
    at_once = max(1, at_once)
    for begin in range(0, count, at_once):
        yield slice(begin, min(begin + at_once, count))


def without_area(positions: Floats, triangles: Longs) -> bool:
    """Whether any triangle has no area."""
    return any(
        not _areas(positions, triangles[block]).any(axis=1).all()
        for block in blocks(len(triangles))
    )


def face_normals(positions: Floats, triangles: Longs) -> Floats:
    """Return (F, 3) float32 unit normals, +Y where a triangle has no area."""
    made = np.empty((len(triangles), 3), np.float32)
    for block in blocks(len(triangles)):
        normals, good = unit(_areas(positions, triangles[block]))
        normals[~good] = _UP
        made[block] = normals
    return made


def smooth_normals(positions: Floats, triangles: Longs) -> Doubles:
    """Return (V, 3) float64 unit normals, the mean of the adjacent triangles' by area."""
    areas = np.repeat(_areas(positions, triangles), 3, axis=0)
    normals, good = unit(summed_at(areas, triangles, len(positions)))
    normals[~good] = _UP
    return normals


def _areas(positions: Floats, triangles: Longs) -> Doubles:
    """(F, 3) normals as long as twice the area."""
    corner = positions[triangles].astype(np.float64)
    return cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])


def summed_at(values: Doubles, corners: Longs, count: int) -> Doubles:
    """Return (count, 3) sums of (3F, 3) values of corners at their vertices."""
    flat = corners.reshape(-1)
    return np.stack([np.bincount(flat, values[:, k], count) for k in range(3)], axis=1)
