"""Structures that are built and asked: one tree or one per material, whole or in chunks."""

import math
from collections.abc import Callable
from dataclasses import dataclass, fields

import numpy as np

from raysvc.accel.base import Accelerator, Rays, Triangles, hits_on
from raysvc.accel.forest import Forest
from raysvc.accel.registry import build
from raysvc.accel.report import Counters, Query
from raysvc.compare.settings import Candidate, Trees
from raysvc.parallel import Control, for_chunks, map_chunks
from raysvc.scene import Scene
from raysvc.types import Doubles

CHUNK = 1 << 13
"""Rays between two looks at whether to go on; a few milliseconds for a fast structure."""
GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0


@dataclass(frozen=True, slots=True, eq=False)
class Contender:
    """A structure over a scene's triangles."""

    candidate: Candidate
    trees: Trees
    triangles: Triangles
    structure: Accelerator

    @property
    def label(self) -> str:
        """Name for people: the structure as it was asked for, and the trees if there are many."""
        return label_of(self.candidate.label, self.trees)

    def ask(self, rays: Rays, query: Query, control: Control) -> None:
        """Ask all rays, chunk by chunk on the control's threads, and drop the answers."""
        answer: Callable[[Rays], object] = (
            self.structure.nearest_triangle if query == "nearest" else self.structure.occluded
        )

        def some(begin: int, end: int) -> None:
            answer(rows(rays, begin, end))

        for_chunks(len(rays), CHUNK, some, control)

    def count(self, rays: Rays, query: Query, control: Control) -> Counters | None:
        """Ask all rays with the counting kernels."""

        def some(begin: int, end: int) -> Counters | None:
            return self.structure.counted(rows(rays, begin, end), query)

        parts = [part for part in map_chunks(len(rays), CHUNK, some, control) if part is not None]
        if not parts:
            return None
        return Counters(
            **{
                field.name: np.concatenate([getattr(part, field.name) for part in parts])
                for field in fields(Counters)
            }
        )

    def hits(self, rays: Rays, query: Query, diagonal: float, control: Control) -> Doubles:
        """(R,) float64: t in diagonals, or 1 for `occluded`; NaN where a ray meets nothing."""

        def some(begin: int, end: int) -> Doubles:
            asked = rows(rays, begin, end)
            if query == "occluded":
                return np.where(self.structure.occluded(asked), 1.0, np.nan)
            hits = hits_on(self.triangles, self.structure.nearest_triangle(asked), asked)
            return np.where(hits.triangle >= 0, hits.t.astype(np.float64) / diagonal, np.nan)

        return np.concatenate(map_chunks(len(rays), CHUNK, some, control))


def contender(scene: Scene, candidate: Candidate, trees: Trees, part: slice) -> Contender:
    """Build a structure over some of a scene's triangles."""
    triangles = Triangles(scene.positions, np.ascontiguousarray(scene.triangles[part]))
    structure: Accelerator
    if trees == "per_material":
        group = scene.material_of_triangle[part]
        structure = Forest(candidate.name, triangles, group, candidate.parameters)
    else:
        structure = build(candidate.name, triangles, candidate.parameters)
    return Contender(candidate, trees, triangles, structure)


def label_of(name: str, trees: Trees) -> str:
    """Name of a structure with its kind of trees, for charts and files."""
    return name if trees == "one" else f"{name}, {trees.replace('_', ' ')}"


def checksum(hits: Doubles) -> float:
    """Fold what `hits` returns so that structures that answer alike agree, and others do not.

    Weights by the ray's number tell answers that were exchanged; four decimals leave out the last
    digits of t where two triangles tie.
    """
    weight = (np.arange(1, len(hits) + 1) * GOLDEN) % 1.0
    return round(float(np.nansum(hits * weight)), 4)


def rows(rays: Rays, begin: int, end: int) -> Rays:
    """Some of the rays, without a copy."""
    return Rays(rays.origins[begin:end], rays.directions[begin:end], rays.t_max[begin:end])
