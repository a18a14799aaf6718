"""What a frame cost, and what it could not do."""

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
    build: dict[str, float | bool]
    """`seconds` that the structures and tables took, and whether they were `cached` from an
    earlier frame."""
    edge_fraction: float
    """Part of the pixels that were anti-aliased."""
    max_coc_px: float
    """Largest diameter of a circle of confusion; 0 without a lens."""
    warnings: tuple[str, ...]
    renderer_version: str

    def to_dict(self) -> dict[str, Any]:
        """Return plain lists, numbers and strings, ready for JSON."""
        plain = asdict(self)
        plain["stages"] = [asdict(stage) for stage in self.stages]
        plain["warnings"] = list(self.warnings)
        return plain


class Ledger:
    """Collects a frame's costs while it is made; counting is safe from any thread."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._rays: Counter[str] = Counter()
        self._seconds: dict[str, float] = {}
        self._start = time.perf_counter()
        self.edge_fraction = 0.0
        self.max_coc_px = 0.0
        self.warnings: list[str] = []

    def count(self, kind: str, rays: int) -> None:
        """Note that so many rays of a kind were traced."""
        with self._lock:
            self._rays[kind] += rays

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
