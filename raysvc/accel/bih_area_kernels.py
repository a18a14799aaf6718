"""Nodes of a bounding interval hierarchy from a hierarchy of boxes by the surface area heuristic.

A box has six planes and a node only two: where a ray would often enter a cell without entering the
box in it, nodes before the split clip the cell on both sides of an axis. Such nodes with one child
are those that Sunflow's BoundingIntervalHierarchy, by C. Kulla, adds to Waechter's and Keller's.
"""

import numpy as np

from raysvc.accel.bih_build_kernels import CLIP, LEAF, NODE_WORDS
from raysvc.accel.sah_kernels import MAX_DEPTH
from raysvc.jit import inlined, kernel
from raysvc.types import Doubles, Floats, Ints


@inlined
def _area_between(cell: Doubles, axis: int, low: float, high: float) -> float:
    """Half of the surface of a cell that goes from low to high on one axis."""
    b, c = (axis + 1) % 3, (axis + 2) % 3
    wide, tall = cell[3 + b] - cell[b], cell[3 + c] - cell[c]
    return float(wide * tall + (high - low) * (wide + tall))


@kernel
def lay_out_intervals(
    boxes: Floats,
    left: Ints,
    first: Ints,
    count: Ints,
    axes: Ints,
    cells: Floats,
    nodes: Floats,
    words: Ints,
) -> int:
    """Fill nodes, and words in the same memory, from a binary tree, and return their number.

    The tree is that of `raysvc.accel.sah_kernels`: boxes (6 N,), left, first, count and axes (N,).
    cells (6 N,) becomes the part of space in which the planes let each of its nodes be. Nodes need
    room for 4 N: each of the tree's may be clipped on three axes.
    """
    todo = np.empty((MAX_DEPTH + 2, 2), np.int64)
    cell = np.empty(6, np.float64)
    for k in range(6):
        cells[k] = boxes[k]
    todo[0, 0], todo[0, 1] = 0, 0
    top, filled = 1, 1
    while top > 0:
        top -= 1
        node, at = todo[top, 0], NODE_WORDS * todo[top, 1]
        for k in range(6):
            cell[k] = cells[6 * node + k]

        # A subtree takes a ray some log2 of its triangles in steps: clip if that spares a step.
        steps = np.log2(np.float64(count[node])) + 1.0
        while True:
            area = _area_between(cell, 0, cell[0], cell[3])
            least, axis = area, 0
            for k in range(3):
                low, high = np.float64(boxes[6 * node + k]), np.float64(boxes[6 * node + 3 + k])
                narrowed = _area_between(cell, k, low, high)
                if narrowed < least:
                    least, axis = narrowed, k
            if not (area - least) * steps > area:
                break
            low, high = boxes[6 * node + axis], boxes[6 * node + 3 + axis]
            nodes[at], nodes[at + 1] = low, high
            words[at + 2], words[at + 3] = 8 * filled + CLIP + axis, 0
            cell[axis], cell[3 + axis] = low, high
            at = NODE_WORDS * filled
            filled += 1
        for k in range(6):
            cells[6 * node + k] = cell[k]

        if left[node] < 0:
            words[at], words[at + 1], words[at + 2], words[at + 3] = (
                first[node],
                count[node],
                LEAF,
                0,
            )
            continue
        axis, child = axes[node], np.int64(left[node])
        left_max, right_min = boxes[6 * child + 3 + axis], boxes[6 * child + 6 + axis]
        nodes[at], nodes[at + 1] = left_max, right_min
        words[at + 2], words[at + 3] = 8 * filled + axis, 0
        for side in range(2):
            for k in range(6):
                cells[6 * (child + side) + k] = cell[k]
            todo[top + 1 - side, 0], todo[top + 1 - side, 1] = child + side, filled + side
        cells[6 * child + 3 + axis] = min(cell[3 + axis], np.float64(left_max))
        cells[6 * child + 6 + axis] = max(cell[axis], np.float64(right_min))
        top += 2
        filled += 2
    return filled
