"""Shading normals for meshes that come without: smooth, but for edges meant to be sharp."""

import numpy as np

from raysvc.geometry.places import welded
from raysvc.types import Bools, Doubles, Ints, Longs

CREASE_DEG = 60.0


def crease_normals(
    positions: Doubles, triangles: Ints | Longs, crease_deg: float = CREASE_DEG
) -> tuple[Longs, Ints, Doubles]:
    """Compute normals, splitting vertices along creases.

    Vertices at the very same place count as one, so that triangle soups such as STL become smooth.
    Corners of triangles that share an edge, and differ there by less than `crease_deg`, share
    a normal: the mean of their triangles' normals weighted by the angles at the corners (Thürmer
    and Wüthrich 1998, "Computing Vertex Normals from Polygonal Facets").

    Parameters
    ----------
    positions
        (V, 3) float64
    triangles
        (F, 3) integers
    crease_deg
        angle between triangles' normals from which their common edge is sharp

    Returns
    -------
    source
        (N,) int64: which of the given vertices each new vertex is a copy of
    triangles
        (F, 3) int32 indices of new vertices
    normals
        (N, 3) float64 unit; +Y where all triangles are without area
    """
    if not len(triangles):
        return np.zeros(0, np.int64), np.zeros((0, 3), np.int32), np.zeros((0, 3))
    corners = positions[triangles]
    face_normals = _face_normals(corners)
    place = welded(positions)[triangles]
    smooth = _smooth_groups(place, face_normals, np.cos(np.radians(crease_deg)))

    weighted = face_normals[:, None, :] * _corner_angles(corners)[..., None]
    sums = np.zeros((3 * len(triangles), 3))
    for axis in range(3):
        sums[:, axis] = np.bincount(smooth, weighted[..., axis].reshape(-1), len(sums))
    lengths = np.linalg.norm(sums, axis=1, keepdims=True)
    normals = np.where(lengths > 1e-12, sums / np.maximum(lengths, 1e-12), [0.0, 1.0, 0.0])

    # One new vertex for each given vertex and each smooth group that it is in.
    pairs = triangles.reshape(-1).astype(np.int64) * len(sums) + smooth
    unique, inverse = np.unique(pairs, return_inverse=True)
    source, group = np.divmod(unique, len(sums))
    return source, inverse.reshape(-1, 3).astype(np.int32), normals[group]


def _face_normals(corners: Doubles) -> Doubles:
    """(F, 3) unit normals; 0 for triangles without area."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.asarray(np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0))


def _corner_angles(corners: Doubles) -> Doubles:
    """(F, 3) angle of each triangle at each of its corners, in radians."""
    angles = np.empty(corners.shape[:2])
    for corner in range(3):
        a = corners[:, (corner + 1) % 3] - corners[:, corner]
        b = corners[:, (corner + 2) % 3] - corners[:, corner]
        sine = np.linalg.norm(np.cross(a, b), axis=1)
        angles[:, corner] = np.arctan2(sine, np.einsum("fk,fk->f", a, b))
    return angles


def _smooth_groups(place: Longs, face_normals: Doubles, crease_cosine: float) -> Longs:
    """(3F,) label of each corner; corners joined across smooth edges have the same."""
    # Half-edges sorted by the places that they join; neighbours in that order share an edge.
    start = place.reshape(-1)
    end = place[:, [1, 2, 0]].reshape(-1)
    low, high = np.minimum(start, end), np.maximum(start, end)
    order = np.lexsort([high, low])
    first, second = order[:-1], order[1:]
    same = (low[first] == low[second]) & (high[first] == high[second])
    facing = np.einsum("ek,ek->e", face_normals[first // 3], face_normals[second // 3])
    opposite = start[first] == end[second]
    # Two sides of an edge that run the same way belong to triangles wound against each other.
    keep = same & opposite & (facing > crease_cosine)
    first, second = first[keep], second[keep]
    # The half-edge of corner c goes from corner c to the next corner of its triangle.
    links_a = np.concatenate([first, _next_corner(first)])
    links_b = np.concatenate([_next_corner(second), second])
    return _connected(links_a, links_b, len(start))


def _next_corner(corner: Longs) -> Longs:
    return corner - corner % 3 + (corner % 3 + 1) % 3


def _connected(a: Longs, b: Longs, count: int) -> Longs:
    """(count,) least member of the connected component of each node, given links between a and b.

    Hooking and pointer jumping after Shiloach and Vishkin 1982: rounds grow as the logarithm of the
    largest component.
    """
    root = np.arange(count)
    open_links: Bools = np.ones(len(a), np.bool_)
    while open_links.any():
        a, b = a[open_links], b[open_links]
        low, high = np.minimum(root[a], root[b]), np.maximum(root[a], root[b])
        np.minimum.at(root, high, low)
        while True:
            jumped = root[root]
            if np.array_equal(jumped, root):
                break
            root = jumped
        open_links = root[a] != root[b]
    return root
