"""One structure per group of triangles, answering as one structure over all of them.

The talk of 2009 had a tree for each material. A ray asks one tree after the other, each only up to
the nearest triangle that is known so far: a structure says only *which* triangle, so the answer is
that of a single tree.
"""

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import Any

import numpy as np

from raysvc.accel.base import Accelerator, Rays, Triangles
from raysvc.accel.nearest_so_far import NearestSoFar
from raysvc.accel.registry import build
from raysvc.accel.report import BuildReport, Counters, Query
from raysvc.errors import LimitExceeded
from raysvc.types import Bools, Doubles, Floats, Ints

MOST_TREES = 256
"""Every ray asks every tree."""


class Forest:
    """Trees of one kind over groups of triangles; group (F,) int32 says which triangle is where."""

    def __init__(
        self,
        name: str,
        triangles: Triangles,
        group: Ints,
        parameters: Mapping[str, Any] | None = None,
    ) -> None:
        """Build with a name and parameters of the registry. Raises what `build` does, and
        LimitExceeded."""
        members = [np.flatnonzero(group == g).astype(np.int32) for g in np.unique(group)]
        if len(members) > MOST_TREES:
            raise LimitExceeded(
                f"{len(members)} materials would need as many trees; at most {MOST_TREES}", "trees"
            )
        parts = [Triangles(triangles.positions, triangles.indices[m]) for m in members]
        self._triangles = triangles
        self.numbers: Sequence[Ints] = members or [np.zeros(0, np.int32)]
        """For each tree, the numbers of its triangles."""
        self.trees: Sequence[Accelerator] = [
            build(name, part, parameters) for part in parts or [triangles]
        ]
        reports = [tree.report for tree in self.trees]
        self.report = joined_report(reports, parts or [triangles])

    @property
    def state_bytes(self) -> int | None:
        """What the traversal of one ray keeps: one tree's, as they are asked in turn."""
        return self.trees[0].state_bytes

    @property
    def refits(self) -> bool:
        """Do the trees keep their shape when vertices move?"""
        return self.trees[0].refits

    def nearest_triangle(self, rays: Rays) -> Ints:
        """(R,) int32: the first triangle along each ray, the lowest where several tie, or -1."""
        nearest = NearestSoFar(self._triangles, rays)
        for number, tree in zip(self.numbers, self.trees, strict=True):
            nearest.take(numbered(tree.nearest_triangle(nearest.rays), number))
        return nearest.triangle

    def occluded(self, rays: Rays) -> Bools:
        """(R,) bool: is there any triangle along the ray?"""
        found = self.trees[0].occluded(rays)
        for tree in self.trees[1:]:
            free = np.flatnonzero(~found)
            found[free] = tree.occluded(_some(rays, free))
        return found

    def counted(self, rays: Rays, query: Query) -> Counters | None:
        """Ask again and say what it took in all trees together; None where it cannot be seen."""
        nearest = NearestSoFar(self._triangles, rays)
        total: Counters | None = None
        for number, tree in zip(self.numbers, self.trees, strict=True):
            asked = np.arange(len(rays))
            if query == "occluded":
                asked = np.flatnonzero(nearest.triangle < 0)
            counters = tree.counted(_some(nearest.rays, asked), query)
            if counters is None:
                return None
            found = np.full(len(rays), -1, np.int32)
            found[asked] = counters.triangle
            nearest.take(numbered(found, number))
            total = _added(total, counters, asked, len(rays))
        assert total is not None
        return replace(total, triangle=nearest.triangle)

    def refitted(self, positions: Floats) -> "Forest":
        """Return the same trees with vertices moved to positions (V, 3)."""
        moved = Forest.__new__(Forest)
        moved._triangles = Triangles(positions, self._triangles.indices)
        moved.numbers = self.numbers
        moved.trees = [tree.refitted(positions) for tree in self.trees]
        parts = [Triangles(positions, self._triangles.indices[n]) for n in self.numbers]
        moved.report = joined_report([tree.report for tree in moved.trees], parts)
        return moved


def numbered(found: Ints, number: Ints) -> Ints:
    """Numbers (R,) among all triangles of those found (R,) among the triangles number (M,)."""
    if not len(number):
        return found
    return np.where(found >= 0, number[found], np.int32(-1))


def _some(rays: Rays, index: Any) -> Rays:
    if len(index) == len(rays):
        return rays
    return Rays(rays.origins[index], rays.directions[index], rays.t_max[index])


def _added(total: Counters | None, more: Counters, asked: Any, count: int) -> Counters:
    """Add what some rays (asked) did in another tree; the deepest stack counts, not the sum."""
    values: dict[str, Any] = {}
    for field in fields(Counters):
        part = getattr(more, field.name)
        whole = np.zeros(count, part.dtype) if total is None else getattr(total, field.name).copy()
        if field.name == "max_stack_depth":
            whole[asked] = np.maximum(whole[asked], part)
        elif field.name != "triangle":
            whole[asked] += part
        values[field.name] = whole
    return Counters(**values)


def joined_report(reports: Sequence[BuildReport], parts: Sequence[Triangles]) -> BuildReport:
    """Reports of trees over disjoint parts as one: sums, greatest depth, means over leaves, and the
    cost of a ray that meets the box of everything. EPO and LCV are measured elsewhere."""
    if len(reports) == 1:
        return reports[0]
    triangles = sum(report.triangles for report in reports)
    seconds = sum(report.build_ms for report in reports)
    if any(report.leaves is None for report in reports):
        return BuildReport(triangles, build_ms=seconds)

    def total(name: str) -> int:
        return sum(getattr(report, name) for report in reports)

    leaves, empty, references = total("leaves"), total("empty_leaves"), total("triangle_references")
    depths = sum((r.mean_depth or 0.0) * (r.leaves or 0) for r in reports)
    costs = [r.sah_cost for r in reports]
    areas = _half_areas(parts)
    reached = areas[:-1] / areas[-1] if areas[-1] > 0 else np.ones(len(reports))
    size = total("node_bytes") + total("index_bytes")
    return BuildReport(
        triangles,
        build_ms=seconds,
        nodes=total("nodes"),
        leaves=leaves,
        empty_leaves=empty,
        max_depth=max(r.max_depth or 0 for r in reports),
        mean_depth=depths / max(leaves, 1),
        triangle_references=references,
        mean_triangles_per_leaf=references / max(leaves, 1),
        mean_triangles_per_nonempty_leaf=references / max(leaves - empty, 1),
        duplication=references / max(triangles, 1),
        node_bytes=total("node_bytes"),
        index_bytes=total("index_bytes"),
        tree_mib=size / 2**20,
        sah_cost=float(sum(c * p for c, p in zip(costs, reached, strict=True)))
        if all(c is not None for c in costs)
        else None,
    )


def _half_areas(parts: Sequence[Triangles]) -> Doubles:
    """(K + 1,) half areas of the parts' boxes, and of the box of everything; 0 of nothing."""
    boxes = np.full((len(parts) + 1, 2, 3), np.array([[np.inf], [-np.inf]]))
    for box, part in zip(boxes, parts, strict=False):
        by_axis = np.ascontiguousarray(part.positions[part.indices.reshape(-1)].T)
        if by_axis.size:
            box[:] = by_axis.min(axis=1), by_axis.max(axis=1)
    boxes[-1] = boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)
    x, y, z = np.maximum(boxes[:, 1] - boxes[:, 0], 0.0).T
    area: Doubles = x * y + y * z + z * x
    return area
