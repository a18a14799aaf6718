"""A kd-tree: space is divided, and a triangle is in every cell into which it reaches."""

import math
import time
from typing import Final

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from raysvc.accel import kd_kernels
from raysvc.accel.base import Rays, Triangles
from raysvc.accel.binary_tree import TreeShape
from raysvc.accel.corner_kernels import TRIANGLE_BYTES, bounds_of, corners_of
from raysvc.accel.kd_build_kernels import LEAF, MAX_DEPTH, cells_of, grow_kd_tree
from raysvc.accel.kd_kernels import MAILBOXES, KdArrays
from raysvc.accel.queries import Queries, QueryKernels
from raysvc.accel.report import Counters, Query
from raysvc.types import Bools, Floats, Ints


class KdParams(BaseModel):
    """How the tree is built."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    traversal_cost: float = Field(
        2.0, ge=0, le=100, description="Cost of a node's step, in the heuristic."
    )
    intersection_cost: float = Field(
        1.0, gt=0, le=100, description="Cost of a triangle's test, in the heuristic."
    )
    empty_bonus: float = Field(
        0.2, ge=0, le=0.9, description="Part by which a split that cuts off empty space is cheaper."
    )
    max_depth: int | None = Field(
        None, ge=1, le=MAX_DEPTH, description="Deepest leaf; by default 8 + 1.3 log2 of triangles."
    )
    min_leaf: int = Field(
        1, ge=1, le=64, description="Cells with no more triangles than this are not split."
    )
    bins: int = Field(64, ge=8, le=1024, description="Planes per axis considered in large cells.")
    exact_below: int = Field(
        128, ge=1, le=65536, description="Cells of so many triangles or fewer consider all planes."
    )


KERNELS: Final = QueryKernels(
    kd_kernels.nearest,
    kd_kernels.occluded,
    kd_kernels.counted_nearest,
    kd_kernels.counted_occluded,
)
NODE_BYTES = 8


class Kd:
    """A step fetches a node; an inner one has one plane tested, and the nearer child is visited
    first.

    A triangle found beyond the cell in which it was tested ends the search only once the ray has
    come there. Mailboxes keep a ray from testing a triangle again in the next cells.
    """

    state_bytes = 20 * (MAX_DEPTH + 2) + 8 * MAILBOXES
    """The stack's nodes and intervals, and the mailboxes."""
    refits = False

    def __init__(self, triangles: Triangles, params: KdParams) -> None:
        start = time.perf_counter()
        self._triangles = triangles
        self._params = params
        count = len(triangles.indices)
        order = np.arange(count, dtype=np.int32)
        corners = corners_of(triangles.positions, triangles.indices, order)
        if count == 0:
            nodes, references = np.array([0, LEAF], np.int32), np.zeros(0, np.int32)
            box = np.array([1.0, 1.0, 1.0, -1.0, -1.0, -1.0])
        else:
            bounds = np.empty((count, 6), np.float32)
            bounds_of(corners, bounds)
            box = np.concatenate([bounds[:, :3].min(axis=0), bounds[:, 3:].max(axis=0)])
            box = box.astype(np.float64)
            nodes, references, filled, referenced = grow_kd_tree(
                corners,
                box,
                bounds.reshape(-1),
                params.min_leaf,
                params.max_depth or int(8 + 1.3 * math.log2(count)),
                params.bins,
                params.exact_below,
                (params.traversal_cost, params.intersection_cost, params.empty_bonus),
            )
            nodes, references = nodes[: 2 * filled].copy(), references[:referenced].copy()
        self.arrays = KdArrays(nodes, nodes.view(np.float32), references, corners, box)
        self._queries = Queries(KERNELS, self.arrays, NODE_BYTES, TRIANGLE_BYTES + 4)
        seconds = time.perf_counter() - start
        self.report = self.shape().report(count, seconds, nodes.nbytes, references.nbytes)

    def shape(self) -> TreeShape:
        """Return the cells and their triangles, for measures."""
        nodes = len(self.arrays.nodes) // 2
        boxes = np.empty(6 * nodes, np.float32)
        left, first, count = (np.empty(nodes, np.int32) for _ in range(3))
        cells_of(self.arrays.nodes, self.arrays.planes, self.arrays.box, boxes, left, first, count)
        return TreeShape(boxes, left, first, count, self.arrays.references)

    def nearest_triangle(self, rays: Rays) -> Ints:
        """(R,) int32: the first triangle along each ray, the lowest where several tie, or -1."""
        return self._queries.nearest_triangle(rays)

    def occluded(self, rays: Rays) -> Bools:
        """(R,) bool: is there any triangle along the ray?"""
        return self._queries.occluded(rays)

    def counted(self, rays: Rays, query: Query) -> Counters:
        """Answer as nearest_triangle or occluded do, and say what it took."""
        return self._queries.counted(rays, query)

    def refitted(self, positions: Floats) -> "Kd":
        """Build anew with the moved vertices, positions (V, 3): cells cannot be moved."""
        return Kd(Triangles(positions, self._triangles.indices), self._params)
