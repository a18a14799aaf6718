"""Rays through a hierarchy of boxes by links alone: every node says where to go when it is missed.

Smits 1998, "Efficiency Issues for Ray Tracing", section 3.2. There are two layouts, chosen by a
constant where the traversal is inlined:

- along one thread: 8 words, a node's bounds, its link and its leaf. Nodes are in depth-first order,
  so that the next one is the first child; the link leads past the subtree.
- ordered: 16 words, one cache line: the bounds, the left child or leaf, the axis, and a link for
each octant of directions, so that the child on the ray's side is visited first.

A leaf is the complement of first * LEAF + count; a link past everything is -1.
"""

from typing import NamedTuple

import numpy as np

from raysvc.accel.bvh_kernels import FAREST, LEAF, NONE, SLACK
from raysvc.geometry.watertight_kernels import distance_to, shear_of
from raysvc.jit import inlined, kernel
from raysvc.types import Floats, Ints

THREAD_WORDS = 8
ORDERED_WORDS = 16


class StacklessArrays(NamedTuple):
    """nodes (8 N,) or (16 N,) float32, and links, the same memory as int32.

    corners (9 F,) and numbers (F,) are in leaf order.
    """

    nodes: Floats
    links: Ints
    corners: Floats
    numbers: Ints


@inlined
def _trace(
    origins: Floats,
    directions: Floats,
    t_max: Floats,
    tree: StacklessArrays,
    found: Ints,
    counts: Ints,
    ordered: bool,
    any_hit: bool,
    counting: bool,
) -> None:
    """Fill found (R,) with each ray's nearest, or any, triangle, and counts (R, 8) if counting.

    The flags are constants wherever this is inlined: what they switch off is not compiled.
    """
    nodes, links, corners, numbers = tree.nodes, tree.links, tree.corners, tree.numbers
    zero = np.float32(0.0)
    words = ORDERED_WORDS if ordered else THREAD_WORDS
    for r in range(len(found)):
        ox, oy, oz = origins[r, 0], origins[r, 1], origins[r, 2]
        rx = np.float32(1.0) / directions[r, 0]
        ry = np.float32(1.0) / directions[r, 1]
        rz = np.float32(1.0) / directions[r, 2]
        # Words of the bounds that the ray enters by; it leaves by the other ones.
        in_x, in_y, in_z = (3 if rx < zero else 0), (4 if ry < zero else 1), (5 if rz < zero else 2)
        out_x, out_y, out_z = 3 - in_x, 5 - in_y, 7 - in_z
        octant = (1 if rx < zero else 0) | (2 if ry < zero else 0) | (4 if rz < zero else 0)
        x, y, z, shear_x, shear_y, shear_z = shear_of(
            np.float64(directions[r, 0]), np.float64(directions[r, 1]), np.float64(directions[r, 2])
        )
        px, py, pz = np.float64(origins[r, x]), np.float64(origins[r, y]), np.float64(origins[r, z])
        best: float = np.float64(t_max[r])
        triangle = NONE
        limit = min(np.float32(best), FAREST)
        node = np.int32(0)
        while node >= 0:
            at = (node & NONE) * words
            if counting:
                counts[r, 0] += 1
                counts[r, 1] += 1
            near, far = zero, limit
            a, b = (nodes[at + in_x] - ox) * rx, (nodes[at + out_x] - ox) * rx
            near, far = (a if a > near else near), (b if b < far else far)
            a, b = (nodes[at + in_y] - oy) * ry, (nodes[at + out_y] - oy) * ry
            near, far = (a if a > near else near), (b if b < far else far)
            a, b = (nodes[at + in_z] - oz) * rz, (nodes[at + out_z] - oz) * rz
            near, far = (a if a > near else near), (b if b < far else far)
            if near <= far * SLACK:
                link = links[at + 6] if ordered else links[at + 7]
                if link >= 0:
                    node = link + ((octant >> links[at + 7]) & 1) if ordered else node + 1
                    continue
                leaf = ~link & NONE
                if counting:
                    counts[r, 6] += 1
                for n in range(leaf // LEAF, leaf // LEAF + leaf % LEAF):
                    if counting:
                        counts[r, 3] += 1
                    t = distance_to(corners, 9 * n, x, y, z, shear_x, shear_y, shear_z, px, py, pz)
                    if t >= 0.0 and (t < best or (t == best and numbers[n] < triangle)):
                        best = t
                        triangle = numbers[n]
                        if any_hit:
                            break
                if any_hit and triangle != NONE:
                    break
                limit = min(np.float32(best), FAREST)
            node = links[at + 8 + octant] if ordered else links[at + 6]
        found[r] = triangle if triangle != NONE else -1


@kernel
def nearest_thread(
    origins: Floats,
    directions: Floats,
    t_max: Floats,
    tree: StacklessArrays,
    found: Ints,
    counts: Ints,
) -> None:
    """Fill found (R,) with the nearest triangle, or -1."""
    _trace(origins, directions, t_max, tree, found, counts, False, False, False)


@kernel
def occluded_thread(
    origins: Floats,
    directions: Floats,
    t_max: Floats,
    tree: StacklessArrays,
    found: Ints,
    counts: Ints,
) -> None:
    """Fill found (R,) with any triangle, or -1."""
    _trace(origins, directions, t_max, tree, found, counts, False, True, False)


@kernel
def counted_nearest_thread(
    origins: Floats,
    directions: Floats,
    t_max: Floats,
    tree: StacklessArrays,
    found: Ints,
    counts: Ints,
) -> None:
    """Fill found (R,) with the nearest triangle, and add to counts (R, 8)."""
    _trace(origins, directions, t_max, tree, found, counts, False, False, True)


@kernel
def counted_occluded_thread(
    origins: Floats,
    directions: Floats,
    t_max: Floats,
    tree: StacklessArrays,
    found: Ints,
    counts: Ints,
) -> None:
    """Fill found (R,) with any triangle, and add to counts (R, 8)."""
    _trace(origins, directions, t_max, tree, found, counts, False, True, True)


@kernel
def nearest_ordered(
    origins: Floats,
    directions: Floats,
    t_max: Floats,
    tree: StacklessArrays,
    found: Ints,
    counts: Ints,
) -> None:
    """Fill found (R,) with the nearest triangle, or -1."""
    _trace(origins, directions, t_max, tree, found, counts, True, False, False)


@kernel
def occluded_ordered(
    origins: Floats,
    directions: Floats,
    t_max: Floats,
    tree: StacklessArrays,
    found: Ints,
    counts: Ints,
) -> None:
    """Fill found (R,) with any triangle, or -1."""
    _trace(origins, directions, t_max, tree, found, counts, True, True, False)


@kernel
def counted_nearest_ordered(
    origins: Floats,
    directions: Floats,
    t_max: Floats,
    tree: StacklessArrays,
    found: Ints,
    counts: Ints,
) -> None:
    """Fill found (R,) with the nearest triangle, and add to counts (R, 8)."""
    _trace(origins, directions, t_max, tree, found, counts, True, False, True)


@kernel
def counted_occluded_ordered(
    origins: Floats,
    directions: Floats,
    t_max: Floats,
    tree: StacklessArrays,
    found: Ints,
    counts: Ints,
) -> None:
    """Fill found (R,) with any triangle, and add to counts (R, 8)."""
    _trace(origins, directions, t_max, tree, found, counts, True, True, True)


@kernel
def lay_out_thread(
    boxes: Floats, left: Ints, first: Ints, count: Ints, nodes: Floats, links: Ints
) -> None:
    """Fill nodes and links of a binary tree in depth-first order."""
    # A subtree of n leaves has 2 n - 1 nodes: the left child follows its parent, and the right one
    # follows the left one's subtree.
    size = np.ones(len(left), np.int32)
    for node in range(len(left) - 1, -1, -1):
        if left[node] >= 0:
            size[node] = 1 + size[left[node]] + size[left[node] + 1]
    place = np.zeros(len(left), np.int32)
    skip = np.full(len(left), -1, np.int32)
    for node in range(len(left)):
        at = THREAD_WORDS * place[node]
        for k in range(6):
            nodes[at + k] = boxes[6 * node + k]
        links[at + 6] = skip[node]
        links[at + 7] = 0
        if left[node] < 0:
            links[at + 7] = ~(first[node] * LEAF + count[node])
            continue
        place[left[node]] = place[node] + 1
        place[left[node] + 1] = place[node] + 1 + size[left[node]]
        skip[left[node]] = place[left[node] + 1]
        skip[left[node] + 1] = skip[node]


@kernel
def lay_out_ordered(
    boxes: Floats, left: Ints, axis: Ints, first: Ints, count: Ints, nodes: Floats, links: Ints
) -> None:
    """Fill nodes and links of a binary tree in its own order."""
    for octant in range(8):
        links[8 + octant] = -1
    for node in range(len(left)):
        at = ORDERED_WORDS * node
        for k in range(6):
            nodes[at + k] = boxes[6 * node + k]
        links[at + 7] = axis[node]
        if left[node] < 0:
            links[at + 6] = ~(first[node] * LEAF + count[node])
            continue
        links[at + 6] = left[node]
        for octant in range(8):
            near = left[node] + ((octant >> axis[node]) & 1)
            far = 2 * left[node] + 1 - near
            links[ORDERED_WORDS * near + 8 + octant] = far
            links[ORDERED_WORDS * far + 8 + octant] = links[at + 8 + octant]
