"""Rays through a bounding interval hierarchy, with a stack.

The children of a node may overlap, so that a hit in the nearer one does not end the search: what
lies behind it is only left out when it is taken from the stack. Distances to planes are in double
precision and compared with some slack; nodes are those of `raysvc.accel.bih_build_kernels`, and
some have but one child, between both planes.
"""

from typing import NamedTuple

import numpy as np

from raysvc.accel.bih_build_kernels import CLIP, LEAF, NODE_WORDS
from raysvc.accel.bvh_kernels import NONE
from raysvc.accel.kd_kernels import LESS, MORE
from raysvc.accel.sah_kernels import MAX_DEPTH
from raysvc.geometry.watertight_kernels import distance_to, shear_of
from raysvc.jit import inlined_allocating, kernel
from raysvc.types import Doubles, Floats, Ints


class BihArrays(NamedTuple):
    """nodes (4 N,) float32 and words, the same memory as int32; box (6,) float64 bounds all.

    corners (9 F,) and numbers (F,) are in leaf order.
    """

    nodes: Floats
    words: Ints
    corners: Floats
    numbers: Ints
    box: Doubles


@inlined_allocating
def _trace(
    origins: Floats,
    directions: Floats,
    t_max: Floats,
    tree: BihArrays,
    found: Ints,
    counts: Ints,
    any_hit: bool,
    counting: bool,
) -> None:
    """Fill found (R,) with each ray's nearest, or any, triangle, and counts (R, 8) if counting.

    The flags are constants wherever this is inlined: what they switch off is not compiled.
    """
    nodes, words, corners, numbers = tree.nodes, tree.words, tree.corners, tree.numbers
    box = tree.box
    stack = np.empty(MAX_DEPTH + 2, np.int32)
    enters, exits = np.empty(MAX_DEPTH + 2, np.float64), np.empty(MAX_DEPTH + 2, np.float64)
    origin, inverse = np.empty(3, np.float64), np.empty(3, np.float64)
    near_side = np.empty(3, np.int64)
    for r in range(len(found)):
        enter, leave = 0.0, min(np.float64(t_max[r]), 1e300)
        for k in range(3):
            origin[k] = np.float64(origins[r, k])
            inverse[k] = 1.0 / np.float64(directions[r, k])
            near_side[k] = 1 if inverse[k] < 0.0 else 0
            a, b = (box[k] - origin[k]) * inverse[k], (box[3 + k] - origin[k]) * inverse[k]
            first, last = (b, a) if inverse[k] < 0.0 else (a, b)
            enter, leave = (first if first > enter else enter), (last if last < leave else leave)
        x, y, z, shear_x, shear_y, shear_z = shear_of(
            np.float64(directions[r, 0]),
            np.float64(directions[r, 1]),
            np.float64(directions[r, 2]),
        )
        px, py, pz = origin[x], origin[y], origin[z]
        best: float = np.float64(t_max[r])
        triangle = NONE
        top = 0
        node = np.int32(0)
        enter, leave = enter * LESS, leave * MORE
        searching = enter <= leave
        while searching:
            at = NODE_WORDS * (node & NONE)
            word = words[at + 2]
            axis = word & 3
            if counting:
                counts[r, 0] += 1
            if axis != LEAF:
                if counting:
                    counts[r, 2] += 2
                # What is not a number, of a ray in a plane, leaves both children to be visited.
                side = near_side[axis]
                a = (np.float64(nodes[at]) - origin[axis]) * inverse[axis]
                b = (np.float64(nodes[at + 1]) - origin[axis]) * inverse[axis]
                near, far = (b, a) if side == 1 else (a, b)
                child = word >> 3
                if word & CLIP:
                    enter = near * LESS if near > enter else enter
                    leave = far * MORE if far < leave else leave
                    if enter <= leave:
                        node = child
                        continue
                    meets_near = meets_far = False
                else:
                    meets_near, meets_far = not near < enter, not far > leave
                if meets_near:
                    if meets_far:
                        stack[top] = child + 1 - side
                        enters[top], exits[top] = (far * LESS if far > enter else enter), leave
                        top += 1
                        if counting:
                            counts[r, 4] += 1
                            counts[r, 5] = max(counts[r, 5], top)
                    node = child + side
                    leave = near * MORE if near < leave else leave
                    continue
                if meets_far:
                    node = child + 1 - side
                    enter = far * LESS if far > enter else enter
                    continue
            else:
                if counting:
                    counts[r, 6] += 1
                for n in range(words[at], words[at] + words[at + 1]):
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
            searching = False
            while top > 0 and not searching:
                top -= 1
                searching = enters[top] <= best * MORE
            node, enter, leave = stack[top], enters[top], min(exits[top], best * MORE)
        found[r] = triangle if triangle != NONE else -1


@kernel
def nearest(
    origins: Floats, directions: Floats, t_max: Floats, tree: BihArrays, found: Ints, counts: Ints
) -> None:
    """Fill found (R,) with the nearest triangle, or -1."""
    _trace(origins, directions, t_max, tree, found, counts, False, False)


@kernel
def occluded(
    origins: Floats, directions: Floats, t_max: Floats, tree: BihArrays, found: Ints, counts: Ints
) -> None:
    """Fill found (R,) with any triangle, or -1."""
    _trace(origins, directions, t_max, tree, found, counts, True, False)


@kernel
def counted_nearest(
    origins: Floats, directions: Floats, t_max: Floats, tree: BihArrays, found: Ints, counts: Ints
) -> None:
    """Fill found (R,) with the nearest triangle, and add to counts (R, 8)."""
    _trace(origins, directions, t_max, tree, found, counts, False, True)


@kernel
def counted_occluded(
    origins: Floats, directions: Floats, t_max: Floats, tree: BihArrays, found: Ints, counts: Ints
) -> None:
    """Fill found (R,) with any triangle, and add to counts (R, 8)."""
    _trace(origins, directions, t_max, tree, found, counts, True, True)
