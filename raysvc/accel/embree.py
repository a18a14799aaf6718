"""Intel Embree, through embreex.

Wald et al. 2014, "Embree: A Kernel Framework for Efficient CPU Ray Tracing"."""

import time

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from raysvc.accel.base import Rays, Triangles
from raysvc.accel.report import BuildReport, Query
from raysvc.types import Bools, Floats, Ints


class EmbreeParams(BaseModel):
    """How Embree builds and traverses."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    robust: bool = Field(
        True,
        description="Watertight traversal: rays never slip between triangles that share an edge.",
    )


class Embree:
    """Embree's own choice of structure. It shows neither its nodes nor their number."""

    state_bytes: int | None = None
    refits = False

    def __init__(self, triangles: Triangles, params: EmbreeParams) -> None:
        from embreex.mesh_construction import TriangleMesh
        from embreex.rtcore_scene import EmbreeScene

        start = time.perf_counter()
        self._triangles = triangles
        self._params = params
        self._scene = EmbreeScene(robust=params.robust)
        self._empty = len(triangles.indices) == 0
        if not self._empty:
            TriangleMesh(self._scene, triangles.positions, triangles.indices)
            # The first query commits the scene; asking now keeps that out of the first real one.
            origin = np.zeros((1, 3), np.float32)
            self._scene.run(origin, origin + np.float32(1.0))
        self.report = BuildReport(
            len(triangles.indices), build_ms=1000.0 * (time.perf_counter() - start)
        )

    def nearest_triangle(self, rays: Rays) -> Ints:
        """(R,) int32: the first triangle along each ray within 0..t_max, or -1."""
        if self._empty or not len(rays):
            return np.full(len(rays), -1, np.int32)
        # embreex overwrites the distances that it is given.
        found = self._scene.run(rays.origins, rays.directions, rays.t_max.copy(), query="INTERSECT")
        return np.asarray(found, np.int32)

    def occluded(self, rays: Rays) -> Bools:
        """(R,) bool: is there any triangle along the ray within 0..t_max?"""
        if self._empty or not len(rays):
            return np.zeros(len(rays), np.bool_)
        found = self._scene.run(rays.origins, rays.directions, rays.t_max.copy(), query="OCCLUDED")
        return np.asarray(found) >= 0

    def counted(self, rays: Rays, query: Query) -> None:
        """Embree does not show what it does."""

    def refitted(self, positions: Floats) -> "Embree":
        """Build anew with the moved vertices, positions (V, 3): embreex has no refit."""
        return Embree(Triangles(positions, self._triangles.indices), self._params)
