"""Rays through a two-wide hierarchy of boxes, with a stack.

An inner node is 16 words, one cache line: for x, y and z the low bound of both children and the
high bound of both, then both links, as integers. A link >= 0 is an inner node, else it is the
complement of first * LEAF + count of a leaf's triangles in leaf order.

The slab test is Kay and Kajiya's, made safe against rounding as in Ize 2013, "Robust BVH Ray
Traversal"; a product 0 * inf is NaN, and loses every comparison as they are written here.
"""

from typing import NamedTuple

import numpy as np

from raysvc.accel.sah_kernels import MAX_DEPTH
from raysvc.geometry.watertight_kernels import distance_to, shear_of
from raysvc.jit import inlined_allocating, kernel
from raysvc.types import Floats, Ints

LEAF = 32
"""A leaf holds fewer triangles than this."""
NODE_WORDS = 16
NONE = 2**31 - 1
"""Stands for no triangle while one is looked for: any other has a lower number."""
FINISHED = -(2**31)
"""The link at the bottom of the stack."""
SLACK = np.float32(1.0 + 2.0 * (3 * 2.0**-24) / (1.0 - 3 * 2.0**-24))
"""1 + 2 gamma(3): how much farther a box may end than rounding says."""
FAREST = np.float32(1e38)
"""Limit of what boxes are compared with: one that begins at infinity is behind it."""


class BvhArrays(NamedTuple):
    """nodes (16 N,) float32 and links, the same memory as int32; corners (9 F,) and numbers (F,) in
    leaf order.
    """

    nodes: Floats
    links: Ints
    corners: Floats
    numbers: Ints
    root: int


@inlined_allocating
def _trace(
    origins: Floats,
    directions: Floats,
    t_max: Floats,
    tree: BvhArrays,
    found: Ints,
    counts: Ints,
    any_hit: bool,
    counting: bool,
) -> None:
    """Fill found (R,) with the nearest, or with any, triangle of each ray, and counts (R, 8) if
    counting.

    Both flags are constants wherever this is inlined, so that what they switch off is not compiled.
    """
    nodes, links, corners, numbers = tree.nodes, tree.links, tree.corners, tree.numbers
    stack = np.empty(MAX_DEPTH + 2, np.int32)
    stack_t = np.empty(MAX_DEPTH + 2, np.float32)
    zero = np.float32(0.0)
    stack[0], stack_t[0] = FINISHED, np.float32(-1.0)
    for r in range(len(found)):
        ox, oy, oz = origins[r, 0], origins[r, 1], origins[r, 2]
        rx = np.float32(1.0) / directions[r, 0]
        ry = np.float32(1.0) / directions[r, 1]
        rz = np.float32(1.0) / directions[r, 2]
        # Words of the bounds that the ray enters by; it leaves by the other ones.
        in_x, in_y, in_z = (
            (2 if rx < zero else 0),
            (6 if ry < zero else 4),
            (10 if rz < zero else 8),
        )
        out_x, out_y, out_z = 2 - in_x, 10 - in_y, 18 - in_z
        x, y, z, shear_x, shear_y, shear_z = shear_of(
            np.float64(directions[r, 0]), np.float64(directions[r, 1]), np.float64(directions[r, 2])
        )
        px, py, pz = np.float64(origins[r, x]), np.float64(origins[r, y]), np.float64(origins[r, z])
        best: float = np.float64(t_max[r])
        triangle = NONE
        limit = min(np.float32(best), FAREST)
        top = 0
        link = np.int32(tree.root)
        while True:
            if link >= 0:
                at = (link & NONE) * NODE_WORDS
                if counting:
                    counts[r, 0] += 1
                    counts[r, 1] += 2
                near_0, near_1, far_0, far_1 = zero, zero, limit, limit
                a, b = (nodes[at + in_x] - ox) * rx, (nodes[at + in_x + 1] - ox) * rx
                near_0, near_1 = (a if a > near_0 else near_0), (b if b > near_1 else near_1)
                a, b = (nodes[at + in_y] - oy) * ry, (nodes[at + in_y + 1] - oy) * ry
                near_0, near_1 = (a if a > near_0 else near_0), (b if b > near_1 else near_1)
                a, b = (nodes[at + in_z] - oz) * rz, (nodes[at + in_z + 1] - oz) * rz
                near_0, near_1 = (a if a > near_0 else near_0), (b if b > near_1 else near_1)
                a, b = (nodes[at + out_x] - ox) * rx, (nodes[at + out_x + 1] - ox) * rx
                far_0, far_1 = (a if a < far_0 else far_0), (b if b < far_1 else far_1)
                a, b = (nodes[at + out_y] - oy) * ry, (nodes[at + out_y + 1] - oy) * ry
                far_0, far_1 = (a if a < far_0 else far_0), (b if b < far_1 else far_1)
                a, b = (nodes[at + out_z] - oz) * rz, (nodes[at + out_z + 1] - oz) * rz
                far_0, far_1 = (a if a < far_0 else far_0), (b if b < far_1 else far_1)
                meets_0, meets_1 = near_0 <= far_0 * SLACK, near_1 <= far_1 * SLACK
                if meets_0 and meets_1:
                    second = near_1 < near_0
                    top += 1
                    stack[top] = links[at + 12] if second else links[at + 13]
                    stack_t[top] = near_0 if second else near_1
                    link = links[at + 13] if second else links[at + 12]
                    if counting:
                        counts[r, 4] += 1
                        counts[r, 5] = max(counts[r, 5], top)
                    continue
                if meets_0 or meets_1:
                    link = links[at + 12] if meets_0 else links[at + 13]
                    continue
            else:
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
            while stack_t[top] > limit * SLACK:
                top -= 1
            link = stack[top]
            if link == FINISHED:
                break
            top -= 1
        found[r] = triangle if triangle != NONE else -1


@kernel
def nearest(
    origins: Floats, directions: Floats, t_max: Floats, tree: BvhArrays, found: Ints, counts: Ints
) -> None:
    """Fill found (R,) with the nearest triangle, or -1."""
    _trace(origins, directions, t_max, tree, found, counts, False, False)


@kernel
def occluded(
    origins: Floats, directions: Floats, t_max: Floats, tree: BvhArrays, found: Ints, counts: Ints
) -> None:
    """Fill found (R,) with any triangle, or -1."""
    _trace(origins, directions, t_max, tree, found, counts, True, False)


@kernel
def counted_nearest(
    origins: Floats, directions: Floats, t_max: Floats, tree: BvhArrays, found: Ints, counts: Ints
) -> None:
    """Like nearest, and add to counts (R, 8)."""
    _trace(origins, directions, t_max, tree, found, counts, False, True)


@kernel
def counted_occluded(
    origins: Floats, directions: Floats, t_max: Floats, tree: BvhArrays, found: Ints, counts: Ints
) -> None:
    """Like occluded, and add to counts (R, 8)."""
    _trace(origins, directions, t_max, tree, found, counts, True, True)


@kernel
def lay_out(
    boxes: Floats, left: Ints, first: Ints, count: Ints, number: Ints, nodes: Floats, links: Ints
) -> int:
    """Fill nodes and links from a binary tree, number (N,) being scratch; return the
    root's link.
    """
    inner = 0
    for node in range(len(left)):
        if left[node] >= 0:
            number[node] = inner
            inner += 1
        else:
            number[node] = ~(first[node] * LEAF + count[node])
    for node in range(len(left)):
        if left[node] < 0:
            continue
        at = NODE_WORDS * number[node]
        for side in range(2):
            child = left[node] + side
            for k in range(3):
                nodes[at + 4 * k + side] = boxes[6 * child + k]
                nodes[at + 4 * k + 2 + side] = boxes[6 * child + 3 + k]
            links[at + 12 + side] = number[child]
            links[at + 14 + side] = 0
    return int(number[0])
