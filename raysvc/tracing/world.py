"""Every ray's questions about one scene: what is first, and how much light comes through."""

from typing import Literal

import numpy as np

from raysvc.accel.base import Accelerator, Hits, Rays, Triangles, hits_on
from raysvc.accel.forest import Forest
from raysvc.accel.registry import build, choose
from raysvc.scene import Scene
from raysvc.shading.scene_tables import SceneTables
from raysvc.tracing.march import March
from raysvc.types import Bools, Floats, Ints, Longs

MAX_HOLES = 64
"""Triangles with holes that one ray may pass through; those behind are not there."""
HALF_SEEN = 0.5
"""Reflections show blended surfaces that cover at least this much, and see through others."""


class World:
    """A scene's triangles in acceleration structures.

    Triangles with holes (of masked or blended materials) are in a structure of their own: the
    others, usually nearly all, are then asked once and with the cheapest question.
    """

    def __init__(
        self,
        scene: Scene,
        tables: SceneTables,
        structure: str,
        trees: Literal["one", "per_material"] = "one",
    ) -> None:
        """Build `structure`, a name of the registry or `auto`, as one tree or one per material."""
        self.structure = choose(structure)
        self._tables = tables
        self._triangles = Triangles(scene.positions, scene.triangles)
        group = scene.material_of_triangle if trees == "per_material" else None
        self._solid = _Part(self._triangles, tables.solid, self.structure, group)
        holed = ~tables.solid
        self._holed = _Part(self._triangles, holed, self.structure, group) if holed.any() else None
        parts = [self._solid] if self._holed is None else [self._solid, self._holed]
        self.build_seconds = sum(part.tree.report.seconds for part in parts)

    def nearest(self, rays: Rays) -> Hits:
        """Nearest hits that can be seen: through holes, and blends that cover less than half."""
        hits = hits_on(self._triangles, self._solid.nearest_triangle(rays), rays)
        if self._holed is None:
            return hits
        t, triangle, barycentric = hits.t, hits.triangle, hits.barycentric
        march = March(rays, np.minimum(rays.t_max, t), np.arange(len(rays)))
        for _ in range(MAX_HOLES):
            found, alpha = self._next_holed(march)
            met = found.triangle >= 0
            stops = met & (alpha >= HALF_SEEN)
            at = march.active[stops]
            t[at] = march.distance(found)[stops]
            triangle[at] = found.triangle[stops]
            barycentric[at] = found.barycentric[stops]
            march.go_on(found, met & ~stops)
            if not len(march.active):
                break
        return Hits(t, triangle, barycentric)

    def along(self, rays: Rays) -> tuple[Longs, Hits]:
        """Everything that a camera's rays show, up to and with what hides the rest.

        Single-sided triangles are not seen from behind and masked ones not where they are cut out.

        Returns
        -------
        (N,) number of the ray of each hit, and the N hits, in order along each ray
        """
        found: list[tuple[Longs, Hits]] = []
        march = March(rays, rays.t_max, np.arange(len(rays)))
        for _ in range(MAX_HOLES):
            some = march.ahead()
            hits = self._nearest_of_all(some)
            coverage = self._tables.coverage(hits.triangle, hits.barycentric, some.directions)
            kept = march.is_new(hits) & (coverage > 0)
            whole = Hits(march.distance(hits)[kept], hits.triangle[kept], hits.barycentric[kept])
            found.append((march.active[kept], whole))
            march.go_on(hits, (hits.triangle >= 0) & ~(kept & (coverage >= 1)))
            if not len(march.active):
                break
        ray = np.concatenate([part for part, _ in found])
        order = np.argsort(ray, kind="stable")
        return ray[order], Hits(
            np.concatenate([hits.t for _, hits in found])[order],
            np.concatenate([hits.triangle for _, hits in found])[order],
            np.concatenate([hits.barycentric for _, hits in found])[order],
        )

    def _nearest_of_all(self, rays: Rays) -> Hits:
        """Nearest triangle of either structure, whatever it is made of."""
        hits = hits_on(self._triangles, self._solid.nearest_triangle(rays), rays)
        if self._holed is None:
            return hits
        other = hits_on(self._triangles, self._holed.nearest_triangle(rays), rays)
        nearer = other.t < hits.t
        return Hits(
            np.where(nearer, other.t, hits.t),
            np.where(nearer, other.triangle, hits.triangle),
            np.where(nearer[:, None], other.barycentric, hits.barycentric),
        )

    def transmittance(self, rays: Rays) -> Floats:
        """(R,) float32: the part of the light that comes through along each ray within 0..t_max."""
        through = np.where(self._solid.tree.occluded(rays), 0.0, 1.0).astype(np.float32)
        if self._holed is None:
            return through
        march = March(rays, rays.t_max, np.flatnonzero(through > 0))
        for _ in range(MAX_HOLES):
            found, alpha = self._next_holed(march)
            active, new = march.active, march.is_new(found)
            through[active[new]] *= 1.0 - alpha[new]
            march.go_on(found, (found.triangle >= 0) & (through[active] > 0))
            if not len(march.active):
                break
        return through

    def _next_holed(self, march: March) -> tuple[Hits, Floats]:
        """Nearest holed triangle of marching rays, with t from where they are, and its coverage."""
        assert self._holed is not None
        some = march.ahead()
        hits = hits_on(self._triangles, self._holed.nearest_triangle(some), some)
        return hits, self._tables.alpha(hits.triangle, hits.barycentric)


class _Part:
    """A structure over some of a scene's triangles, answering with their numbers in the scene."""

    def __init__(
        self, triangles: Triangles, chosen: Bools, structure: str, group: Ints | None
    ) -> None:
        """With `group` (F,), one tree for each of its numbers."""
        self._number = np.flatnonzero(chosen).astype(np.int32)
        self._is_all = len(self._number) == len(triangles.indices)
        some = Triangles(triangles.positions, triangles.indices[chosen])
        self.tree: Accelerator = (
            build(structure, some) if group is None else Forest(structure, some, group[chosen])
        )

    def nearest_triangle(self, rays: Rays) -> Ints:
        """(R,) int32: number in the scene of the nearest triangle, or -1."""
        found = self.tree.nearest_triangle(rays)
        if self._is_all or not len(self._number):
            return found
        return np.where(found >= 0, self._number[found], np.int32(-1))
