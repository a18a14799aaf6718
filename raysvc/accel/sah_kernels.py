"""A binary tree of boxes by the surface area heuristic, evaluated at bins of centroids.

Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies". Areas are in double
precision, so that scenes of any scale that float32 holds are treated alike.
"""

import numpy as np

from raysvc.jit import inlined, kernel
from raysvc.types import Doubles, Floats, Ints

FAR = np.float32(np.inf)
DEPTH_OF_HALVING = 48
"""From this depth on nodes are halved by count, which bounds the depth of any tree."""
MAX_DEPTH = DEPTH_OF_HALVING + 32
"""No leaf is deeper: 2**32 triangles halve to one in 32 steps."""


@inlined
def half_area(bins: Floats, at: int) -> float:
    """Half of the surface of the box whose six bounds begin at bins[at]; 0 if it is empty."""
    x = np.float64(bins[at + 3]) - np.float64(bins[at])
    y = np.float64(bins[at + 4]) - np.float64(bins[at + 1])
    z = np.float64(bins[at + 5]) - np.float64(bins[at + 2])
    if x < 0.0 or y < 0.0 or z < 0.0:
        return 0.0
    return x * y + y * z + z * x


@inlined
def clear_box(boxes: Floats, at: int) -> None:
    """Make the box at boxes[at] empty: it unites with another to that other."""
    for k in range(3):
        boxes[at + k] = FAR
        boxes[at + 3 + k] = -FAR


@inlined
def unite(boxes: Floats, at: int, others: Floats, other: int) -> None:
    """Extend the box at boxes[at] by the one at others[other]."""
    for k in range(3):
        low, high = others[other + k], others[other + 3 + k]
        boxes[at + k] = low if low < boxes[at + k] else boxes[at + k]
        boxes[at + 3 + k] = high if high > boxes[at + 3 + k] else boxes[at + 3 + k]


@inlined
def bin_of(low: float, high: float, begin: float, scale: float, last: int) -> int:
    """Bin of a centroid; twice the centroid is low + high, and begin is twice the first one's."""
    return min(int((low + high - begin) * scale), last)


@inlined
def sweep(
    bins: Floats, counts: Ints, bin_count: int, base: int, sides: Floats, right_cost: Doubles
) -> tuple[float, int]:
    """Return least (area * count left + area * count right) over an axis' bins, and its first right
    bin.

    `base` is the axis' first bin; a split with an empty side costs inf.
    """
    clear_box(sides, 0)
    count = 0
    for b in range(bin_count - 1, 0, -1):
        count += counts[base + b]
        unite(sides, 0, bins, 6 * (base + b))
        right_cost[b] = half_area(sides, 0) * count if count > 0 else np.inf
    clear_box(sides, 0)
    count = 0
    best, first_right = np.inf, 0
    for b in range(1, bin_count):
        count += counts[base + b - 1]
        unite(sides, 0, bins, 6 * (base + b - 1))
        if count > 0:
            cost = half_area(sides, 0) * count + right_cost[b]
            if cost < best:
                best, first_right = cost, b
    return best, first_right


@kernel
def grow_sah_tree(
    bounds: Floats,
    order: Ints,
    bin_count: int,
    max_leaf: int,
    traversal_cost: float,
    intersection_cost: float,
    boxes: Floats,
    left: Ints,
    axis: Ints,
    first: Ints,
    count: Ints,
) -> int:
    """Build over F >= 1 triangles and return the number of nodes, at most 2 F - 1.

    bounds (6 F,) and order (F,), which holds 0..F-1, are permuted together: a leaf's triangles end
    up side by side. Filled per node: boxes (6 per node), left child or -1 (the right one follows
    it), the axis of the split, and the first and number of its triangles in the order.
    """
    bins = np.empty(18 * bin_count, np.float32)
    bin_counts = np.empty(3 * bin_count, np.int32)
    right_cost = np.empty(bin_count, np.float64)
    sides = np.empty(12, np.float32)
    stack = np.empty(MAX_DEPTH + 2, np.int32)
    depths = np.empty(MAX_DEPTH + 2, np.int32)
    begin = np.empty(3, np.float32)
    scale = np.empty(3, np.float32)
    clear_box(boxes, 0)
    for f in range(len(order)):
        unite(boxes, 0, bounds, 6 * f)
    first[0], count[0] = 0, len(order)
    nodes = 1
    stack[0], depths[0] = 0, 0
    top = 1
    while top > 0:
        top -= 1
        node, depth = stack[top], depths[top]
        start, size = first[node], count[node]
        stop = start + size
        left[node] = -1
        axis[node] = 0
        if size == 1:
            continue

        # The best split over three axes, by bins of centroids.
        best, best_axis, first_right = np.inf, -1, 0
        if depth < DEPTH_OF_HALVING:
            centroid_range(bounds, start, stop, bin_count, begin, scale)
            fill_bins(bounds, start, stop, bin_count, begin, scale, bins, bin_counts)
            for k in range(3):
                if scale[k] > 0.0:
                    cost, b = sweep(bins, bin_counts, bin_count, k * bin_count, sides, right_cost)
                    if cost < best:
                        best, best_axis, first_right = cost, k, b
        area = half_area(boxes, 6 * node)
        if size <= max_leaf and (
            best_axis < 0
            or intersection_cost * size * area <= traversal_cost * area + intersection_cost * best
        ):
            continue

        # Partition in place; without a best split, halve by count.
        middle = start + size // 2
        clear_box(sides, 0)
        clear_box(sides, 6)
        if best_axis >= 0:
            k = best_axis
            middle = partition(
                bounds, order, start, stop, k, begin[k], scale[k], bin_count - 1, first_right
            )
            for b in range(bin_count):
                unite(sides, 0 if b < first_right else 6, bins, 6 * (k * bin_count + b))
        else:
            for f in range(start, stop):
                unite(sides, 0 if f < middle else 6, bounds, 6 * f)
        left[node] = nodes
        axis[node] = max(best_axis, 0)
        for side in range(2):
            for k in range(6):
                boxes[6 * (nodes + side) + k] = sides[6 * side + k]
            stack[top + 1 - side], depths[top + 1 - side] = nodes + side, depth + 1
        first[nodes], count[nodes] = start, middle - start
        first[nodes + 1], count[nodes + 1] = middle, stop - middle
        nodes += 2
        top += 2
    return nodes


@inlined
def centroid_range(
    bounds: Floats, start: int, stop: int, bin_count: int, begin: Floats, scale: Floats
) -> None:
    """Fill twice the least centroid of each axis, and bins per unit of twice a centroid (0: one
    point).
    """
    x0 = y0 = z0 = FAR
    x1 = y1 = z1 = -FAR
    for f in range(start, stop):
        x = bounds[6 * f] + bounds[6 * f + 3]
        y = bounds[6 * f + 1] + bounds[6 * f + 4]
        z = bounds[6 * f + 2] + bounds[6 * f + 5]
        x0, x1 = (x if x < x0 else x0), (x if x > x1 else x1)
        y0, y1 = (y if y < y0 else y0), (y if y > y1 else y1)
        z0, z1 = (z if z < z0 else z0), (z if z > z1 else z1)
    begin[0], begin[1], begin[2] = x0, y0, z0
    scale[0] = bin_count / (np.float64(x1) - x0) if x1 > x0 else 0.0
    scale[1] = bin_count / (np.float64(y1) - y0) if y1 > y0 else 0.0
    scale[2] = bin_count / (np.float64(z1) - z0) if z1 > z0 else 0.0
    for k in range(3):
        if scale[k] == FAR:
            scale[k] = 0.0


@inlined
def fill_bins(
    bounds: Floats,
    start: int,
    stop: int,
    bin_count: int,
    begin: Floats,
    scale: Floats,
    bins: Floats,
    bin_counts: Ints,
) -> None:
    """Fill the box and the number of the triangles of each bin of each axis."""
    for b in range(3 * bin_count):
        bin_counts[b] = 0
        clear_box(bins, 6 * b)
    for f in range(start, stop):
        for k in range(3):
            b = k * bin_count + bin_of(
                bounds[6 * f + k], bounds[6 * f + 3 + k], begin[k], scale[k], bin_count - 1
            )
            bin_counts[b] += 1
            unite(bins, 6 * b, bounds, 6 * f)


@inlined
def partition(
    bounds: Floats,
    order: Ints,
    start: int,
    stop: int,
    axis: int,
    begin: float,
    scale: float,
    last_bin: int,
    first_right: int,
) -> int:
    """Bring the triangles of the bins before `first_right` to the front; return where the others
    begin.
    """
    low, high = start, stop - 1
    while low <= high:
        at = 6 * low
        if bin_of(bounds[at + axis], bounds[at + 3 + axis], begin, scale, last_bin) < first_right:
            low += 1
        else:
            for k in range(6):
                bounds[at + k], bounds[6 * high + k] = bounds[6 * high + k], bounds[at + k]
            order[low], order[high] = order[high], order[low]
            high -= 1
    return low
