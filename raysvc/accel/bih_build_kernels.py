"""A bounding interval hierarchy: nodes with two planes each, that bound their children on one axis.

Waechter and Keller 2006, "Instant Ray Tracing: The Bounding Interval Hierarchy": triangles go to
the half of a regular voxel in which their middle is, and planes then fit them. Nodes from another
hierarchy, by area, are made in `raysvc.accel.bih_area_kernels`.
"""

import numpy as np

from raysvc.accel.sah_kernels import DEPTH_OF_HALVING, MAX_DEPTH
from raysvc.jit import inlined, kernel
from raysvc.types import Doubles, Floats, Ints

LEAF = 3
"""In place of an inner node's axis."""
CLIP = 4
"""Added to the axis of a node that has but one child, between its two planes."""
NODE_WORDS = 4


@inlined
def _longest(voxel: Doubles) -> int:
    """Axis along which a box is longest."""
    x, y, z = voxel[3] - voxel[0], voxel[4] - voxel[1], voxel[5] - voxel[2]
    if x >= y and x >= z:
        return 0
    return 1 if y >= z else 2


@inlined
def _partition(bounds: Floats, order: Ints, start: int, stop: int, axis: int, plane: float) -> int:
    """Bring triangles with their middle before the plane to the front; return where
    others begin.
    """
    low, high = start, stop - 1
    while low <= high:
        at = 6 * low
        if 0.5 * (np.float64(bounds[at + axis]) + bounds[at + 3 + axis]) < plane:
            low += 1
        else:
            for k in range(6):
                bounds[at + k], bounds[6 * high + k] = bounds[6 * high + k], bounds[at + k]
            order[low], order[high] = order[high], order[low]
            high -= 1
    return low


@kernel
def grow_interval_tree(
    bounds: Floats,
    order: Ints,
    whole: Doubles,
    max_leaf: int,
    empty_cut: float,
    nodes: Floats,
    words: Ints,
) -> int:
    """Build over F >= 1 triangles in the box whole (6,) and return the number of nodes.

    bounds (6 F,) and order (F,), which holds 0..F-1, are permuted together. Nodes, whose memory
    words shows as integers, are four words: greatest coordinate on the left, least on the right,
    and 8 * left child + axis; or, for a leaf, its first triangle, its number of them, and LEAF.
    When there is no more room for nodes, or it gets too deep, triangles are halved by count.

    Splits are by the middle of regular voxels: one of which a half is empty becomes a node with an
    empty leaf if that cuts off at least the part `empty_cut` of the cell, and else only shrinks.
    """
    todo = np.empty((MAX_DEPTH + 2, 4), np.int64)
    voxels = np.empty((MAX_DEPTH + 2, 6), np.float64)
    cells = np.empty((MAX_DEPTH + 2, 6), np.float64)
    voxel, cell = np.empty(6, np.float64), np.empty(6, np.float64)
    voxels[0], cells[0] = whole, whole
    todo[0, 0], todo[0, 1], todo[0, 2], todo[0, 3] = 0, 0, len(order), 0
    # So many nodes with an empty child may still be made: others number at most 2 F - 1.
    spare = len(words) // NODE_WORDS // 2 - len(order)
    top, count = 1, 1
    while top > 0:
        top -= 1
        node, start, stop, depth = todo[top, 0], todo[top, 1], todo[top, 2], todo[top, 3]
        for k in range(6):
            voxel[k], cell[k] = voxels[top, k], cells[top, k]
        size = stop - start
        deep = depth >= DEPTH_OF_HALVING
        if size <= max_leaf:
            words[NODE_WORDS * node], words[NODE_WORDS * node + 1] = start, size
            words[NODE_WORDS * node + 2] = LEAF
            continue

        # Halve the voxel until that parts the triangles, or cuts off enough empty space.
        while True:
            axis = _longest(voxel)
            plane = 0.5 * (voxel[axis] + voxel[3 + axis])
            deep = deep or not voxel[axis] < plane < voxel[3 + axis]
            middle = start + size // 2
            if not deep:
                middle = _partition(bounds, order, start, stop, axis, plane)
            left_max, right_min = np.float32(-np.inf), np.float32(np.inf)
            for f in range(start, middle):
                left_max = max(left_max, bounds[6 * f + 3 + axis])
            for f in range(middle, stop):
                right_min = min(right_min, bounds[6 * f + axis])
            if deep or start < middle < stop:
                break
            extent = cell[3 + axis] - cell[axis]
            cut = right_min - cell[axis] if middle == start else cell[3 + axis] - left_max
            if spare > 0 and cut >= empty_cut * extent > 0.0:
                break
            voxel[axis if middle == start else 3 + axis] = plane
        if middle == start or middle == stop:
            spare -= 1

        at = NODE_WORDS * node
        nodes[at], nodes[at + 1] = left_max, right_min
        words[at + 2], words[at + 3] = 8 * count + axis, 0
        for side in range(2):
            for k in range(6):
                voxels[top + side, k], cells[top + side, k] = voxel[k], cell[k]
            todo[top + side, 0], todo[top + side, 3] = count + side, depth + 1
        voxels[top, 3 + axis] = voxels[top + 1, axis] = plane
        cells[top, 3 + axis] = min(cell[3 + axis], np.float64(left_max))
        cells[top + 1, axis] = max(cell[axis], np.float64(right_min))
        todo[top, 1], todo[top, 2] = start, middle
        todo[top + 1, 1], todo[top + 1, 2] = middle, stop
        top += 2
        count += 2
    return count


@kernel
def cells_of(
    nodes: Floats, words: Ints, whole: Doubles, boxes: Floats, left: Ints, first: Ints, count: Ints
) -> None:
    """Fill boxes (6 N,) as the planes bound them, left child or -1, and the leaves' triangles."""
    for k in range(6):
        boxes[k] = whole[k]
    for node in range(len(left)):
        at = NODE_WORDS * node
        axis, child = words[at + 2] & 3, words[at + 2] >> 3
        if axis == LEAF:
            left[node], first[node], count[node] = -1, words[at], words[at + 1]
            continue
        left[node], first[node], count[node] = child, 0, 0
        for k in range(6):
            boxes[6 * child + k] = boxes[6 * node + k]
            boxes[6 * child + 6 + k] = boxes[6 * node + k]
        boxes[6 * child + 3 + axis] = min(boxes[6 * node + 3 + axis], nodes[at])
        boxes[6 * child + 6 + axis] = max(boxes[6 * node + axis], nodes[at + 1])
