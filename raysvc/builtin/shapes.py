"""Shapes made in code: everything round is a lathe, everything flat a sheet.

A lathe turns a profile about the +Y axis. Each ring of it has its own number of edges, so that
triangles stay equally large where the radius changes, and so that any even number of triangles can
be had exactly: a strip between rings of n and m edges has n + m triangles.
"""

from collections.abc import Sequence

import numpy as np

from raysvc.builtin.mesh import Mesh, merged
from raysvc.types import Doubles, Ints, Longs


def lathe(
    profile: Doubles, edges: Sequence[int] | Longs, profile_normals: Doubles | None = None
) -> Mesh:
    """Turn a profile about +Y.

    Parameters
    ----------
    profile
        (M, 2) radius and height of the rings, in the order that puts the outside on the right of
        the walk in the (radius, height) plane: upwards for a cylinder, from the axis outwards for
        a floor that is seen from below
    edges
        (M,) edges of each ring; 0 for a tip, where the radius is 0
    profile_normals
        (M, 2) outward normals in the same plane; by default those of the profile's central
        differences

    Returns
    -------
    A mesh with u along the ring (counter-clockwise seen from above) and v from 1 at the first ring
    to 0 at the last, by arc length.
    """
    profile = np.asarray(profile, np.float64)
    edges = np.asarray(edges, np.int64)
    along = np.gradient(profile, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    if profile_normals is None:
        profile_normals = np.column_stack([along[:, 1], -along[:, 0]])
    lengths = np.linalg.norm(np.diff(profile, axis=0), axis=1)
    v = 1.0 - np.concatenate([[0.0], np.cumsum(lengths)]) / lengths.sum()

    # Lay the vertices of ring after ring; the last of a ring repeats the first at u = 1.
    ring = np.repeat(np.arange(len(profile)), edges + 1)
    first = np.concatenate([[0], np.cumsum(edges + 1)])[:-1]
    step = np.arange(len(ring)) - first[ring]
    u = np.where(edges[ring] > 0, step / np.maximum(edges[ring], 1), 0.5)
    angle = 2.0 * np.pi * np.where(step == edges[ring], 0.0, u)
    across, back = np.cos(angle), -np.sin(angle)
    radius, height = profile[ring].T
    normal_out, normal_up = profile_normals[ring].T
    tangents = np.column_stack([back, np.zeros(len(ring)), -across, np.ones(len(ring))])
    return Mesh(
        positions=np.column_stack([radius * across, height, radius * back]),
        normals=np.column_stack([normal_out * across, normal_up, normal_out * back]),
        tangents=tangents,
        uv=np.column_stack([u, v[ring]]),
        colours=np.ones((len(ring), 3)),
        triangles=np.concatenate(
            [
                _strip(int(first[i]), int(edges[i]), int(first[i + 1]), int(edges[i + 1]))
                for i in range(len(profile) - 1)
            ]
        ).astype(np.int32),
    )


def _strip(lower: int, lower_edges: int, upper: int, upper_edges: int) -> Longs:
    """Triangles between two rings, given by first vertex and number of edges: one per edge.

    Each edge is joined to the vertex of the other ring that lies between the edges before and
    after its middle; counting middles of the lower ring first on a tie makes the two halves fit.
    """
    low, up = np.arange(lower_edges), np.arange(upper_edges)
    low_middle, up_middle = (low + 0.5) / max(lower_edges, 1), (up + 0.5) / max(upper_edges, 1)
    apex_of_low = np.searchsorted(up_middle, low_middle, side="left")
    apex_of_up = np.searchsorted(low_middle, up_middle, side="right")
    return np.concatenate(
        [
            np.column_stack([lower + low, lower + low + 1, upper + apex_of_low]),
            np.column_stack([upper + up + 1, upper + up, lower + apex_of_up]),
        ]
    ).astype(np.int64)


def apportioned(total: int, weights: Doubles) -> Longs:
    """Share `total` in proportion to weights, exactly, by largest remainders."""
    exact = total * weights / weights.sum()
    shares: Longs = np.floor(exact).astype(np.int64)
    order = np.argsort(shares - exact, kind="stable")
    shares[order[: total - int(shares.sum())]] += 1
    return shares


def torus(major: float, minor: float, rings: int, triangles: int) -> Mesh:
    """Torus about +Y with exactly `triangles` (an even number) over `rings` around its tube."""
    # The first ring is met again at the end, hence counts once: 2 (n_0 + ... + n_last) in all.
    turn = -0.5 * np.pi + 2.0 * np.pi * np.arange(rings + 1) / rings
    turn[-1] = turn[0]
    normals = np.column_stack([np.cos(turn), np.sin(turn)])
    profile = normals * minor + (major, 0.0)
    edges = apportioned(triangles // 2, profile[:-1, 0])
    return lathe(profile, np.append(edges, edges[0]), normals)


def sphere(radius: float, rings: int) -> Mesh:
    """Sphere with nearly equal triangles, about 2.5 rings^2 of them."""
    turn = np.pi * (np.arange(rings + 1) / rings - 0.5)
    normals = np.column_stack([np.cos(turn), np.sin(turn)])
    normals[[0, -1], 0] = 0.0
    edges = np.maximum(np.round(2 * rings * normals[:, 0]).astype(np.int64), 3)
    edges[[0, -1]] = 0
    return lathe(normals * radius, edges, normals)


def disc(radius: float, edges: int, *, facing_up: bool = True) -> Mesh:
    """Flat disc about the origin, with `edges` triangles."""
    if facing_up:
        return lathe(np.array([[radius, 0.0], [0.0, 0.0]]), [edges, 0])
    return lathe(np.array([[0.0, 0.0], [radius, 0.0]]), [0, edges])


def fine_disc(radii: Doubles, triangles: int) -> Mesh:
    """Flat disc facing +Y with exactly `triangles`, in rings of (M,) radii from the outside in."""
    # Strips between all rings and the tip: 2 (n_0 + ... + n_last) - n_0 triangles, hence n_0's
    # parity.
    weights = np.arange(len(radii), 0, -1.0)
    outer = int(triangles * weights[0] / (2 * weights.sum() - weights[0]))
    outer += (triangles - outer) % 2
    edges = apportioned((triangles - outer) // 2, weights[1:])
    profile = np.column_stack([np.append(radii, 0.0), np.zeros(len(radii) + 1)])
    return lathe(profile, [outer, *edges, 0])


def frustum(bottom: float, top: float, height: float, edges: int) -> Mesh:
    """Open side of a cylinder or cone that stands on the origin; a radius of 0 is a tip."""
    profile = np.array([[bottom, 0.0], [top, height]])
    return lathe(profile, [edges if radius > 0 else 0 for radius in (bottom, top)])


def sheet(width: float, depth: float, columns: int, rows: int) -> Mesh:
    """Flat grid in the xz plane about the origin, facing +Y; u follows +X and v +Z."""
    across, along = np.meshgrid(np.linspace(0, 1, columns + 1), np.linspace(0, 1, rows + 1))
    u, v = across.reshape(-1), along.reshape(-1)
    zeros, ones = np.zeros(len(u)), np.ones(len(u))
    return Mesh(
        positions=np.column_stack([(u - 0.5) * width, zeros, (v - 0.5) * depth]),
        normals=np.column_stack([zeros, ones, zeros]),
        tangents=np.column_stack([ones, zeros, zeros, ones]),
        uv=np.column_stack([u, v]),
        colours=np.ones((len(u), 3)),
        triangles=_grid_triangles(columns, rows),
    )


def box(width: float, height: float, depth: float) -> Mesh:
    """Box that stands on the origin: 12 triangles, sharp edges."""
    half = np.array([width, height, depth]) / 2
    top = sheet(width, depth, 1, 1).moved([0, half[1], 0])
    front = sheet(width, height, 1, 1).turned(90, 0).moved([0, 0, half[2]])
    side = sheet(depth, height, 1, 1).turned(90, 0).moved([0, 0, half[0]]).turned(90, 1)
    six = [top, top.turned(180, 0), front, front.turned(180, 1), side, side.turned(180, 1)]
    return merged(six).moved([0, half[1], 0])


def _grid_triangles(columns: int, rows: int) -> Ints:
    """Two triangles per cell of a grid of (rows + 1, columns + 1) vertices."""
    corner = np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)
    here, right = corner.reshape(-1), corner.reshape(-1) + 1
    below, across = here + columns + 1, right + columns + 1
    pairs = np.stack([here, below, across, here, across, right], axis=1)
    return pairs.reshape(-1, 3).astype(np.int32)
