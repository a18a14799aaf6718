"""How much surface lies in boxes to whose triangles it does not belong."""

import numpy as np

from raysvc.accel.clip_kernels import POLYGON, area_of, clip_to_box
from raysvc.accel.sah_kernels import MAX_DEPTH
from raysvc.jit import kernel
from raysvc.types import Doubles, Floats, Ints, Longs


@kernel
def leaves_of_triangles(first: Ints, count: Ints, left: Ints, order: Ints, starts: Longs) -> Ints:
    """Leaves that hold each triangle, side by side; starts (F + 1,), zeros, says where
    each begins.
    """
    for node in range(len(left)):
        if left[node] < 0:
            for n in range(first[node], first[node] + count[node]):
                starts[order[n] + 1] += 1
    for f in range(1, len(starts)):
        starts[f] += starts[f - 1]
    leaves = np.empty(len(order), np.int32)
    filled = np.zeros(len(starts), np.int64)
    for node in range(len(left)):
        if left[node] < 0:
            for n in range(first[node], first[node] + count[node]):
                f = order[n]
                leaves[starts[f] + filled[f]] = node
                filled[f] += 1
    return leaves


@kernel
def foreign_area(
    corners: Floats,
    sample: Longs,
    boxes: Floats,
    left: Ints,
    count: Ints,
    starts: Longs,
    leaves: Ints,
    areas: Doubles,
) -> None:
    """Fill areas: of the sample's triangles, and of their parts in nodes that do not hold them.

    Parts in a leaf count once per triangle that it holds, those in an inner node once.
    corners (9 F,) are in the triangles' order; sample (S,) are numbers of triangles.
    """
    parent = np.full(len(left), -1, np.int32)
    for node in range(len(left)):
        if left[node] >= 0:
            parent[left[node]] = parent[left[node] + 1] = node
    holder = np.full(len(left), -1, np.int64)
    stack = np.empty(MAX_DEPTH + 2, np.int32)
    box = np.empty(6, np.float64)
    polygon, other = np.empty(POLYGON, np.float64), np.empty(POLYGON, np.float64)
    areas[0] = areas[1] = 0.0
    for f in sample:
        for n in range(starts[f], starts[f + 1]):
            node = leaves[n]
            while node >= 0 and holder[node] != f:
                holder[node] = f
                node = parent[node]
        for k in range(9):
            polygon[k] = corners[9 * f + k]
        areas[0] += area_of(polygon, 3)
        stack[0] = 0
        top = 1
        while top > 0:
            top -= 1
            node = stack[top]
            if holder[node] != f:
                for k in range(6):
                    box[k] = boxes[6 * node + k]
                inside = area_of(polygon, clip_to_box(corners, 9 * f, box, polygon, other))
                if inside == 0.0:
                    continue
                areas[1] += inside * (1 if left[node] >= 0 else count[node])
            if left[node] >= 0:
                stack[top], stack[top + 1] = left[node], left[node] + 1
                top += 2
