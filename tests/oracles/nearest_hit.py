"""Which triangle a ray meets first, in double precision, by testing every pair."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, slots=True)
class Met:
    """R rays against F triangles.

    t (R,) of the nearest hit or inf; all_t (R, F), inf where missed; margin (R, F), how far inside
    a triangle a ray passes, in barycentric weight: negative outside, near 0 where rounding decides.
    """

    t: np.ndarray
    all_t: np.ndarray
    margin: np.ndarray


def nearest_hit(origins, directions, t_max, positions, triangles) -> Met:
    """Intersect planes by their equation, and weigh corners by signed areas."""
    if not len(triangles):
        shape = (len(origins), 0)
        return Met(np.full(len(origins), np.inf), np.empty(shape), np.empty(shape))
    o, d = np.asarray(origins, float)[:, None], np.asarray(directions, float)[:, None]
    a, b, c = np.moveaxis(np.asarray(positions, float)[triangles], 1, 0)[:, None]
    with np.errstate(all="ignore"):
        normal = np.cross(b - a, c - a)
        across = np.sum(normal * d, axis=2)
        # A ray along the plane, to within double precision, meets nothing.
        lengths = np.linalg.norm(normal, axis=2) * np.linalg.norm(d, axis=2)
        across = np.where(np.abs(across) > 1e-14 * lengths, across, np.nan)
        t = np.sum(normal * (a - o), axis=2) / across
        point = o + d * t[..., None]
        area = np.sum(normal * normal, axis=2)
        weights = [
            np.sum(np.cross(q - p, point - p) * normal, axis=2) / area
            for p, q in ((a, b), (b, c), (c, a))
        ]
    margin = np.nan_to_num(np.min(weights, axis=0), nan=-np.inf)
    hit = (margin >= 0) & (t >= 0) & (t <= np.asarray(t_max, float)[:, None]) & np.isfinite(t)
    all_t = np.where(hit, t, np.inf)
    return Met(all_t.min(axis=1), all_t, margin)
