"""The same surfaces in more triangles, to measure what triangles alone cost."""

from dataclasses import replace

import numpy as np

from raysvc.geometry.transform import unit
from raysvc.scene import Scene
from raysvc.types import Doubles, Floats, Longs


def tessellated(scene: Scene, parts: int) -> Scene:
    """Return a scene with every triangle cut into `parts` x `parts` alike.

    Positions, texture coordinates and colours between the vertices are where they were, and edges
    that met still meet in the same bits; normals and tangents are unit again at every new vertex.
    So it is the same picture, but for normals that turn a little more evenly.
    """
    if parts == 1:
        return scene
    place, cut = _grid(parts)
    corners = scene.triangles

    def between(values: Floats) -> Doubles:
        """(F * V, C) what (N, C) values of vertices are at the V places of each triangle."""
        wide = values.reshape(len(values), -1).astype(np.float64)
        a, b, c = (wide[corners[:, k], None] * place[:, k, None] for k in range(3))
        # Where one of three terms is zero their order does not matter, so edges agree.
        mixed: Doubles = ((a + b + c) / parts).reshape(-1, wide.shape[1])
        return mixed

    tangents = between(scene.tangents)
    handed = np.repeat(_common(scene.tangents[corners, 3]), len(place))
    first = len(place) * np.arange(len(corners), dtype=np.int64)
    return replace(
        scene,
        positions=_floats(between(scene.positions)),
        normals=_floats(unit(between(scene.normals))),
        tangents=_floats(np.column_stack([unit(tangents[:, :3]), handed])),
        uv=_floats(between(scene.uv)).reshape(-1, 2, 2),
        colours=_floats(between(scene.colours)),
        triangles=(first[:, None, None] + cut).reshape(-1, 3).astype(np.int32),
        material_of_triangle=np.repeat(scene.material_of_triangle, len(cut)),
        object_of_triangle=np.repeat(scene.object_of_triangle, len(cut)),
    )


def _grid(parts: int) -> tuple[Doubles, Longs]:
    """Places in a triangle as (V, 3) whole barycentric weights that add up to `parts`, and the
    (parts^2, 3) triangles between them, turning as it does."""
    row, col = np.nonzero(np.add.outer(np.arange(parts + 1), np.arange(parts + 1)) <= parts)
    number = np.full((parts + 2, parts + 2), -1)
    number[row, col] = np.arange(len(row))
    upright = row + col < parts
    r, c = row[upright], col[upright]
    along = np.column_stack([number[r, c], number[r + 1, c], number[r, c + 1]])
    turned = row + col < parts - 1
    r, c = row[turned], col[turned]
    against = np.column_stack([number[r + 1, c], number[r + 1, c + 1], number[r, c + 1]])
    weights = np.column_stack([parts - row - col, row, col]).astype(np.float64)
    return weights, np.concatenate([along, against]).astype(np.int64)


def _common(handed: Floats) -> Floats:
    """(F,) of (F, 3): what all three say, or 0, which leaves the tangent to the shader, as it does
    where vertices disagree."""
    agree = (handed[:, :1] == handed).all(axis=1)
    return np.where(agree, handed[:, 0], np.float32(0.0))


def _floats(values: Doubles) -> Floats:
    return np.ascontiguousarray(values, np.float32)
