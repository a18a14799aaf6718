"""What a frame cost, and what it could not do."""

import math
import threading
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class StageTime:
    """Wall-clock seconds that one stage took."""

    name: str
    seconds: float


@dataclass(frozen=True, slots=True)
class Bounce:
    """One bounce of all reflections of a frame."""

    bounce: int
    """1 for rays that leave what the camera sees."""
    rays: int
    energy: float
    """Mean luminance that the bounce adds to a point that mirrors: light that its rays bring, by
    the part of it that reaches the picture."""


@dataclass(frozen=True, slots=True)
class ShadingCost:
    """What `passes` and `trees` decide: the cost of one picture in different orders."""

    traces: int
    """Reflected rays, each as often as there were trees to ask."""
    shaded: int
    """Hits that were shaded."""
    wasted: int
    """Of those, how many a later pass wrote over."""
    wasted_per_pixel: float
    trace_seconds: float
    """Of all threads together."""
    shade_seconds: float


@dataclass(frozen=True, slots=True)
class ProbeCost:
    """What an environment that was captured from a point of the scene took in one frame."""

    at: tuple[float, float, float]
    """Metres."""
    size: int
    """Pixels along a side of the cube."""
    left_out: int
    """Triangles that the probe does not see: of what it stands for."""
    rebuilt: bool
    """False where it was kept from an earlier frame; then it took no time."""
    capture_seconds: float
    """For the six pictures and the map made of them."""
    tables_seconds: float
    """For the map's summed-area tables."""


@dataclass(frozen=True, slots=True)
class EnvironmentCost:
    """How the environment was filtered, and what that took."""

    rebuilt: bool
    """False where it was kept from an earlier frame."""
    seconds: float
    """0 where it was kept, unless this frame is the first to show it in brushed surfaces or
    through glass, which read levels of their own."""
    ibl: str
    order: int
    builder: str
    passes: int
    """Of the builder over a table, in as many sums as the order says."""
    suns: int
    """Small lights that were taken out of it."""


@dataclass(frozen=True, slots=True)
class Statistics:
    """Numbers of one rendered frame."""

    width: int
    height: int
    triangles: int
    structure: str
    threads: int
    stages: tuple[StageTime, ...]
    total_seconds: float
    rays: dict[str, int]
    """Rays traced, by purpose."""
    bounces: tuple[Bounce, ...]
    """What each bounce of reflections took and brought."""
    shading: ShadingCost
    """How what reflected rays met was found and shaded."""
    build: dict[str, float | bool | None]
    """`seconds` that the structures and tables took, and whether they were `cached` from an
    earlier frame; whether the trees were `refitted` from another shape of the scene, their
    `sah_cost`, that when they were built, the ratio of the two, and the ratio for which refitting
    was refused and they were built anew. Costs that cannot be seen are None."""
    edge_fraction: float
    """Part of the pixels that were anti-aliased."""
    max_coc_px: float
    """Largest diameter of a circle of confusion; 0 without a lens."""
    environment: EnvironmentCost
    probe: ProbeCost | None
    """None where rays are reflected."""
    warnings: tuple[str, ...]
    renderer_version: str

    def to_dict(self) -> dict[str, Any]:
        """Return plain lists, numbers and strings, ready for JSON."""
        plain = asdict(self)
        plain["stages"] = [asdict(stage) for stage in self.stages]
        plain["bounces"] = [asdict(bounce) for bounce in self.bounces]
        plain["warnings"] = list(self.warnings)
        return plain


class Ledger:
    """Collects a frame's costs while it is made; counting is safe from any thread."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._rays: Counter[str] = Counter()
        self._seconds: dict[str, float] = {}
        self._bounce_rays: Counter[int] = Counter()
        self._energies: dict[int, list[float]] = {}
        self._shading: Counter[str] = Counter()
        self._shading_seconds = {"trace": 0.0, "shade": 0.0}
        self._start = time.perf_counter()
        self.edge_fraction = 0.0
        self.max_coc_px = 0.0
        self.probe: ProbeCost | None = None
        self.warnings: list[str] = []

    def count(self, kind: str, rays: int) -> None:
        """Note that so many rays of a kind were traced."""
        with self._lock:
            self._rays[kind] += rays

    def bounce(self, bounce: int, rays: int, energy: float) -> None:
        """Note that so many rays of a bounce brought luminance that adds up to `energy`."""
        with self._lock:
            self._bounce_rays[bounce] += rays
            self._energies.setdefault(bounce, []).append(energy)

    def shading(
        self,
        traces: int = 0,
        shaded: int = 0,
        wasted: int = 0,
        trace_seconds: float = 0.0,
        shade_seconds: float = 0.0,
    ) -> None:
        """Note what one pass over some rays took."""
        with self._lock:
            self._shading.update(traces=traces, shaded=shaded, wasted=wasted)
            self._shading_seconds["trace"] += trace_seconds
            self._shading_seconds["shade"] += shade_seconds

    @property
    def bounces(self) -> tuple[Bounce, ...]:
        """What each bounce took and brought so far; sums do not depend on the order of chunks."""
        first = max(self._bounce_rays[1], 1)
        return tuple(
            Bounce(bounce, rays, math.fsum(self._energies[bounce]) / first)
            for bounce, rays in sorted(self._bounce_rays.items())
            if rays
        )

    def shading_cost(self, pixels: int) -> ShadingCost:
        """Return what tracing and shading of reflections took in a picture of so many pixels."""
        return ShadingCost(
            traces=self._shading["traces"],
            shaded=self._shading["shaded"],
            wasted=self._shading["wasted"],
            wasted_per_pixel=self._shading["wasted"] / pixels,
            trace_seconds=self._shading_seconds["trace"],
            shade_seconds=self._shading_seconds["shade"],
        )

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time a stage; stages keep the order in which they first ran."""
        start = time.perf_counter()
        try:
            yield
        finally:
            spent = time.perf_counter() - start
            self._seconds[name] = self._seconds.get(name, 0.0) + spent

    @property
    def rays(self) -> dict[str, int]:
        """Rays traced so far, by purpose."""
        return dict(sorted(self._rays.items()))

    @property
    def stages(self) -> tuple[StageTime, ...]:
        """Stages so far."""
        return tuple(StageTime(name, seconds) for name, seconds in self._seconds.items())

    @property
    def total_seconds(self) -> float:
        """Seconds since the ledger was opened."""
        return time.perf_counter() - self._start
