"""Normals and tangents that a file does not give, or gives wrongly (specification, 3.7.2.1)."""

import numpy as np

from raysvc.types import Bools, Doubles, Floats, Longs

_UP = np.array([0.0, 1.0, 0.0])
_FACES_AT_ONCE = 1 << 14


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


def without_area(positions: Floats, triangles: Longs) -> bool:
    """Whether any triangle has no area."""
    for begin in range(0, len(triangles), _FACES_AT_ONCE):
        corner = positions[triangles[begin : begin + _FACES_AT_ONCE]].astype(np.float64)
        area = cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        if not area.any(axis=1).all():
            return True
    return False


def face_normals(positions: Floats, triangles: Longs) -> Doubles:
    """Return (F, 3) float64 unit normals, +Y where a triangle has no area."""
    corner = positions[triangles].astype(np.float64)
    edge, other = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    normals, good = unit(cross(edge, other))
    normals[~good] = _UP
    return normals


def smooth_normals(positions: Floats, triangles: Longs) -> Doubles:
    """Return (V, 3) float64 unit normals, the mean of the adjacent triangles' by area."""
    corner = positions[triangles].astype(np.float64)
    area = cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    normals, good = unit(_summed(np.repeat(area, 3, axis=0), triangles, len(positions)))
    normals[~good] = _UP
    return normals


def tangents(positions: Floats, normals: Floats, uv: Floats, triangles: Longs) -> Floats:
    """Return tangents along u, averaged over the triangles at a vertex by angle.

    Vertices that agree in position, normal and texture coordinate are averaged together, as
    MikkTSpace does. Where triangles disagree about the handedness, or none has texture coordinates
    that span an area, w is 0.

    Parameters
    ----------
    positions, normals
        (V, 3) float32, normals unit
    uv
        (V, 2) texture coordinates of the normal map, its transform applied
    triangles
        (F, 3) int64

    Returns
    -------
    (V, 4) float32: unit tangent orthogonal to the normal, and handedness
    """
    rows = np.concatenate([positions, normals, uv.astype(np.float32)], axis=1)
    _, first, merged = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    corners = merged.reshape(-1)[triangles]
    along, handed = _face_tangents(positions, uv, triangles)
    weight = _corner_angles(positions, triangles) * (handed != 0)[:, None]
    weighted = (weight[:, :, None] * along[:, None, :]).reshape(-1, 3)
    summed = _summed(weighted, corners, len(first))
    normal = normals[first].astype(np.float64)
    flat = summed - np.einsum("nk,nk->n", summed, normal)[:, None] * normal
    direction, good = unit(flat)
    left = np.zeros(len(first), bool)
    right = np.zeros(len(first), bool)
    left[corners[handed < 0].reshape(-1)] = True
    right[corners[handed > 0].reshape(-1)] = True
    sign = np.where(good & (left != right), np.where(right, 1.0, -1.0), 0.0)
    made = np.concatenate([direction * (sign != 0)[:, None], sign[:, None]], axis=1)
    return made.astype(np.float32)[merged.reshape(-1)]


def _face_tangents(positions: Floats, uv: Floats, triangles: Longs) -> tuple[Doubles, Doubles]:
    """Unit direction of growing u, and +1, -1 or 0 (no area in u and v) for every triangle.

    glTF's bitangent points to decreasing v, as v grows downwards in the texture: the handedness is
    that of (u, -v), hence the sign.
    """
    corner, coordinate = positions[triangles].astype(np.float64), uv[triangles].astype(np.float64)
    edge, other = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    step, turn = coordinate[:, 1] - coordinate[:, 0], coordinate[:, 2] - coordinate[:, 0]
    area = step[:, 0] * turn[:, 1] - step[:, 1] * turn[:, 0]
    along, good = unit((edge * turn[:, 1:] - other * step[:, 1:]) * np.sign(area)[:, None])
    return along, np.where(good, -np.sign(area), 0.0)


def _corner_angles(positions: Floats, triangles: Longs) -> Doubles:
    """(F, 3) angle at each corner in radians; 0 where an edge has no length."""
    corner = positions[triangles].astype(np.float64)
    angles = np.zeros(triangles.shape)
    for at in range(3):
        one, one_good = unit(corner[:, (at + 1) % 3] - corner[:, at])
        two, two_good = unit(corner[:, (at + 2) % 3] - corner[:, at])
        cosine = np.clip(np.einsum("nk,nk->n", one, two), -1.0, 1.0)
        angles[:, at] = np.where(one_good & two_good, np.arccos(cosine), 0.0)
    return angles


def _summed(values: Doubles, corners: Longs, count: int) -> Doubles:
    """Sum (3F, 3) values of corners at their vertices."""
    flat = corners.reshape(-1)
    return np.stack([np.bincount(flat, values[:, k], count) for k in range(3)], axis=1)
