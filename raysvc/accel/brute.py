"""Tests every triangle: the oracle that the others are held against, for small scenes."""

import time

import numpy as np
from pydantic import BaseModel, ConfigDict

from raysvc.accel.base import BuildReport, Rays, Triangles
from raysvc.geometry.triangle_kernels import all_pairs_nearest
from raysvc.types import Bools, Ints


class BruteParams(BaseModel):
    """Nothing to choose."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class Brute:
    """No structure at all."""

    def __init__(self, triangles: Triangles, params: BruteParams) -> None:
        start = time.perf_counter()
        self._triangles = triangles
        self.report = BuildReport(
            len(triangles.indices), time.perf_counter() - start, nodes=0, tree_mib=0.0
        )

    def nearest_triangle(self, rays: Rays) -> Ints:
        """(R,) int32: the first triangle along each ray, the lowest number of a tie, or -1."""
        found = np.empty(len(rays), np.int32)
        all_pairs_nearest(
            rays.origins,
            rays.directions,
            rays.t_max,
            self._triangles.positions,
            self._triangles.indices,
            found,
        )
        return found

    def occluded(self, rays: Rays) -> Bools:
        """(R,) bool: is there any triangle along the ray?"""
        return self.nearest_triangle(rays) >= 0
