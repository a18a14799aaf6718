"""A kd-tree by the surface area heuristic, with references clipped to their cells.

Wald and Havran 2006, "On building fast kd-Trees for Ray Tracing, and on doing that in O(N log N)":
the cost of a split, the bonus for empty space, triangles in the plane on the cheaper side, perfect
splits, and the greatest depth. Large cells consider planes at equal distances (Hunt, Mark and Stoll
2006); small ones every plane at which the cost can have its minimum, by sorting the ends of the
clipped triangles.
"""

from typing import TypeVar

import numpy as np

from raysvc.accel.clip_kernels import POLYGON, clip_bounds
from raysvc.jit import inlined, inlined_allocating, kernel
from raysvc.types import Doubles, Floats, Ints, Longs

Array = TypeVar("Array", Floats, Ints)

MAX_DEPTH = 62
"""No leaf is deeper, whatever is asked for; 8 + 1.3 log2 N reaches it beyond 2**41 triangles."""
LEAF = 3
"""In place of an inner node's axis."""


@inlined
def _cost(
    box: Doubles, axis: int, plane: float, left: int, right: int, costs: tuple[float, float, float]
) -> float:
    """Expected cost of a cell split at a plane; costs are of a step, a triangle, and the
    empty bonus.
    """
    b, c = (axis + 1) % 3, (axis + 2) % 3
    wide, high = box[3 + b] - box[b], box[3 + c] - box[c]
    face, girth = wide * high, wide + high
    whole = face + (box[3 + axis] - box[axis]) * girth
    if whole <= 0.0:
        return np.inf
    to_left = (face + (plane - box[axis]) * girth) * left
    to_right = (face + (box[3 + axis] - plane) * girth) * right
    traversal, intersection, bonus = costs
    cost = traversal + intersection * (to_left + to_right) / whole
    return float(cost * (1.0 - bonus) if left == 0 or right == 0 else cost)


@inlined
def _best_of_bins(
    bounds: Floats,
    start: int,
    stop: int,
    box: Doubles,
    bins: int,
    ends: Longs,
    costs: tuple[float, float, float],
) -> tuple[float, int, float]:
    """Least cost, axis and plane among planes at equal distances; ends (2 bins,) is scratch."""
    best, best_axis, best_plane = np.inf, -1, 0.0
    for axis in range(3):
        begin, extent = box[axis], box[3 + axis] - box[axis]
        if not extent > 0.0:
            continue
        for b in range(2 * bins):
            ends[b] = 0
        for f in range(start, stop):
            low = int((bounds[6 * f + axis] - begin) / extent * bins)
            high = int((bounds[6 * f + 3 + axis] - begin) / extent * bins)
            ends[max(min(low, bins - 1), 0)] += 1
            ends[bins + max(min(high, bins - 1), 0)] += 1
        left, right = 0, stop - start
        for b in range(1, bins):
            left += ends[b - 1]
            right -= ends[bins + b - 1]
            plane = np.float64(np.float32(begin + extent * b / bins))
            if begin < plane < box[3 + axis]:
                cost = _cost(box, axis, plane, left, right, costs)
                if cost < best:
                    best, best_axis, best_plane = cost, axis, plane
    return best, best_axis, best_plane


@inlined_allocating
def _best_of_all(
    bounds: Floats,
    start: int,
    stop: int,
    box: Doubles,
    lows: Floats,
    highs: Floats,
    flats: Floats,
    costs: tuple[float, float, float],
) -> tuple[float, int, float, bool]:
    """Least cost, axis and plane among all ends of triangles, and whether those in it go to the
    left.

    lows, highs and flats hold at least stop - start numbers, and are scratch.
    """
    best, best_axis, best_plane, flat_left = np.inf, -1, 0.0, True
    count = stop - start
    for axis in range(3):
        flat = 0
        for n in range(count):
            lows[n] = bounds[6 * (start + n) + axis]
            highs[n] = bounds[6 * (start + n) + 3 + axis]
            if lows[n] == highs[n]:
                flats[flat] = lows[n]
                flat += 1
        lows[:count].sort()
        highs[:count].sort()
        flats[:flat].sort()
        # Planes in ascending order: below the plane begin `low` triangles, and end above it all but
        # `high`; those in it are in neither number.
        low = high = first_flat = 0
        while high < count:
            at = highs[high]
            if low < count and lows[low] < at:
                at = lows[low]
            while high < count and highs[high] <= at:
                high += 1
            while first_flat < flat and flats[first_flat] < at:
                first_flat += 1
            last_flat = first_flat
            while last_flat < flat and flats[last_flat] == at:
                last_flat += 1
            plane = np.float64(at)
            if box[axis] < plane < box[3 + axis]:
                within = last_flat - first_flat
                cost = _cost(box, axis, plane, low + within, count - high, costs)
                if cost < best:
                    best, best_axis, best_plane, flat_left = cost, axis, plane, True
                if within > 0:
                    cost = _cost(box, axis, plane, low, count - high + within, costs)
                    if cost < best:
                        best, best_axis, best_plane, flat_left = cost, axis, plane, False
            while low < count and lows[low] <= at:
                low += 1
    return best, best_axis, best_plane, flat_left


@inlined_allocating
def _grown(array: Array, length: int) -> Array:
    """A longer array with the same beginning."""
    longer = np.empty(length, array.dtype)
    longer[: len(array)] = array
    return longer


@kernel
def grow_kd_tree(
    corners: Floats,
    whole: Doubles,
    bounds: Floats,
    max_leaf: int,
    max_depth: int,
    bins: int,
    exact_below: int,
    costs: tuple[float, float, float],
) -> tuple[Ints, Ints, int, int]:
    """Build over F >= 1 triangles in the box whole (6,); bounds (6 F,) are those of the triangles.

    Returns the nodes, two words each, the references of the leaves to triangles, and how many of
    both are filled. A node is (bits of the plane, 4 * left child + axis), the right child following
    the left one, or (first reference, 4 * count + 3) for a leaf.
    """
    count = len(corners) // 9
    # References of cells not yet done, one cell after the other; the last is done first.
    names = np.arange(2 * count + 64).astype(np.int32)
    boxes = _grown(bounds, 6 * (2 * count + 64))
    right_names = np.empty(count, np.int32)
    right_boxes = np.empty(6 * count, np.float32)
    nodes = np.empty(2 * max(count, 16), np.int32)
    references = np.empty(2 * count + 64, np.int32)
    cells = np.empty((MAX_DEPTH + 3, 6), np.float64)
    todo = np.empty((MAX_DEPTH + 3, 4), np.int64)
    box, part = np.empty(6, np.float64), np.empty(6, np.float64)
    polygon, other = np.empty(POLYGON, np.float64), np.empty(POLYGON, np.float64)
    clipped = np.empty(6, np.float32)
    ends = np.empty(2 * bins, np.int64)
    lows, highs = np.empty(exact_below, np.float32), np.empty(exact_below, np.float32)
    flats = np.empty(exact_below, np.float32)
    bits = np.empty(1, np.float32)
    node_count, reference_count = 1, 0
    cells[0] = whole
    todo[0, 0], todo[0, 1], todo[0, 2], todo[0, 3] = 0, 0, count, 0
    top = 1
    while top > 0:
        top -= 1
        node, start, stop, depth = todo[top, 0], todo[top, 1], todo[top, 2], todo[top, 3]
        for k in range(6):
            box[k] = cells[top, k]
        size = stop - start
        best, axis, plane, flat_left = np.inf, -1, 0.0, True
        if size > max_leaf and depth < max_depth:
            if size > exact_below:
                best, axis, plane = _best_of_bins(boxes, start, stop, box, bins, ends, costs)
            else:
                best, axis, plane, flat_left = _best_of_all(
                    boxes, start, stop, box, lows, highs, flats, costs
                )
        if axis < 0 or best >= costs[1] * size:
            if reference_count + size > len(references):
                references = _grown(references, 2 * (reference_count + size))
            for n in range(size):
                references[reference_count + n] = names[start + n]
            nodes[2 * node], nodes[2 * node + 1] = reference_count, 4 * size + LEAF
            reference_count += size
            continue

        # Those on the left stay at the front, those on the right wait aside.
        if size > len(right_names):
            right_names, right_boxes = np.empty(size, np.int32), np.empty(6 * size, np.float32)
        left_count = right_count = 0
        for n in range(start, stop):
            low, high = boxes[6 * n + axis], boxes[6 * n + 3 + axis]
            to_left = low < plane or (low == high and low == plane and flat_left)
            to_right = high > plane or (low == high and low == plane and not flat_left)
            name = names[n]
            split = to_left and to_right
            if split:
                # Both parts' bounds, from the triangle clipped to both cells.
                for k in range(6):
                    part[k] = box[k]
                    clipped[k] = boxes[6 * n + k]
                part[axis] = plane
                clipped[axis] = plane
                inside = clip_bounds(corners, 9 * name, part, polygon, other, clipped)
                part[axis], part[3 + axis] = box[axis], plane
                to_right = inside
                if inside:
                    for k in range(6):
                        right_boxes[6 * right_count + k] = clipped[k]
                for k in range(6):
                    clipped[k] = boxes[6 * n + k]
                clipped[3 + axis] = plane
                to_left = clip_bounds(corners, 9 * name, part, polygon, other, clipped)
                if to_left:
                    for k in range(6):
                        boxes[6 * (start + left_count) + k] = clipped[k]
            elif to_left:
                for k in range(6):
                    boxes[6 * (start + left_count) + k] = boxes[6 * n + k]
            else:
                for k in range(6):
                    right_boxes[6 * right_count + k] = boxes[6 * n + k]
            if to_left:
                names[start + left_count] = name
                left_count += 1
            if to_right:
                right_names[right_count] = name
                right_count += 1

        middle = start + left_count
        if middle + right_count > len(names):
            names = _grown(names, 2 * (middle + right_count))
            boxes = _grown(boxes, 6 * len(names))
        names[middle : middle + right_count] = right_names[:right_count]
        boxes[6 * middle : 6 * (middle + right_count)] = right_boxes[: 6 * right_count]
        if 2 * (node_count + 2) > len(nodes):
            nodes = _grown(nodes, 2 * len(nodes))
        bits[0] = plane
        nodes[2 * node] = bits.view(np.int32)[0]
        nodes[2 * node + 1] = 4 * node_count + axis
        # The right cell is on top: its references are the last ones.
        for side in range(2):
            for k in range(6):
                cells[top + side, k] = box[k]
            todo[top + side, 0] = node_count + side
            todo[top + side, 3] = depth + 1
        cells[top, 3 + axis] = plane
        cells[top + 1, axis] = plane
        todo[top, 1], todo[top, 2] = start, middle
        todo[top + 1, 1], todo[top + 1, 2] = middle, middle + right_count
        node_count += 2
        top += 2
    return nodes, references, node_count, reference_count


@kernel
def cells_of(
    nodes: Ints, planes: Floats, whole: Doubles, boxes: Floats, left: Ints, first: Ints, count: Ints
) -> None:
    """Fill boxes (6 N,), left child or -1, and the leaves' first and number of references (N,)."""
    for k in range(6):
        boxes[k] = whole[k]
    for node in range(len(left)):
        axis, child = nodes[2 * node + 1] & 3, nodes[2 * node + 1] >> 2
        if axis == LEAF:
            left[node], first[node], count[node] = -1, nodes[2 * node], child
            continue
        left[node], first[node], count[node] = child, 0, 0
        for k in range(6):
            boxes[6 * child + k] = boxes[6 * node + k]
            boxes[6 * child + 6 + k] = boxes[6 * node + k]
        boxes[6 * child + 3 + axis] = planes[2 * node]
        boxes[6 * child + 6 + axis] = planes[2 * node]
