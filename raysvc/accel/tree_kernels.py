"""Measures of a binary tree of boxes, and boxes of moved triangles."""

import numpy as np

from raysvc.accel.sah_kernels import clear_box, half_area, unite
from raysvc.jit import kernel
from raysvc.types import Doubles, Floats, Ints


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
