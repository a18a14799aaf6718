"""Everything along one ray, nearest first, and what becomes of the ray there."""

import numpy as np

from tests.oracles.nearest_hit import nearest_hit


def layers(scene, coverage, rays):
    """For each ray a list of (t, triangle, coverage, seen from behind), and whether it is sure.

    coverage (M,) is the alpha of each material, the same all over it. A ray is not sure if rounding
    could change its list: near an edge, at its end, or where two triangles almost touch.
    """
    met = nearest_hit(rays.origins, rays.directions, rays.t_max, scene.positions, scene.triangles)
    p = scene.positions[scene.triangles].astype(float)
    normal = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    alpha = np.asarray(coverage, float)[scene.material_of_triangle]
    found, sure = [], []
    for r in range(len(rays)):
        order = np.argsort(met.all_t[r], kind="stable")
        order = order[np.isfinite(met.all_t[r][order])]
        t = met.all_t[r][order]
        behind = normal[order] @ rays.directions[r].astype(float) > 0
        found.append(list(zip(t, order, alpha[order], behind, strict=True)))
        apart = np.diff(np.concatenate([[0.0], t]))
        sure.append((np.abs(met.margin[r]) > 1e-4).all() and (apart > 1e-3 * t).all())
    return found, np.array(sure)
