"""Summed-area tables: how fast every builder makes them and every order reads them; and light by
them: how fast it is, and how near to integrals over all texels.

Builders take turns in every round with a plain copy of as many bytes as the table has, which no
builder that writes each entry once can much outrun; the first round does not count, and then the
median does. All write to memory that was used before.
"""

import itertools
import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Final, Literal

import numpy as np

from raysvc.compare.light_errors import DIRECTIONS, LightError, light_errors, lobe_count
from raysvc.compare.light_speed import LightSpeed, LitPicture, light_speed
from raysvc.compare.machine import machine
from raysvc.compare.measure import Steps, alone
from raysvc.errors import InvalidSetting, LimitExceeded
from raysvc.imaging.sat import build_table
from raysvc.imaging.sat_orders import ORDERS, integrated, spline_means
from raysvc.limits import DEFAULT_LIMITS
from raysvc.parallel import Control, for_chunks
from raysvc.scene import Environment
from raysvc.types import Doubles, Floats
from raysvc.version import VERSION

BUILDS: Final[tuple[tuple[str, int | None], ...]] = (
    ("fused", None),
    ("doubling", 2),
    ("doubling", 16),
    ("scan", None),
    ("strips", None),
)
"""Builders, and the samples that doubling adds in a pass."""
SIZE: Final = (2048, 1024)
LOOKUPS: Final = 1 << 18
HALF_ROWS, HALF_COLUMNS = 6.3, 9.1
"""In texels: boxes that lobes of some gloss read."""


@dataclass(frozen=True, slots=True)
class BuildSpeed:
    """One builder with so many threads."""

    measured: Literal["build"]
    builder: str
    samples: int | None
    threads: int
    width: int
    height: int
    passes: int
    """Over memory."""
    seconds: float
    """Median over the rounds."""
    iqr: float
    """Seconds between the quartiles of the rounds."""
    copy_seconds: float
    """Median of copying as many bytes as the table has, with as many threads."""
    ratio_to_copy: float
    """Speed over that of the copy: 1 is as fast, 0.5 takes twice as long."""


@dataclass(frozen=True, slots=True)
class LookupSpeed:
    """Reading the table of one order with one thread, from texel to texel along the rows."""

    measured: Literal["lookup"]
    order: int
    threads: int
    width: int
    height: int
    lookups: int
    mlookups_per_s: float
    """Median over the rounds."""
    iqr: float
    """Between the quartiles of the rounds, in Mlookups/s."""


def bench_sat(
    width: int = SIZE[0],
    height: int = SIZE[1],
    rounds: int = 5,
    seed: int = 0,
    control: Control | None = None,
    maps: Mapping[str, Environment] | None = None,
    directions: int = DIRECTIONS,
) -> dict[str, Any]:
    """Measure tables of an RGB map of some size; then light of maps, by the names they are given.

    Errors of light are measured in so many directions, its speed with the first map.

    Returns `machine`, `version`, `rounds`, `seed` and `results`, ready for JSON; each result says
    in `measured` what it is. Raises InvalidSetting, LimitExceeded, Cancelled.
    """
    if min(width, height) < 1:
        raise InvalidSetting(f"must be at least 1x1, is {width}x{height}", "size")
    if width * height > DEFAULT_LIMITS.max_environment_pixels:
        most = DEFAULT_LIMITS.max_environment_pixels
        raise LimitExceeded(f"may have {most:,} texels, has {width * height:,}", "size")
    if directions < 1:
        raise InvalidSetting(f"must be at least 1, is {directions}", "directions")
    control, maps = control or Control(), maps or {}
    image = np.random.default_rng(seed).lognormal(0.0, 1.0, (height, width, 3)).astype(np.float32)
    threads = sorted({1, control.threads})
    turns = len(threads) * (len(BUILDS) + 1) + len(ORDERS)
    turns += len(threads) * len(ORDERS) if maps else 0
    steps = Steps((rounds + 1) * turns + lobe_count() * len(maps), control)
    results: list[BuildSpeed | LookupSpeed | LightSpeed | LightError] = []
    with alone(control):
        for count in threads:
            results += _builds(image, control.quiet().limited(count, None), rounds, steps)
        results += _lookups(image, control.quiet().limited(1, None), rounds, steps)
        if maps:
            first = next(iter(maps.values()))
            picture = LitPicture(first, control.quiet())
            for count, order in itertools.product(threads, ORDERS):
                some = control.quiet().limited(count, None)
                results.append(light_speed(first, picture, order, rounds, steps, some))
        results += light_errors(maps, directions, seed, steps, control.quiet())
    return {
        "machine": machine(),
        "version": VERSION,
        "rounds": rounds,
        "seed": seed,
        "results": [asdict(result) for result in results],
    }


def _builds(image: Floats, control: Control, rounds: int, steps: Steps) -> list[BuildSpeed]:
    height, width, channels = image.shape
    table = np.zeros((height + 1, width + 1, channels))
    copied = np.zeros_like(table)

    def copy() -> int:
        def work(begin: int, end: int) -> None:
            np.copyto(copied[begin:end], table[begin:end])

        for_chunks(height + 1, -(-(height + 1) // control.threads), work, control)
        return 1

    def build(builder: str, samples: int | None) -> Callable[[], int]:
        asked = {} if samples is None else {"samples": samples}
        return lambda: build_table(image, builder, out=table, control=control, **asked).passes

    turns = {"copy": copy} | {f"{name} {samples}": build(name, samples) for name, samples in BUILDS}
    seconds, passes = _in_turns(turns, rounds, f"{control.threads} threads", steps)
    copying = statistics.median(seconds["copy"])
    results = []
    for builder, samples in BUILDS:
        taken = seconds[f"{builder} {samples}"]
        results.append(
            BuildSpeed(
                measured="build",
                builder=builder,
                samples=samples,
                threads=control.threads,
                width=width,
                height=height,
                passes=passes[f"{builder} {samples}"],
                seconds=statistics.median(taken),
                iqr=_iqr(taken),
                copy_seconds=copying,
                ratio_to_copy=copying / statistics.median(taken),
            )
        )
    return results


def _lookups(image: Floats, control: Control, rounds: int, steps: Steps) -> list[LookupSpeed]:
    height, width, _ = image.shape
    tables = {order: integrated(image, order, control) for order in ORDERS}
    filters = _texel_after_texel(width)

    def read(order: int) -> Callable[[], int]:
        return lambda: len(spline_means(tables[order], order, filters, control))

    seconds, _ = _in_turns({str(order): read(order) for order in ORDERS}, rounds, "lookups", steps)
    results = []
    for order in ORDERS:
        speeds = [LOOKUPS * 1e-6 / each for each in seconds[str(order)]]
        results.append(
            LookupSpeed(
                measured="lookup",
                order=order,
                threads=control.threads,
                width=width,
                height=height,
                lookups=LOOKUPS,
                mlookups_per_s=statistics.median(speeds),
                iqr=_iqr(speeds),
            )
        )
    return results


def _texel_after_texel(width: int) -> Doubles:
    """Filters (LOOKUPS, 4) row by row, beyond the last row as in a map that repeats."""
    rows, columns = np.divmod(np.arange(LOOKUPS), width)
    halves = np.tile([HALF_ROWS, HALF_COLUMNS], (LOOKUPS, 1))
    return np.column_stack([rows + 0.3, columns + 0.7, halves])


def _in_turns(
    turns: dict[str, Callable[[], int]], rounds: int, stage: str, steps: Steps
) -> tuple[dict[str, list[float]], dict[str, int]]:
    """Seconds of every round but the first, and what each returned last."""
    seconds: dict[str, list[float]] = {name: [] for name in turns}
    returned: dict[str, int] = {}
    for number in range(rounds + 1):
        for name, turn in turns.items():
            steps.next(f"{stage}, {name}")
            begin = time.perf_counter()
            returned[name] = turn()
            if number:
                seconds[name].append(time.perf_counter() - begin)
    return seconds, returned


def _iqr(values: Sequence[float]) -> float:
    low, high = np.percentile(values, [25.0, 75.0])
    return float(high - low)
