"""Builds, speeds, counters and hits of structures, on the same rays and interleaved.

Structures take turns within every round, so that a machine that is busy for a while slows all of
them; the median over rounds counts. One measurement runs at a time in a process.
"""

import math
import statistics
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields

import numpy as np

from raysvc.accel.base import Rays
from raysvc.accel.report import BuildReport, Counters, Query
from raysvc.compare.contenders import Contender, checksum, contender
from raysvc.compare.result import BuildFigures, TraversalFigures
from raysvc.compare.settings import Candidate, Trees
from raysvc.parallel import Control
from raysvc.scene import Scene
from raysvc.types import Doubles

SHORTEST_S = 0.02
"""Fewer rays than take this long are asked several times over."""
LOOK_EVERY_S = 0.05

_ALONE = threading.Lock()


@contextmanager
def alone(control: Control) -> Iterator[None]:
    """Wait until no other measurement runs in this process; heeds the control meanwhile."""
    while not _ALONE.acquire(timeout=LOOK_EVERY_S):
        control.check()
    try:
        yield
    finally:
        _ALONE.release()


class Steps:
    """Progress over a known number of steps of about equal weight."""

    def __init__(self, count: int, control: Control) -> None:
        self._count, self._done, self._control = count, 0, control

    def next(self, stage: str) -> None:
        """Begin a step; raises if the work should not go on."""
        self._control.check()
        self._control.progress(stage, min(self._done / self._count, 1.0))
        self._done += 1


def thread_counts(most: int) -> tuple[int, ...]:
    """One, two, four ... and `most` threads."""
    doubled = [1 << k for k in range(most.bit_length())]
    return tuple(sorted({*doubled, most}))


def timed_build(
    scene: Scene, candidate: Candidate, trees: Trees, builds: int, steps: Steps, part: slice
) -> tuple[Contender, float]:
    """Build several times; returns the last one, and the median of the milliseconds."""
    times, built = [], None
    for _ in range(builds):
        steps.next(f"building {candidate.label}")
        built = contender(scene, candidate, trees, part)
        times.append(built.structure.report.build_ms)
    assert built is not None
    return built, statistics.median(times)


@dataclass(frozen=True, slots=True)
class Pace:
    """Rays per second, in millions: the median over rounds and the range between the quartiles."""

    median: float
    iqr: float


def paces(
    contenders: Sequence[Contender],
    rays: Rays,
    query: Query,
    threads: Sequence[int],
    rounds: int,
    control: Control,
    begin_step: Callable[[str], None],
) -> dict[tuple[int, int], Pace]:
    """Time every contender with every number of threads in every round.

    Returns paces by (place in `contenders`, number of threads). Calls `begin_step` as often as
    there are contenders, threads and rounds, and once more for each contender and number.
    """
    turns = [(place, count) for place in range(len(contenders)) for count in threads]
    repeats: dict[tuple[int, int], int] = {}
    seconds: dict[tuple[int, int], list[float]] = {turn: [] for turn in turns}

    def once(turn: tuple[int, int]) -> float:
        asked = contenders[turn[0]]
        begin_step(f"timing {asked.label}")
        limited = control.limited(turn[1], None)
        start = time.perf_counter()
        for _ in range(repeats.get(turn, 1)):
            asked.ask(rays, query, limited)
        return (time.perf_counter() - start) / repeats.get(turn, 1)

    for turn in turns:
        # Warms caches up, and says how often to ask so that the clock is fine enough.
        repeats[turn] = max(round(SHORTEST_S / max(once(turn), 1e-9)), 1)
    for _ in range(rounds):
        for turn in turns:
            seconds[turn].append(once(turn))
    return {turn: _pace(len(rays), values) for turn, values in seconds.items()}


def _pace(count: int, seconds: Sequence[float]) -> Pace:
    speeds = count / np.array(seconds) / 1e6
    low, middle, high = np.percentile(speeds, [25.0, 50.0, 75.0])
    return Pace(float(middle), float(high - low))


def build_figures(report: BuildReport, build_ms: float) -> BuildFigures:
    """The tree's figures, with the median time of several builds; None for what is not finite."""
    names = [field.name for field in fields(BuildFigures) if field.name != "build_ms"]
    values = {name: getattr(report, name) for name in names}
    seen = {n: v if v is not None and math.isfinite(v) else None for n, v in values.items()}
    return BuildFigures(**seen, build_ms=build_ms)


def traversal_figures(
    asked: Contender, counters: Counters | None, one: Pace, all_: Pace, hits: Doubles
) -> TraversalFigures:
    """Everything that is known of a contender's answers to R rays."""
    return TraversalFigures(
        node_steps_per_ray=_mean(counters, "node_steps"),
        box_tests_per_ray=_mean(counters, "box_tests"),
        plane_tests_per_ray=_mean(counters, "plane_tests"),
        triangle_tests_per_ray=_mean(counters, "triangle_tests"),
        stack_writes_per_step=_writes_per_step(counters),
        max_stack_depth=None if counters is None else int(counters.max_stack_depth.max()),
        bytes_per_ray=_mean(counters, "bytes_touched"),
        lane_utilisation=None,
        state_bytes=asked.structure.state_bytes,
        mrays_per_s_one_thread=one.median,
        mrays_per_s_all_threads=all_.median,
        iqr_one_thread=one.iqr,
        hits=int(np.count_nonzero(~np.isnan(hits))),
        hit_checksum=checksum(hits),
    )


def _mean(counters: Counters | None, name: str) -> float | None:
    return None if counters is None else float(getattr(counters, name).mean(dtype=np.float64))


def _writes_per_step(counters: Counters | None) -> float | None:
    if counters is None:
        return None
    steps = int(counters.node_steps.sum(dtype=np.int64))
    return float(counters.stack_writes.sum(dtype=np.int64) / steps) if steps else 0.0
