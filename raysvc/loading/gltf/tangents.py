"""Tangents made from texture coordinates (specification, section 3.7.2.1)."""

import numpy as np

from raysvc.loading.gltf.directions import blocks, summed_at, unit
from raysvc.types import Doubles, Floats, Longs


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
    weighted = np.empty((len(triangles), 3, 3))
    handed = np.empty(len(triangles))
    for block in blocks(len(triangles)):
        along, handed[block] = _face_tangents(positions, uv, triangles[block])
        weight = _corner_angles(positions, triangles[block]) * (handed[block] != 0)[:, None]
        weighted[block] = weight[:, :, None] * along[:, None, :]
    summed = summed_at(weighted.reshape(-1, 3), corners, len(first))
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
    edges = [unit(corner[:, (at + 1) % 3] - corner[:, at]) for at in range(3)]
    angles = np.zeros(triangles.shape)
    for at in range(3):
        (leaving, one), (arriving, two) = edges[at], edges[at - 1]
        cosine = np.clip(-np.einsum("nk,nk->n", leaving, arriving), -1.0, 1.0)
        angles[:, at] = np.where(one & two, np.arccos(cosine), 0.0)
    return angles
