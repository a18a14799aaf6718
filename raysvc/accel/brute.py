"""Tests every triangle: the oracle that the others are held against, for small scenes."""

import time

import numpy as np
from pydantic import BaseModel, ConfigDict

from raysvc.accel.base import Rays, Triangles
from raysvc.accel.brute_kernels import all_pairs, any_of_all
from raysvc.accel.corner_kernels import TRIANGLE_BYTES, corners_of
from raysvc.accel.report import BuildReport, Counters, Query
from raysvc.types import Bools, Floats, Ints


class BruteParams(BaseModel):
    """Nothing to choose."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class Brute:
    """No structure at all: no nodes, no steps."""

    state_bytes = 0
    refits = False

    def __init__(self, triangles: Triangles, params: BruteParams) -> None:
        start = time.perf_counter()
        self._triangles = triangles
        self._params = params
        count = len(triangles.indices)
        order = np.arange(count, dtype=np.int32)
        self._corners = corners_of(triangles.positions, triangles.indices, order)
        self.report = BuildReport(
            triangles=count,
            build_ms=1000.0 * (time.perf_counter() - start),
            nodes=0,
            leaves=0,
            empty_leaves=0,
            triangle_references=count,
            duplication=1.0,
            node_bytes=0,
            index_bytes=0,
            tree_mib=0.0,
        )

    def nearest_triangle(self, rays: Rays) -> Ints:
        """(R,) int32: the first triangle along each ray, the lowest number where several tie, or
        -1.
        """
        found = np.empty(len(rays), np.int32)
        all_pairs(rays.origins, rays.directions, rays.t_max, self._corners, found)
        return found

    def occluded(self, rays: Rays) -> Bools:
        """(R,) bool: is there any triangle along the ray?"""
        return np.asarray(self._any(rays)[0] >= 0)

    def counted(self, rays: Rays, query: Query) -> Counters:
        """Answer as nearest_triangle or occluded do, and say what it took."""
        if query == "nearest":
            found = self.nearest_triangle(rays)
            tests = np.full(len(rays), self.report.triangles, np.int32)
        else:
            found, tests = self._any(rays)
        none = np.zeros(len(rays), np.int32)
        touched = tests.astype(np.int64) * TRIANGLE_BYTES
        return Counters(found, none, none, none, tests, none, none, none, touched)

    def _any(self, rays: Rays) -> tuple[Ints, Ints]:
        """Any triangle of each ray, or -1, and how many tests it took."""
        found, tests = np.empty(len(rays), np.int32), np.empty(len(rays), np.int32)
        any_of_all(rays.origins, rays.directions, rays.t_max, self._corners, tests, found)
        return found, tests

    def refitted(self, positions: Floats) -> "Brute":
        """Take the moved vertices, positions (V, 3)."""
        return Brute(Triangles(positions, self._triangles.indices), self._params)
