"""Measures of a binary tree of boxes, and its boxes and order when triangles have moved."""

import numpy as np

from raysvc.accel.sah_kernels import clear_box, half_area, unite
from raysvc.jit import inlined, kernel
from raysvc.types import Doubles, Floats, Ints

MUCH_LESS = 0.8
"""Children are told apart on another axis than the tree was built with if that leaves less than
this part of the area: near ties are better left as the builder decided them."""


@kernel
def figures_of(boxes: Floats, left: Ints, count: Ints, depth: Ints, figures: Doubles) -> None:
    """Fill depth (N,), and figures: leaves, empty leaves, greatest depth, sum of leaves' depths,
    SAH cost.
    """
    depth[0] = 0
    for k in range(5):
        figures[k] = 0.0
    cost = 0.0
    for node in range(len(left)):
        area = half_area(boxes, 6 * node)
        if left[node] >= 0:
            depth[left[node]] = depth[node] + 1
            depth[left[node] + 1] = depth[node] + 1
            cost += area
        else:
            figures[0] += 1.0
            figures[1] += 1.0 if count[node] == 0 else 0.0
            figures[2] = max(figures[2], np.float64(depth[node]))
            figures[3] += np.float64(depth[node])
            cost += area * count[node]
    whole = half_area(boxes, 0)
    figures[4] = cost / whole if whole > 0.0 else 0.0


@kernel
def refit_boxes(corners: Floats, left: Ints, first: Ints, count: Ints, boxes: Floats) -> None:
    """Fill boxes (6 N,) from the leaves up; corners (9 M,) are those of the triangles in leaf
    order.
    """
    for node in range(len(left) - 1, -1, -1):
        clear_box(boxes, 6 * node)
        if left[node] >= 0:
            unite(boxes, 6 * node, boxes, 6 * left[node])
            unite(boxes, 6 * node, boxes, 6 * left[node] + 6)
            continue
        for corner in range(3 * first[node], 3 * (first[node] + count[node])):
            for k in range(3):
                x = corners[3 * corner + k]
                at = 6 * node + k
                boxes[at] = x if x < boxes[at] else boxes[at]
                boxes[at + 3] = x if x > boxes[at + 3] else boxes[at + 3]


@kernel
def order_children(boxes: Floats, left: Ints, first: Ints, count: Ints, axis: Ints) -> None:
    """Let the lower child of each node be the left one, on the axis that tells the two best apart.

    A traversal that visits children by the sign of the ray's direction along axis (N,), or bounds
    each child on one side of it, is right with any order but quick only with this one. What was
    turned or mirrored since the tree was built would be visited from the far side.
    """
    for node in range(len(left)):
        if left[node] < 0:
            continue
        low, high = left[node], left[node] + 1
        least, best, swap = np.inf, axis[node], False
        for k in range(3):
            before = _centre(boxes, low, k) <= _centre(boxes, high, k)
            area = _bounded_area(boxes, node, low, high, k)
            if not before:
                area = _bounded_area(boxes, node, high, low, k)
            elif k == axis[node]:
                area *= MUCH_LESS
            if area < least:
                least, best, swap = area, k, not before
        axis[node] = best
        if swap:
            for k in range(6):
                other = boxes[6 * low + k]
                boxes[6 * low + k] = boxes[6 * high + k]
                boxes[6 * high + k] = other
            for array in (left, first, count, axis):
                array[low], array[high] = array[high], array[low]


@inlined
def _centre(boxes: Floats, node: int, k: int) -> float:
    """Twice the middle of a node's box on axis k."""
    return np.float64(boxes[6 * node + k]) + np.float64(boxes[6 * node + 3 + k])


@inlined
def _bounded_area(boxes: Floats, node: int, low: int, high: int, k: int) -> float:
    """Half areas of a node's box up to where `low` ends on axis k, and from where `high` begins."""
    a, b = (k + 1) % 3, (k + 2) % 3
    wide = np.float64(boxes[6 * node + 3 + a]) - np.float64(boxes[6 * node + a])
    tall = np.float64(boxes[6 * node + 3 + b]) - np.float64(boxes[6 * node + b])
    below = np.float64(boxes[6 * low + 3 + k]) - np.float64(boxes[6 * node + k])
    above = np.float64(boxes[6 * node + 3 + k]) - np.float64(boxes[6 * high + k])
    return 2.0 * wide * tall + (below + above) * (wide + tall)
