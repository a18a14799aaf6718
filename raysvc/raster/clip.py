"""Cut triangles at the near plane and at a guard band around the picture.

Sutherland and Hodgman 1974, "Reentrant Polygon Clipping", one plane at a time, on all triangles at
once. A new vertex is always computed from the inner towards the outer end of its edge, so two
triangles that share the edge get the same bits and no crack opens.
"""

import numpy as np

from raysvc.types import Bools, Doubles, Longs

GUARD_PX = 16384.0
"""Half side, in pixels, of the square about the picture's corner where fixed point is exact."""


def clip(corners: Doubles, near: float, width: int, height: int) -> tuple[Doubles, Longs]:
    """Clip triangles to what can be rasterised.

    Parameters
    ----------
    corners
        (F, 3, 4) homogeneous pixels, as `project` makes them
    near
        least depth in metres that is kept, > 0

    Returns
    -------
    (G, 3, 4) clipped triangles and (G,) the row of `corners` that each came from
    """
    planes = np.array(
        [
            [0.0, 0.0, 0.0, 1.0],
            [1.0, 0.0, GUARD_PX, 0.0],
            [-1.0, 0.0, GUARD_PX, 0.0],
            [0.0, 1.0, GUARD_PX, 0.0],
            [0.0, -1.0, GUARD_PX, 0.0],
        ]
    )
    offsets = np.array([-near, 0.0, 0.0, 0.0, 0.0])
    seen = np.flatnonzero(~_outside(corners, near, width, height))
    corners = corners[seen]
    distances = corners @ planes.T + offsets
    whole = (distances >= 0).all(axis=(1, 2))
    parts, sources = [corners[whole]], [seen[whole]]
    cut, source = corners[~whole], seen[~whole]
    for plane, offset in zip(planes, offsets, strict=True):
        cut, source = _clip_to_plane(cut, source, plane, offset)
    parts.append(cut)
    sources.append(source)
    return np.concatenate(parts), np.concatenate(sources)


def _outside(corners: Doubles, near: float, width: int, height: int) -> Bools:
    """(F,) bool: all three corners are beyond one side of the view, so nothing can be seen."""
    x, y, w, depth = np.moveaxis(corners, 2, 0)
    tests = (depth < near, x < 0, x > width * w, y < 0, y > height * w)
    outside: Bools = np.logical_or.reduce([test.all(axis=1) for test in tests])
    return outside


def _clip_to_plane(
    corners: Doubles, source: Longs, plane: Doubles, offset: float
) -> tuple[Doubles, Longs]:
    distance = corners @ plane + offset
    inside = distance >= 0
    count = inside.sum(axis=1)
    whole = count == 3

    # One corner inside, turned to be the first: the triangle shrinks.
    one = np.flatnonzero(count == 1)
    a, b, c, da, db, dc = _turned(corners[one], distance[one], inside[one].argmax(axis=1))
    shrunk = np.stack([a, _cut(a, b, da, db), _cut(a, c, da, dc)], axis=1)

    # One corner outside, turned to be the first: a quadrilateral stays, in two triangles.
    two = np.flatnonzero(count == 2)
    a, b, c, da, db, dc = _turned(corners[two], distance[two], (~inside[two]).argmax(axis=1))
    ab, ca = _cut(b, a, db, da), _cut(c, a, dc, da)
    first, second = np.stack([ab, b, c], axis=1), np.stack([ab, c, ca], axis=1)

    return (
        np.concatenate([corners[whole], shrunk, first, second]),
        np.concatenate([source[whole], source[one], source[two], source[two]]),
    )


def _turned(corners: Doubles, distance: Doubles, first: Longs) -> tuple[Doubles, ...]:
    """Corners and distances in cyclic order from `first`: orientation is kept."""
    rows = np.arange(len(first))
    order = (first[:, None] + np.arange(3)) % 3
    turned, far = corners[rows[:, None], order], distance[rows[:, None], order]
    return turned[:, 0], turned[:, 1], turned[:, 2], far[:, 0], far[:, 1], far[:, 2]


def _cut(inner: Doubles, outer: Doubles, d_inner: Doubles, d_outer: Doubles) -> Doubles:
    """Where the edge from an inner (d >= 0) to an outer corner (d < 0) meets the plane."""
    return inner + (outer - inner) * (d_inner / (d_inner - d_outer))[:, None]
