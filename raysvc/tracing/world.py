"""Every ray's questions about one scene: what is first, and how much light comes through."""

from typing import Literal

import numpy as np

from raysvc.accel.base import Accelerator, Hits, Rays, Triangles, hits_on
from raysvc.accel.forest import Forest, joined_report, numbered
from raysvc.accel.nearest_so_far import NearestSoFar
from raysvc.accel.registry import build, choose
from raysvc.scene import Scene
from raysvc.shading.scene_tables import SceneTables
from raysvc.tracing.march import March
from raysvc.types import Bools, Doubles, Floats, Ints, Longs

MAX_HOLES = 64
"""Triangles with holes that one ray may pass through; those behind are not there."""
HALF_SEEN = 0.5
"""Reflections show blended surfaces that cover at least this much, and see through others."""


class World:
    """A scene's triangles in acceleration structures.

    Triangles with holes (of masked, blended or clear materials) are in a structure of their own:
    the others, usually nearly all, are then asked once and with the cheapest question.
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
        triangles = Triangles(scene.positions, scene.triangles)
        group = scene.material_of_triangle if trees == "per_material" else None
        # Shadows go through glass, so it is with what has holes.
        holed = ~tables.solid | tables.clear
        self._hold(
            triangles,
            tables,
            _Part.built(triangles, ~holed, self.structure, group, False),
            _Part.built(triangles, holed, self.structure, group, True) if holed.any() else None,
        )
        self.sah_cost_built = self.report.sah_cost
        """The report's `sah_cost` when the trees were built; None where it cannot be seen."""

    def _hold(
        self, triangles: Triangles, tables: SceneTables, solid: "_Part", holed: "_Part | None"
    ) -> None:
        self._triangles, self._tables = triangles, tables
        self._solid, self._holed = solid, holed
        parts = [solid] if holed is None else [solid, holed]
        self._trees = [tree for part in parts for tree in part.trees()]
        self.report = joined_report(
            [part.tree.report for part in parts], [part.some_of(triangles) for part in parts]
        )
        """Of all trees together, and of their last build or refit."""

    @property
    def refits(self) -> bool:
        """Does `refitted` keep the trees, or build anew?"""
        return self._trees[0].tree.refits

    def refitted(self, scene: Scene, tables: SceneTables) -> "World":
        """Return the same trees around another shape of the scene, of which `tables` are."""
        moved = World.__new__(World)
        moved.structure = self.structure
        moved._hold(
            Triangles(scene.positions, scene.triangles),
            tables,
            self._solid.refitted(scene.positions),
            None if self._holed is None else self._holed.refitted(scene.positions),
        )
        moved.sah_cost_built = self.sah_cost_built if self.refits else moved.report.sah_cost
        return moved

    def is_around(self, scene: Scene) -> bool:
        """Are the trees around this very shape?"""
        return self._triangles.positions is scene.positions

    def nearest(self, rays: Rays) -> Hits:
        """Nearest hits that can be seen: through holes, and blends that cover less than half."""
        so_far = self.unasked(rays)
        for number in range(self.trees):
            self.narrow(number, so_far)
        return so_far.hits()

    @property
    def trees(self) -> int:
        """How many trees are asked one after the other for what is nearest."""
        return len(self._trees)

    def unasked(self, rays: Rays) -> NearestSoFar:
        """Return what is known of rays before any tree was asked: nothing."""
        return NearestSoFar(self._triangles, rays)

    def narrow(self, number: int, so_far: NearestSoFar) -> None:
        """Ask one of the trees for what can be seen nearer than is known so far.

        After all of them `so_far` holds what `nearest` answers.
        """
        tree = self._trees[number]
        if tree.is_holed:
            so_far.take(self._first_seen(tree, so_far.rays))
        else:
            so_far.take(tree.nearest_triangle(so_far.rays))

    def _first_seen(self, tree: "_Part", rays: Rays) -> Ints:
        """(R,) nearest triangles of those with holes that cover at least half, or -1."""
        seen = np.full(len(rays), -1, np.int32)
        march = March(rays, rays.t_max, np.arange(len(rays)))
        for _ in range(MAX_HOLES):
            some = march.ahead()
            found = hits_on(self._triangles, tree.nearest_triangle(some), some)
            alpha = self._tables.alpha(found.triangle, found.barycentric)
            met = found.triangle >= 0
            stops = met & (alpha >= HALF_SEEN)
            seen[march.active[stops]] = found.triangle[stops]
            march.go_on(found, met & ~stops)
            if not len(march.active):
                break
        return seen

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

    def drawn(self, rays: Rays, share: Doubles, *, from_camera: bool = False) -> Hits:
        """Nearest hits, blended surfaces met as often as they cover what is behind them.

        A ray stops where what it has met covers more than its random number `share` (R,) in 0..1.
        Rays `from_camera` do not see the backs of single-sided triangles.
        """
        if self._holed is None and not from_camera:
            return hits_on(self._triangles, self._solid.nearest_triangle(rays), rays)
        t = np.full(len(rays), np.inf, np.float32)
        triangle = np.full(len(rays), -1, np.int32)
        barycentric = np.zeros((len(rays), 2), np.float32)
        through = np.ones(len(rays))
        march = March(rays, rays.t_max, np.arange(len(rays)))
        for _ in range(MAX_HOLES):
            some, active = march.ahead(), march.active
            hits = self._nearest_of_all(some)
            if from_camera:
                coverage = self._tables.coverage(hits.triangle, hits.barycentric, some.directions)
            else:
                coverage = self._tables.alpha(hits.triangle, hits.barycentric)
            new = march.is_new(hits)
            through[active[new]] *= 1.0 - coverage[new]
            stops = new & (through[active] < 1.0 - share[active])
            at = active[stops]
            t[at] = march.distance(hits)[stops]
            triangle[at] = hits.triangle[stops]
            barycentric[at] = hits.barycentric[stops]
            march.go_on(hits, (hits.triangle >= 0) & ~stops)
            if not len(march.active):
                break
        return Hits(t, triangle, barycentric)

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

    def transmittance(self, rays: Rays, through_glass: bool = True) -> Floats:
        """(R,) float32: the part of the light that comes through along each ray within 0..t_max.

        Straight through glass, which does not bend it; nothing comes that way if not
        `through_glass`, for those who follow how it is bent.
        """
        coverage = self._tables.opacity if through_glass else self._tables.alpha
        through = np.where(self._solid.tree.occluded(rays), 0.0, 1.0).astype(np.float32)
        if self._holed is None:
            return through
        march = March(rays, rays.t_max, np.flatnonzero(through > 0))
        for _ in range(MAX_HOLES):
            some = march.ahead()
            found = hits_on(self._triangles, self._holed.nearest_triangle(some), some)
            alpha = coverage(found.triangle, found.barycentric)
            active, new = march.active, march.is_new(found)
            through[active[new]] *= 1.0 - alpha[new]
            march.go_on(found, (found.triangle >= 0) & (through[active] > 0))
            if not len(march.active):
                break
        return through

    def hiding(self, rays: Rays) -> tuple[Hits, Floats]:
        """What hides most of whatever is at the end of each ray, and how much comes through.

        The hits are misses where nothing is in the way; the second is (R,), as `transmittance`.
        """
        solid = hits_on(self._triangles, self._solid.nearest_triangle(rays), rays)
        is_solid = solid.triangle >= 0
        if self._holed is None:
            return solid, np.where(is_solid, np.float32(0.0), np.float32(1.0))
        through, most = np.ones(len(rays), np.float32), np.zeros(len(rays), np.float32)
        triangle = np.full(len(rays), -1, np.int32)
        t, barycentric = np.full(len(rays), np.inf, np.float32), np.zeros((len(rays), 2), "f4")
        march = March(rays, np.minimum(rays.t_max, solid.t), np.arange(len(rays)))
        for _ in range(MAX_HOLES):
            some, active = march.ahead(), march.active
            found = hits_on(self._triangles, self._holed.nearest_triangle(some), some)
            opacity = self._tables.opacity(found.triangle, found.barycentric)
            share = np.where(march.is_new(found), through[active] * opacity, np.float32(0.0))
            through[active] -= share
            more = share > most[active]
            at = active[more]
            most[at], triangle[at] = share[more], found.triangle[more]
            t[at], barycentric[at] = march.distance(found)[more], found.barycentric[more]
            march.go_on(found, (found.triangle >= 0) & (through[active] > 0))
            if not len(march.active):
                break
        rest = is_solid & (through > most)
        hits = Hits(
            np.where(rest, solid.t, t),
            np.where(rest, solid.triangle, triangle),
            np.where(rest[:, None], solid.barycentric, barycentric),
        )
        return hits, np.where(is_solid, np.float32(0.0), through)


class _Part:
    """A structure over some of a scene's triangles, answering with their numbers in the scene."""

    def __init__(self, tree: Accelerator, number: Ints | None, is_holed: bool) -> None:
        """`number` (M,) are the triangles' numbers, None if they are all; see `World` for holes."""
        self.tree, self._number, self.is_holed = tree, number, is_holed

    @staticmethod
    def built(
        triangles: Triangles, chosen: Bools, structure: str, group: Ints | None, is_holed: bool
    ) -> "_Part":
        """Build over the chosen triangles; with `group` (F,), one tree for each of its numbers."""
        number = None if chosen.all() else np.flatnonzero(chosen).astype(np.int32)
        some = Triangles(triangles.positions, triangles.indices[chosen])
        if group is None:
            return _Part(build(structure, some), number, is_holed)
        return _Part(Forest(structure, some, group[chosen]), number, is_holed)

    def refitted(self, positions: Floats) -> "_Part":
        """Return the part with vertices moved to positions (V, 3)."""
        return _Part(self.tree.refitted(positions), self._number, self.is_holed)

    def some_of(self, triangles: Triangles) -> Triangles:
        """Return those of the scene's triangles that are in it."""
        if self._number is None:
            return triangles
        return Triangles(triangles.positions, triangles.indices[self._number])

    def trees(self) -> "list[_Part]":
        """Parts that are one tree each: this one, or those of its forest."""
        if not isinstance(self.tree, Forest):
            return [self]
        return [
            _Part(tree, among if self._number is None else self._number[among], self.is_holed)
            for tree, among in zip(self.tree.trees, self.tree.numbers, strict=True)
        ]

    def nearest_triangle(self, rays: Rays) -> Ints:
        """(R,) int32: number in the scene of the nearest triangle, or -1."""
        found = self.tree.nearest_triangle(rays)
        return found if self._number is None else numbered(found, self._number)
