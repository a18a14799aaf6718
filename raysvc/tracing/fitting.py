"""When the trees of one shape of a scene are moved to another, and when they are built anew."""

import math
from dataclasses import dataclass
from typing import Final, Literal

from raysvc.scene import Scene
from raysvc.shading.scene_tables import SceneTables
from raysvc.tracing.world import World

WORST_RATIO: Final = 1.2
"""Refitted trees are used up to this ratio of their surface area cost to that when they were built.

It is about where the rays of a picture of 640x360 lose as much time as a build takes; see
docs/benchmarks.md and `bench.refit`."""


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """Trees around one shape of a scene, and how they came to be."""

    world: World
    refitted: bool
    """Were they moved from another shape, or built around this one?"""
    ratio_refused: float | None = None
    """The ratio that refitting would have had; None if it was not tried, or was used."""

    def figures(self) -> dict[str, float | bool | None]:
        """What the statistics of a frame say of it."""
        cost, built = self.world.report.sah_cost, self.world.sah_cost_built
        return {
            "refitted": self.refitted,
            "sah_cost": _finite(cost),
            "sah_cost_built": _finite(built),
            "sah_ratio": _finite(_ratio(self.world)),
            "sah_ratio_refused": _finite(self.ratio_refused),
        }


def fitted(
    scene: Scene,
    tables: SceneTables,
    structure: str,
    trees: Literal["one", "per_material"],
    kin: World | None,
) -> Fit:
    """Refit `kin`, which is around another shape of the scene, or build anew.

    Built anew are structures that do not refit, and trees whose surface area cost has grown to more
    than WORST_RATIO times what it was when they were built. Pictures do not depend on it.
    """
    refused = None
    if kin is not None and kin.refits:
        moved = kin.refitted(scene, tables)
        ratio = _ratio(moved)
        if ratio is not None and ratio <= WORST_RATIO:
            return Fit(moved, refitted=True)
        refused = ratio
    return Fit(World(scene, tables, structure, trees), refitted=False, ratio_refused=refused)


def _ratio(world: World) -> float | None:
    """Surface area cost now to that when built; inf if only the trees when built had none."""
    cost, built = world.report.sah_cost, world.sah_cost_built
    if cost is None or built is None:
        return None
    if built > 0.0:
        return cost / built
    return math.inf if cost > 0.0 else 1.0


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None
