"""A hierarchy of boxes, two to a node, built by the surface area heuristic and traversed with a
stack.
"""

import time
from typing import Final

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from raysvc.accel import bvh_kernels
from raysvc.accel.base import Rays, Triangles
from raysvc.accel.binary_tree import BinaryTree, TreeShape, sah_tree
from raysvc.accel.bvh_kernels import LEAF, NODE_WORDS, BvhArrays
from raysvc.accel.corner_kernels import TRIANGLE_BYTES
from raysvc.accel.queries import Queries, QueryKernels
from raysvc.accel.report import Counters, Query
from raysvc.accel.sah_kernels import MAX_DEPTH
from raysvc.types import Bools, Floats, Ints


class BvhParams(BaseModel):
    """How the hierarchy is built."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    bins: int = Field(
        16, ge=4, le=64, description="Places per axis at which a split is considered."
    )
    max_leaf: int = Field(8, ge=1, le=LEAF - 1, description="Most triangles that a leaf may hold.")
    traversal_cost: float = Field(
        4.0, ge=0, le=100, description="Cost of a node's step, in the heuristic."
    )
    intersection_cost: float = Field(
        1.0, gt=0, le=100, description="Cost of a triangle's test, in the heuristic."
    )


KERNELS: Final = QueryKernels(
    bvh_kernels.nearest,
    bvh_kernels.occluded,
    bvh_kernels.counted_nearest,
    bvh_kernels.counted_occluded,
)


class Bvh:
    """A step fetches an inner node and tests both children's boxes; the nearer is visited first."""

    state_bytes = 8 * (MAX_DEPTH + 2)
    """What one ray's traversal keeps apart from the ray: the stack's links and distances."""
    refits = True

    def __init__(
        self, triangles: Triangles, params: BvhParams, tree: BinaryTree | None = None
    ) -> None:
        """Build, or take a tree that has been built with these parameters."""
        start = time.perf_counter()
        self.tree = tree or tree_of(triangles, params)
        self._triangles = triangles
        self._params = params
        nodes = aligned(NODE_WORDS * max(len(self.tree.left) // 2, 1))
        links = nodes.view(np.int32)
        boxes, left, first, count = (
            self.tree.boxes,
            self.tree.left,
            self.tree.first,
            self.tree.count,
        )
        root = bvh_kernels.lay_out(boxes, left, first, count, np.empty_like(left), nodes, links)
        arrays = BvhArrays(nodes, links, self.tree.corners, self.tree.order, int(root))
        self._queries = Queries(KERNELS, arrays, 4 * NODE_WORDS, TRIANGLE_BYTES)
        self.report = self.tree.report(
            len(triangles.indices),
            time.perf_counter() - start,
            nodes.nbytes,
            self.tree.order.nbytes,
        )

    def shape(self) -> TreeShape:
        """Return the boxes and their triangles, for measures."""
        return self.tree

    def nearest_triangle(self, rays: Rays) -> Ints:
        """(R,) int32: the first triangle along each ray, the lowest number where several tie, or
        -1.
        """
        return self._queries.nearest_triangle(rays)

    def occluded(self, rays: Rays) -> Bools:
        """(R,) bool: is there any triangle along the ray?"""
        return self._queries.occluded(rays)

    def counted(self, rays: Rays, query: Query) -> Counters:
        """Answer as nearest_triangle or occluded do, and say what it took."""
        return self._queries.counted(rays, query)

    def refitted(self, positions: Floats) -> "Bvh":
        """Return the same hierarchy with the boxes of moved vertices, positions (V, 3)."""
        start = time.perf_counter()
        moved = Triangles(positions, self._triangles.indices)
        refitted = Bvh(moved, self._params, self.tree.refitted(positions, moved.indices))
        refitted.report = refitted.report.since(start)
        return refitted


def tree_of(triangles: Triangles, params: BvhParams) -> BinaryTree:
    """Build the tree that the parameters ask for."""
    return sah_tree(
        triangles.positions,
        triangles.indices,
        params.bins,
        params.max_leaf,
        params.traversal_cost,
        params.intersection_cost,
    )


def aligned(words: int) -> Floats:
    """(words,) float32, zeros, that begin on a cache line."""
    room = np.zeros(words + 16, np.float32)
    skip = (-room.ctypes.data % 64) // 4
    return room[skip : skip + words]
