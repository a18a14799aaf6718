"""Asking a structure's kernels: they all take rays, a tuple of arrays, and places for the
answer.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from raysvc.accel.base import Rays
from raysvc.accel.report import Counters, Query
from raysvc.types import Bools, Ints

QueryKernel = Callable[..., None]


@dataclass(frozen=True, slots=True)
class QueryKernels:
    """Four instances of one traversal: for either question, plain and counting."""

    nearest: QueryKernel
    occluded: QueryKernel
    counted_nearest: QueryKernel
    counted_occluded: QueryKernel


@dataclass(frozen=True, slots=True, eq=False)
class Queries:
    """A structure's answers, from its kernels and arrays and what a fetched node and triangle
    weigh.
    """

    kernels: QueryKernels
    arrays: Any
    node_bytes: int
    triangle_bytes: int

    def nearest_triangle(self, rays: Rays) -> Ints:
        """(R,) int32: the nearest triangle, the lowest number where several are equally near, or
        -1.
        """
        return self._ask(self.kernels.nearest, rays, np.empty((0, 8), np.int32))

    def occluded(self, rays: Rays) -> Bools:
        """(R,) bool: is there any?"""
        found = self._ask(self.kernels.occluded, rays, np.empty((0, 8), np.int32))
        return np.asarray(found >= 0)

    def counted(self, rays: Rays, query: Query) -> Counters:
        """Ask again with the counting kernel."""
        kernel = (
            self.kernels.counted_nearest if query == "nearest" else self.kernels.counted_occluded
        )
        counts = np.zeros((len(rays), 8), np.int32)
        found = self._ask(kernel, rays, counts)
        steps, boxes, planes, tests, writes, depth, leaves, _ = np.ascontiguousarray(counts.T)
        touched = steps.astype(np.int64) * self.node_bytes
        touched += tests.astype(np.int64) * self.triangle_bytes
        return Counters(found, steps, boxes, planes, tests, writes, depth, leaves, touched)

    def _ask(self, kernel: QueryKernel, rays: Rays, counts: Ints) -> Ints:
        found = np.empty(len(rays), np.int32)
        kernel(rays.origins, rays.directions, rays.t_max, self.arrays, found, counts)
        return found
