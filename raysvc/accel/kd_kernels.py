"""Rays through a kd-tree, cell by cell from the near to the far, with a stack.

Distances to planes are in double precision and compared with some slack, so that a cell that a ray
only grazes is visited rather than missed. Nodes are those of `raysvc.accel.kd_build_kernels`.
"""

from typing import NamedTuple

import numpy as np

from raysvc.accel.bvh_kernels import NONE
from raysvc.accel.kd_build_kernels import LEAF, MAX_DEPTH
from raysvc.geometry.watertight_kernels import distance_to, shear_of
from raysvc.jit import inlined_allocating, kernel
from raysvc.types import Doubles, Floats, Ints

MAILBOXES = 16
"""Triangles lately tested that a ray remembers, a power of two."""
LESS, MORE = 1.0 - 1e-12, 1.0 + 1e-12
"""Slack of comparisons of distances: far more than rounding."""


class KdArrays(NamedTuple):
    """nodes (2 N,) int32 and planes, the same memory as float32; references (M,) int32 of leaves.

    corners (9 F,) are in the triangles' own order; box (6,) float64 bounds all of them.
    """

    nodes: Ints
    planes: Floats
    references: Ints
    corners: Floats
    box: Doubles


@inlined_allocating
def _trace(
    origins: Floats,
    directions: Floats,
    t_max: Floats,
    tree: KdArrays,
    found: Ints,
    counts: Ints,
    any_hit: bool,
    counting: bool,
) -> None:
    """Fill found (R,) with each ray's nearest, or any, triangle, and counts (R, 8) if counting.

    A triangle that reaches into several cells may be met beyond the cell in which it is tested: the
    hit is kept, but only ends the search when no cell before it is left. The flags are constants
    wherever this is inlined: what they switch off is not compiled.
    """
    nodes, planes, references, corners = tree.nodes, tree.planes, tree.references, tree.corners
    box = tree.box
    stack = np.empty(MAX_DEPTH + 2, np.int32)
    enters, exits = np.empty(MAX_DEPTH + 2, np.float64), np.empty(MAX_DEPTH + 2, np.float64)
    origin, inverse = np.empty(3, np.float64), np.empty(3, np.float64)
    near_side = np.empty(3, np.int64)
    # A mailbox holds ray and triangle, so that it need not be emptied between rays.
    mailboxes = np.full(MAILBOXES, -1, np.int64)
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
            np.float64(directions[r, 0]), np.float64(directions[r, 1]), np.float64(directions[r, 2])
        )
        px, py, pz = origin[x], origin[y], origin[z]
        best: float = np.float64(t_max[r])
        triangle = NONE
        top = 0
        node = np.int32(0)
        enter, leave = enter * LESS, leave * MORE
        searching = enter <= leave
        while searching:
            at = 2 * (node & NONE)
            word = nodes[at + 1]
            axis = word & 3
            if counting:
                counts[r, 0] += 1
            if axis != LEAF:
                if counting:
                    counts[r, 2] += 1
                # Without branches that no predictor could foresee. A ray in the plane, for which t
                # is not a number, visits both children.
                t = (np.float64(planes[at]) - origin[axis]) * inverse[axis]
                near = (word >> 2) + near_side[axis]
                far = 2 * (word >> 2) + 1 - near
                beyond, before = t < enter, t > leave
                both = not (beyond or before)
                stack[top] = far
                enters[top], exits[top] = (t * LESS if t > enter else enter), leave
                top += int(both)
                node = far if beyond else near
                leave = t * MORE if both and t < leave else leave
                if counting and both:
                    counts[r, 4] += 1
                    counts[r, 5] = max(counts[r, 5], top)
                continue
            begin, count = nodes[at], word >> 2
            if counting:
                counts[r, 6] += 1
            for n in range(begin, begin + count):
                f = references[n]
                letter = (np.int64(r) << 32) | np.int64(f)
                if mailboxes[f & (MAILBOXES - 1)] == letter:
                    continue
                mailboxes[f & (MAILBOXES - 1)] = letter
                if counting:
                    counts[r, 3] += 1
                t = distance_to(corners, 9 * f, x, y, z, shear_x, shear_y, shear_z, px, py, pz)
                if t >= 0.0 and (t < best or (t == best and f < triangle)):
                    best = t
                    triangle = f
                    if any_hit:
                        break
            if any_hit and triangle != NONE:
                break
            # Cells wait in the order in which the ray enters them, but for those on both sides of a
            # plane in which it lies.
            searching = False
            while top > 0 and not searching:
                top -= 1
                searching = enters[top] <= best * MORE
            node, enter, leave = stack[top], enters[top], exits[top]
        found[r] = triangle if triangle != NONE else -1


@kernel
def nearest(
    origins: Floats, directions: Floats, t_max: Floats, tree: KdArrays, found: Ints, counts: Ints
) -> None:
    """Fill found (R,) with the nearest triangle, or -1."""
    _trace(origins, directions, t_max, tree, found, counts, False, False)


@kernel
def occluded(
    origins: Floats, directions: Floats, t_max: Floats, tree: KdArrays, found: Ints, counts: Ints
) -> None:
    """Fill found (R,) with any triangle, or -1."""
    _trace(origins, directions, t_max, tree, found, counts, True, False)


@kernel
def counted_nearest(
    origins: Floats, directions: Floats, t_max: Floats, tree: KdArrays, found: Ints, counts: Ints
) -> None:
    """Fill found (R,) with the nearest triangle, and add to counts (R, 8)."""
    _trace(origins, directions, t_max, tree, found, counts, False, True)


@kernel
def counted_occluded(
    origins: Floats, directions: Floats, t_max: Floats, tree: KdArrays, found: Ints, counts: Ints
) -> None:
    """Fill found (R,) with any triangle, and add to counts (R, 8)."""
    _trace(origins, directions, t_max, tree, found, counts, True, True)
