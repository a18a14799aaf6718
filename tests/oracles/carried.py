"""Normals and tangents of moved vertices, one vertex at a time, by 3 x 3 matrices."""

import numpy as np

from raysvc.scene.carrying_kernels import AGREE


def carried(scene, positions):
    """Normals (V, 3) and tangents (V, 4) float64 at positions (V, 3), of a scene as it was made."""
    before, after = scene.positions.astype(float), np.asarray(positions, np.float32).astype(float)
    maps = [_map(before[t], after[t]) for t in scene.triangles]
    normals, tangents = scene.normals.astype(float), scene.tangents.astype(float)
    for v in range(len(before)):
        normal_kin = [u for u in range(len(before)) if _are_one(scene, after, u, v)]
        tangent_kin = [
            u
            for u in normal_kin
            if scene.tangents[u, 3] == scene.tangents[v, 3]
            and scene.tangents[u, :3].astype(float) @ scene.tangents[v, :3] >= AGREE
        ]
        about = [f for f, t in enumerate(scene.triangles) if set(t) & set(normal_kin)]
        if all((before[scene.triangles[f]] == after[scene.triangles[f]]).all() for f in about):
            continue
        normal, tangent = np.zeros(3), np.zeros(3)
        for f in about:
            if maps[f] is None:
                continue
            matrix, weight = maps[f]
            for u in scene.triangles[f]:
                if u in normal_kin:
                    normal += weight * _unit(np.linalg.inv(matrix).T @ scene.normals[u])
                if u in tangent_kin:
                    tangent += weight * _unit(matrix @ scene.tangents[u, :3])
        if normal.any():
            normals[v] = _unit(normal)
        if scene.tangents[v, 3]:
            tangents[v, :3] = _unit(tangent - normals[v] * (normals[v] @ tangent))
            tangents[v, 3] = scene.tangents[v, 3] if tangents[v, :3].any() else 0.0
    return normals, tangents


def _are_one(scene, after, u, v):
    reach = 4 * np.finfo(np.float32).eps * np.abs(after).max()
    return (
        (scene.positions[u] == scene.positions[v]).all()
        and np.linalg.norm(after[u] - after[v]) <= reach
        and scene.normals[u].astype(float) @ scene.normals[v] >= AGREE
    )


def _map(before, after):
    """The linear map of a triangle's neighbourhood, and its weight; None without area."""
    old, new = (np.stack([p[1] - p[0], p[2] - p[0]], axis=1) for p in (before, after))
    old_normal, new_normal = (np.cross(*e.T) for e in (old, new))
    old_area, new_area = np.linalg.norm(old_normal), np.linalg.norm(new_normal)
    if old_area == 0 or new_area == 0:
        return None
    thickness = np.sqrt(new_area / old_area)
    source = np.column_stack([old, old_normal / old_area])
    target = np.column_stack([new, thickness * new_normal / new_area])
    return target @ np.linalg.inv(source), np.sqrt(old_area * new_area)


def _unit(vector):
    length = np.linalg.norm(vector)
    return vector / length if length > 0 else vector
