"""Glowing triangles, cut into pieces of about equal power.

Fronts glow, and backs of double-sided materials.
"""

import numpy as np

from raysvc import records
from raysvc.lighting.lamp_kernels import Pieces
from raysvc.lighting.sun import LUMINANCE
from raysvc.scene import Scene
from raysvc.shading.footprint import Footprint
from raysvc.shading.scene_tables import SceneTables
from raysvc.types import Doubles, Ints, Longs

PIECES = 96
"""Into how many pieces of equal power all that glows would be cut if that came out even."""
MAX_PARTS = 16
"""Into how many parts an edge of a triangle is cut at most."""


def pieces_of(
    scene: Scene, tables: SceneTables, triangle: Ints, power: Doubles
) -> tuple[Pieces, Longs]:
    """Cut triangles (T,) of about some power (T,) into pieces; those, and their materials (E,).

    What is black is left out, and every piece glows as its texture does on the mean.
    """
    parts = np.ceil(np.sqrt(PIECES * power / max(power.sum(), 1e-300)))
    owner, begin, size = _cut(np.clip(parts, 1, MAX_PARTS).astype(np.int64))
    corners = scene.positions[scene.triangles[triangle[owner]]].astype(np.float64)
    edges = corners[:, 1:] - corners[:, :1]
    corner = corners[:, 0] + np.einsum("ek,ekc->ec", begin, edges)
    edges *= size[:, None, None]
    normal = np.cross(edges[:, 0], edges[:, 1])
    doubled = np.linalg.norm(normal, axis=1)
    normal /= doubled[:, None]

    number, middle = triangle[owner], (begin + size[:, None] / 3.0).astype(np.float32)
    footprint = Footprint.points(len(number))
    footprint.blur[:] = 0.5 * np.sqrt(doubled)
    front = tables.surface(number, middle, -normal.astype(np.float32), footprint, "mip")
    radiance = front.emissive.astype(np.float64) * tables.alpha(number, middle)[:, None]
    # What is seen from both sides glows on both
    both = np.flatnonzero(tables.double_sided[number])
    side = np.concatenate([np.arange(len(owner)), both])
    normal = np.concatenate([normal, -normal[both]])
    pieces = Pieces(corner[side], edges[side], normal, radiance[side])
    bright = pieces.radiance @ LUMINANCE > 0.0
    return records.chosen(pieces, bright), scene.material_of_triangle[number[side[bright]]]


def _cut(parts: Longs) -> tuple[Longs, Doubles, Doubles]:
    """Cut triangles (T,), each edge into so many parts.

    Returns, for each of E pieces, the number of its triangle, the weights (E, 2) of the triangle's
    edges that lead to the piece's corner, and the piece's size as a part of the triangle's, less
    than 0 for those that stand on their heads.
    """
    owner, begin, size = [], [], []
    for n in np.unique(parts[parts > 0]):
        i, j = np.divmod(np.arange(n * n), n)
        upright, headlong = i + j < n, i + j < n - 1
        places = np.stack([i, j], axis=1)
        corner = np.concatenate([places[upright], places[headlong] + 1]) / n
        sizes = np.concatenate([np.ones(upright.sum()), -np.ones(headlong.sum())]) / n
        of = np.flatnonzero(parts == n)
        owner.append(np.repeat(of, n * n))
        begin.append(np.tile(corner, (len(of), 1)))
        size.append(np.tile(sizes, len(of)))
    if not owner:
        return np.zeros(0, np.int64), np.zeros((0, 2)), np.zeros(0)
    return np.concatenate(owner), np.concatenate(begin), np.concatenate(size)
