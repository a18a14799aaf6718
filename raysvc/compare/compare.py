"""Scene and settings in, comparison out."""

import time
from collections.abc import Mapping
from typing import Any, Final

import numpy as np

from raysvc.accel.quality import quality_of, with_quality
from raysvc.compare.contenders import Contender
from raysvc.compare.heat_map import HeatMap, heat_map
from raysvc.compare.machine import machine
from raysvc.compare.measure import (
    Pace,
    Steps,
    alone,
    build_figures,
    paces,
    thread_counts,
    timed_build,
    traversal_figures,
)
from raysvc.compare.ray_sets import RaySet, ray_set
from raysvc.compare.result import (
    Comparison,
    RayFigures,
    Scaling,
    StructureFigures,
    ThreadPoint,
    TrianglePoint,
)
from raysvc.compare.settings import (
    Candidate,
    ComparisonSettings,
    Trees,
    candidates,
    check_size,
    comparison_settings,
)
from raysvc.compare.talk_2009 import talk_beside
from raysvc.frame.view import camera_from
from raysvc.limits import DEFAULT_LIMITS, Limits
from raysvc.parallel import Control
from raysvc.scene import Scene
from raysvc.version import VERSION

PARTS: Final = (8, 4, 2, 1)
"""Scaling is measured with every eighth, fourth, second triangle and with all."""
WHOLE: Final = slice(None)


def compare(
    scene: Scene,
    settings: ComparisonSettings | Mapping[str, Any] | None = None,
    *,
    source: str = "",
    control: Control | None = None,
    limits: Limits = DEFAULT_LIMITS,
) -> Comparison:
    """Measure structures on one scene with one set of rays.

    Parameters
    ----------
    settings
        what to measure; `ComparisonSettings` or some of its fields
    source
        where the scene comes from, such as `builtin:torus_park`, whose figures of 2009 are added
    control
        to stop the work and hear of its progress; its threads and deadline give way to the
        settings'

    Raises InvalidSetting, LimitExceeded, Unavailable, Cancelled, DeadlineExceeded.
    """
    if not isinstance(settings, ComparisonSettings):
        settings = comparison_settings(settings or {})
    control = (control or Control()).limited(settings.threads, settings.deadline_s)
    chosen = candidates(settings)
    check_size(settings, len(scene.triangles), limits)
    with alone(control):
        return _Work(scene, settings, chosen, control, limits).done(source)


class _Work:
    """One comparison under way."""

    def __init__(
        self,
        scene: Scene,
        settings: ComparisonSettings,
        chosen: tuple[Candidate, ...],
        control: Control,
        limits: Limits,
    ) -> None:
        self._scene, self._settings, self._chosen = scene, settings, chosen
        self._control = control
        self._camera = camera_from(settings.camera, scene, limits)
        self._trees: tuple[Trees, ...] = (
            ("one", "per_material") if settings.trees == "both" else (settings.trees,)
        )
        self._threads = tuple(sorted({1, control.threads}))
        self._steps = Steps(self._step_count(), control)

    def done(self, source: str) -> Comparison:
        """Measure."""
        start = time.perf_counter()
        settings = self._settings
        self._steps.next("making rays")
        asked = ray_set(
            settings.rays,
            self._scene,
            self._camera,
            settings.count,
            settings.seed,
            self._control,
        )
        built = [
            timed_build(self._scene, candidate, trees, settings.builds, self._steps, WHOLE)
            for trees in self._trees
            for candidate in self._chosen
        ]
        contenders = [each for each, _ in built]
        low, high = self._scene.bounds()
        diagonal = float(np.linalg.norm(high - low)) or 1.0
        counters, hits, reports = [], [], []
        sampled: dict[str, int] = {}
        for each in contenders:
            self._steps.next(f"judging {each.label}")
            quality = quality_of(each.structure, each.triangles)
            reports.append(with_quality(each.structure.report, quality))
            sampled = {"epo_triangles": quality.epo_triangles, "lcv_rays": quality.lcv_rays}
            self._steps.next(f"counting {each.label}")
            counters.append(each.count(asked.rays, asked.query, self._control))
            hits.append(each.hits(asked.rays, asked.query, diagonal, self._control))
        speed = self._paces(contenders, asked, self._threads)
        figures = tuple(
            StructureFigures(
                name=each.candidate.label,
                trees=each.trees,
                build=build_figures(reports[place], build_ms),
                traversal=traversal_figures(
                    each,
                    counters[place],
                    speed[place, 1],
                    speed[place, self._threads[-1]],
                    hits[place],
                ),
            )
            for place, (each, build_ms) in enumerate(built)
        )
        maps = self._heat_maps(contenders)
        return Comparison(
            scene=source or self._scene.name,
            triangles=len(self._scene.triangles),
            materials=len(np.unique(self._scene.material_of_triangle)),
            rays=RayFigures(settings.rays, settings.count, settings.seed),
            query=asked.query,
            threads=self._threads[-1],
            rounds=settings.rounds,
            structures=figures,
            sampled=sampled,
            scaling=self._scaling(contenders, asked) if settings.scaling else None,
            talk_2009=talk_beside(source, self._trees),
            machine=machine(),
            seconds=time.perf_counter() - start,
            renderer_version=VERSION,
            heat_maps=maps,
        )

    def _heat_maps(self, contenders: list[Contender]) -> dict[str, HeatMap]:
        """Costs by pixel of those that show them."""
        maps: dict[str, HeatMap] = {}
        if self._settings.heat_map:
            for each in contenders:
                self._steps.next(f"mapping {each.label}")
                costs = heat_map(each, self._camera, self._control)
                if costs is not None:
                    maps[each.label] = costs
        return maps

    def _scaling(self, contenders: list[Contender], asked: RaySet) -> Scaling:
        """The same rays with parts of the triangles, and with fewer threads."""
        triangles, threads = [], []
        for part in PARTS:
            some = slice(None, None, part)
            built = [
                timed_build(self._scene, each.candidate, each.trees, 1, self._steps, some)
                for each in contenders
            ]
            speed = self._paces([each for each, _ in built], asked, (1,))
            for place, (each, build_ms) in enumerate(built):
                count = len(each.triangles.indices)
                median = speed[place, 1].median
                triangles.append(TrianglePoint(each.label, count, build_ms, median))
        speed = self._paces(contenders, asked, thread_counts(self._threads[-1]))
        for (place, count), pace in speed.items():
            threads.append(ThreadPoint(contenders[place].label, count, pace.median))
        return Scaling(tuple(triangles), tuple(threads))

    def _paces(
        self, contenders: list[Contender], asked: RaySet, threads: tuple[int, ...]
    ) -> dict[tuple[int, int], Pace]:
        return paces(
            contenders,
            asked.rays,
            asked.query,
            threads,
            self._settings.rounds,
            self._control,
            self._steps.next,
        )

    def _step_count(self) -> int:
        """How often a step begins."""
        settings, contenders = self._settings, len(self._chosen) * len(self._trees)
        turns = settings.rounds + 1
        each = settings.builds + 2 + turns * len(self._threads) + settings.heat_map
        if settings.scaling:
            counts = thread_counts(self._threads[-1])
            each += len(PARTS) * (1 + turns) + turns * len(counts)
        return 1 + contenders * each
