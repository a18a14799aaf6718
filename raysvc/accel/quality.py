"""Two measures of a tree that its surface area cost does not see, taken when asked for.

Aila, Karras and Laine 2013, "On Quality Metrics of Bounding Volume Hierarchies": end-point overlap
(EPO), which says how often a ray that ends on a surface visits boxes in vain, and leaf count
variability (LCV), which says how unequal the rays' work is.
"""

from dataclasses import dataclass, replace
from typing import Protocol, runtime_checkable

import numpy as np

from raysvc.accel.base import Accelerator, Rays, Triangles
from raysvc.accel.binary_tree import TreeShape
from raysvc.accel.corner_kernels import corners_of
from raysvc.accel.quality_kernels import foreign_area, leaves_of_triangles
from raysvc.accel.report import BuildReport
from raysvc.types import Doubles, Longs

EPO_TRIANGLES = 4096
LCV_RAYS = 16384


@dataclass(frozen=True, slots=True)
class Quality:
    """Both measures, None where the tree cannot be seen, and what they are taken from.

    `epo` sums over nodes the surface inside a node's box that belongs to none of its triangles,
    weighted with 1 for an inner node and with the triangles of a leaf, and divides by all surface.
    It is exact if `epo_triangles` is the number of all triangles, else estimated from so many.
    `lcv` is the standard deviation of the leaves that a ray visits, of `lcv_rays` random ones.
    """

    epo: float | None
    epo_triangles: int
    lcv: float | None
    lcv_rays: int


@runtime_checkable
class Shaped(Protocol):
    """A structure that shows its tree."""

    def shape(self) -> TreeShape:
        """Return the boxes and their triangles."""


def quality_of(
    structure: Accelerator,
    triangles: Triangles,
    epo_triangles: int = EPO_TRIANGLES,
    lcv_rays: int = LCV_RAYS,
    seed: int = 0,
) -> Quality:
    """Measure a structure built over triangles, from at most so many of them and so many rays."""
    rng = np.random.default_rng(seed)
    count = len(triangles.indices)
    sample = np.arange(count)
    if count > epo_triangles:
        sample = np.sort(rng.choice(count, epo_triangles, replace=False))
    epo = None
    if isinstance(structure, Shaped) and count > 0:
        epo = _epo(structure.shape(), triangles, sample)
    counters = None
    if count > 0:
        counters = structure.counted(random_rays(triangles, lcv_rays, rng), "nearest")
    lcv = None if counters is None else float(np.std(counters.leaves))
    return Quality(epo, len(sample), lcv, lcv_rays)


def with_quality(report: BuildReport, quality: Quality) -> BuildReport:
    """Return a report with both measures filled in."""
    return replace(report, epo=quality.epo, lcv=quality.lcv)


def random_rays(triangles: Triangles, count: int, rng: np.random.Generator) -> Rays:
    """Rays from anywhere in the triangles' bounds in any direction."""
    used = triangles.positions[triangles.indices.reshape(-1)]
    low, high = used.min(axis=0), used.max(axis=0)
    origins = (low + (high - low) * rng.random((count, 3))).astype(np.float32)
    directions = rng.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    return Rays(origins, directions.astype(np.float32), np.full(count, np.inf, np.float32))


def _epo(shape: TreeShape, triangles: Triangles, sample: Longs) -> float:
    count = len(triangles.indices)
    corners = corners_of(triangles.positions, triangles.indices, np.arange(count, dtype=np.int32))
    starts = np.zeros(count + 1, np.int64)
    leaves = leaves_of_triangles(shape.first, shape.count, shape.left, shape.order, starts)
    areas: Doubles = np.zeros(2, np.float64)
    foreign_area(corners, sample, shape.boxes, shape.left, shape.count, starts, leaves, areas)
    return float(areas[1] / areas[0]) if areas[0] > 0.0 else 0.0
