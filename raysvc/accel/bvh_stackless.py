"""The hierarchy of `raysvc.accel.bvh`, laid out so that no stack is needed."""

import time
from typing import Final, Literal

import numpy as np
from pydantic import Field

from raysvc.accel import stackless_kernels as kernels
from raysvc.accel.base import Rays, Triangles
from raysvc.accel.binary_tree import BinaryTree, TreeShape
from raysvc.accel.bvh import BvhParams, aligned, tree_of
from raysvc.accel.corner_kernels import TRIANGLE_BYTES
from raysvc.accel.queries import Queries, QueryKernels
from raysvc.accel.report import Counters, Query
from raysvc.accel.stackless_kernels import ORDERED_WORDS, THREAD_WORDS, StacklessArrays
from raysvc.types import Bools, Floats, Ints


class BvhStacklessParams(BvhParams):
    """How the hierarchy is built, and how its nodes are linked."""

    links: Literal["octant", "skip"] = Field(
        "octant",
        description="`octant`: eight links a node, so that the nearer child is visited first; "
        "`skip`: one, and the same order for all rays.",
    )


SKIP: Final = QueryKernels(
    kernels.nearest_thread,
    kernels.occluded_thread,
    kernels.counted_nearest_thread,
    kernels.counted_occluded_thread,
)
OCTANT: Final = QueryKernels(
    kernels.nearest_ordered,
    kernels.occluded_ordered,
    kernels.counted_nearest_ordered,
    kernels.counted_occluded_ordered,
)


class BvhStackless:
    """A step fetches a node and tests its own box."""

    state_bytes = 4
    """The number of the node."""
    refits = True

    def __init__(
        self, triangles: Triangles, params: BvhStacklessParams, tree: BinaryTree | None = None
    ) -> None:
        """Build, or take a tree that has been built with these parameters."""
        start = time.perf_counter()
        self.tree = tree or tree_of(triangles, params)
        self._triangles = triangles
        self._params = params
        octant = params.links == "octant"
        words = ORDERED_WORDS if octant else THREAD_WORDS
        nodes = aligned(words * len(self.tree.left))
        links = nodes.view(np.int32)
        boxes, left, axis = self.tree.boxes, self.tree.left, self.tree.axis
        first, count = self.tree.first, self.tree.count
        if octant:
            kernels.lay_out_ordered(boxes, left, axis, first, count, nodes, links)
        else:
            kernels.lay_out_thread(boxes, left, first, count, nodes, links)
        arrays = StacklessArrays(nodes, links, self.tree.corners, self.tree.order)
        self._queries = Queries(OCTANT if octant else SKIP, arrays, 4 * words, TRIANGLE_BYTES)
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
        """(R,) int32: the first triangle along each ray, the lowest where several tie, or -1."""
        return self._queries.nearest_triangle(rays)

    def occluded(self, rays: Rays) -> Bools:
        """(R,) bool: is there any triangle along the ray?"""
        return self._queries.occluded(rays)

    def counted(self, rays: Rays, query: Query) -> Counters:
        """Answer as nearest_triangle or occluded do, and say what it took."""
        return self._queries.counted(rays, query)

    def refitted(self, positions: Floats) -> "BvhStackless":
        """Return the same hierarchy with the boxes of moved vertices, positions (V, 3)."""
        start = time.perf_counter()
        moved = Triangles(positions, self._triangles.indices)
        refitted = BvhStackless(moved, self._params, self.tree.refitted(positions, moved.indices))
        refitted.report = refitted.report.since(start)
        return refitted
