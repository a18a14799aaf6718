"""A binary tree of boxes over triangles, before it is laid out for a traversal."""

from dataclasses import dataclass, replace

import numpy as np

from raysvc.accel.corner_kernels import bounds_of, corners_of
from raysvc.accel.report import BuildReport
from raysvc.accel.sah_kernels import grow_sah_tree
from raysvc.accel.tree_kernels import figures_of, order_children, refit_boxes
from raysvc.types import Floats, Ints


@dataclass(frozen=True, slots=True, eq=False)
class TreeShape:
    """N nodes over M references to triangles: what trees of all kinds have, and are measured by.

    The root is node 0, and a parent precedes its children. boxes (6 N,) float32: least, then
    greatest x, y, z. left (N,) int32: the left child, which the right one follows, or -1 for a
    leaf. first and count (N,) int32: a leaf's part of order (M,) int32, numbers of triangles.
    """

    boxes: Floats
    left: Ints
    first: Ints
    count: Ints
    order: Ints

    def report(
        self, triangles: int, seconds: float, node_bytes: int, index_bytes: int
    ) -> BuildReport:
        """Count and measure, for a structure whose nodes and indices take so many bytes."""
        figures = np.zeros(5, np.float64)
        depth = np.empty(len(self.left), np.int32)
        figures_of(self.boxes, self.left, self.count, depth, figures)
        leaves, empty, max_depth, sum_of_depths, sah_cost = figures.tolist()
        references = len(self.order)
        return BuildReport(
            triangles=triangles,
            build_ms=1000.0 * seconds,
            nodes=len(self.left),
            leaves=int(leaves),
            empty_leaves=int(empty),
            max_depth=int(max_depth),
            mean_depth=sum_of_depths / max(leaves, 1),
            triangle_references=references,
            mean_triangles_per_leaf=references / max(leaves, 1),
            mean_triangles_per_nonempty_leaf=references / max(leaves - empty, 1),
            duplication=references / max(triangles, 1),
            node_bytes=node_bytes,
            index_bytes=index_bytes,
            tree_mib=(node_bytes + index_bytes) / 2**20,
            sah_cost=sah_cost,
        )


@dataclass(frozen=True, slots=True, eq=False)
class BinaryTree(TreeShape):
    """A hierarchy of boxes, in which every triangle is once.

    axis (N,) int32: along which an inner node is split. corners (9 F,) float32: the coordinates of
    the triangles in the order of the leaves.
    """

    axis: Ints
    corners: Floats

    def refitted(self, positions: Floats, indices: Ints) -> "BinaryTree":
        """Return the tree of the same leaves with boxes and corners of moved vertices.

        Children may change places, and the axis along which they are told apart.
        """
        corners = corners_of(positions, indices, self.order)
        boxes = np.empty_like(self.boxes)
        refit_boxes(corners, self.left, self.first, self.count, boxes)
        left, first, count, axis = (
            array.copy() for array in (self.left, self.first, self.count, self.axis)
        )
        order_children(boxes, left, first, count, axis)
        return replace(
            self, boxes=boxes, corners=corners, left=left, first=first, count=count, axis=axis
        )


EMPTY = BinaryTree(
    boxes=np.repeat(np.array([np.inf, -np.inf], np.float32), 3),
    left=np.full(1, -1, np.int32),
    axis=np.zeros(1, np.int32),
    first=np.zeros(1, np.int32),
    count=np.zeros(1, np.int32),
    order=np.zeros(0, np.int32),
    corners=np.zeros(0, np.float32),
)
"""The tree of no triangles: one empty leaf, met by nothing."""


def sah_tree(
    positions: Floats,
    indices: Ints,
    bins: int,
    max_leaf: int,
    traversal_cost: float,
    intersection_cost: float,
) -> BinaryTree:
    """Build by the binned surface area heuristic over triangles indices (F, 3) of
    positions (V, 3).
    """
    triangles = len(indices)
    if triangles == 0:
        return EMPTY
    order = np.arange(triangles, dtype=np.int32)
    bounds = np.empty((triangles, 6), np.float32)
    bounds_of(corners_of(positions, indices, order), bounds)
    most = 2 * triangles - 1
    boxes = np.empty(6 * most, np.float32)
    left, axis, first, count = (np.empty(most, np.int32) for _ in range(4))
    nodes = grow_sah_tree(
        bounds.reshape(-1),
        order,
        bins,
        max_leaf,
        traversal_cost,
        intersection_cost,
        boxes,
        left,
        axis,
        first,
        count,
    )
    return BinaryTree(
        boxes=boxes[: 6 * nodes].copy(),
        left=left[:nodes].copy(),
        first=first[:nodes].copy(),
        count=count[:nodes].copy(),
        order=order,
        axis=axis[:nodes].copy(),
        corners=corners_of(positions, indices, order),
    )
