"""A scene's surface cut into patches, each of which is taken to send out the same light everywhere.

Triangles are cut into elements of about the size of a cell of a grid; elements in one cell whose
sides look the same way are one patch. However many triangles a scene has, there are thus some ten
thousand patches, and leaves that share a cell share their light. (Reichert 1992, "A Two-Pass
Radiosity Method Driven by Lights and Viewer Position": a coarse solution is enough where it is only
seen through a final gather.)
"""

import math
from dataclasses import dataclass

import numpy as np

from raysvc.accel.base import Hits
from raysvc.scene import Scene
from raysvc.shading.scene_tables import SceneTables
from raysvc.tracing.patch_kernels import (
    PatchTable,
    key_elements,
    look_up_patches,
    measure_triangles,
    place_samples,
)
from raysvc.types import Bools, Doubles, Floats, Ints, Longs

CELLS = 16_384
"""Cells that a scene's area would fill if it were flat."""
MAX_PATCHES = 24_576
MAX_PARTS = 128
"""Into how many parts an edge of a triangle is cut at most."""
LONGEST = 4.0
"""Of an edge, in sides of the square of twice the triangle's area: slivers are cut less."""
SAMPLES = 4
"""Points of each patch that stand for it."""


@dataclass(frozen=True, slots=True, eq=False)
class Patches:
    """P patches of a scene, and SAMPLES points on each. Immutable."""

    table: PatchTable
    positions: Floats
    triangles: Ints
    count: int
    size_m: float
    """Width of a cell."""
    triangle: Ints
    """(P * SAMPLES,) triangle of each sample, those of one patch next to each other."""
    barycentric: Floats
    """(P * SAMPLES, 2)."""
    towards: Floats
    """(P * SAMPLES, 3) unit direction from which the sample's side is seen straight on."""

    @staticmethod
    def of(scene: Scene, tables: SceneTables) -> "Patches":
        """Cut a scene's surface. Back sides count where materials are double-sided."""
        areas, longest = np.empty(len(scene.triangles)), np.empty(len(scene.triangles))
        measure_triangles(scene.positions, scene.triangles, areas, longest)
        longest = np.minimum(longest, LONGEST * np.sqrt(2.0 * areas))
        low, high = scene.bounds()
        finest = float((high - low).max()) * 1e-6
        size_m = max(math.sqrt(float(areas.sum()) / CELLS), finest, 1e-30)
        while True:
            parts = np.clip(np.ceil(longest / size_m), 1, MAX_PARTS).astype(np.int32)
            first = np.concatenate([[0], np.cumsum(parts.astype(np.int64) ** 2)])
            triangle = np.repeat(np.arange(len(parts), dtype=np.int32), parts**2)
            one_sided = ~tables.double_sided[triangle]
            keys = np.empty((2, len(triangle)), np.int64)
            table = PatchTable(parts, first[:-1].astype(np.int32), np.empty(keys.shape, np.int32))
            key_elements(scene.positions, scene.triangles, table, low, size_m, keys)
            keys[1, one_sided] = keys[0, one_sided]
            known, patch = np.unique(keys, return_inverse=True)
            if len(known) <= MAX_PATCHES:
                break
            size_m *= max(math.sqrt(len(known) / MAX_PATCHES), 1.2)
        table.patch[:] = patch.reshape(keys.shape)
        samples = _samples(scene, table, triangle, areas / parts**2, one_sided, len(known))
        return Patches(table, scene.positions, scene.triangles, len(known), size_m, *samples)

    def met(self, hits: Hits, directions: Floats) -> Ints:
        """(R,) int32: the patch that each of R rays along `directions` (R, 3) has met, or -1."""
        patch = np.empty(len(hits.triangle), np.int32)
        look_up_patches(
            self.positions,
            self.triangles,
            self.table,
            hits.triangle,
            hits.barycentric,
            directions,
            patch,
        )
        return patch


def _samples(
    scene: Scene,
    table: PatchTable,
    triangle: Ints,
    area: Doubles,
    one_sided: Bools,
    patches: int,
) -> tuple[Ints, Floats, Floats]:
    """Triangle, barycentrics and outward direction of SAMPLES points on each patch, by area.

    `triangle` (E,) is that of each element, `area` (F,) that of one element of a triangle.
    """
    element = np.concatenate([np.arange(len(triangle)), np.flatnonzero(~one_sided)])
    side = np.zeros(len(element), np.uint8)
    side[len(triangle) :] = 1
    patch = table.patch[side, element]
    order = np.argsort(patch, kind="stable")
    element, side, patch = element[order], side[order], patch[order]
    # Evenly spaced places on a line along which the elements of each patch lie by their areas
    ends = np.cumsum(area[triangle[element]])
    last = np.searchsorted(patch, np.arange(patches), side="right") - 1
    begin = np.searchsorted(patch, np.arange(patches), side="left")
    total = ends[last] - (ends[begin] - area[triangle[element[begin]]])
    place = (np.arange(SAMPLES) + 0.5) / SAMPLES
    along = (ends[last] - total)[:, None] + place * total[:, None]
    chosen: Longs = np.searchsorted(ends, along.reshape(-1))
    chosen = np.clip(chosen, np.repeat(begin, SAMPLES), np.repeat(last, SAMPLES))
    element, side = element[chosen], side[chosen]
    barycentric = np.empty((len(element), 2), np.float32)
    towards = np.empty((len(element), 3), np.float32)
    place_samples(
        scene.positions,
        scene.triangles,
        table,
        triangle[element],
        element.astype(np.int32),
        side,
        barycentric,
        towards,
    )
    return triangle[element], barycentric, towards
