"""Counters, gauges and histograms, and the Prometheus text format (version 0.0.4) that shows them.

https://prometheus.io/docs/instrumenting/exposition_formats/
"""

import bisect
import math
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import accumulate
from typing import Final, Protocol

MEDIA_TYPE: Final = "text/plain; version=0.0.4; charset=utf-8"

Labels = tuple[str, ...]
"""Values, in the order of a family's label names."""


class Family(Protocol):
    """Some samples of one meaning."""

    @property
    def name(self) -> str:
        """As Prometheus knows it, unit and `_total` included."""

    def lines(self) -> Iterator[str]:
        """The lines of the text format."""


class Counter:
    """What only grows. Safe to use from many threads."""

    def __init__(self, name: str, meaning: str, labels: Sequence[str] = ()) -> None:
        self.name = name
        self._meaning = meaning
        self._labels = tuple(labels)
        self._values: dict[Labels, float] = {}
        self._lock = threading.Lock()

    def add(self, *labels: str, amount: float = 1.0) -> None:
        """Count; `labels` are the values of this family's labels."""
        with self._lock:
            self._values[labels] = self._values.get(labels, 0.0) + amount

    def lines(self) -> Iterator[str]:
        """The lines of the text format."""
        yield from _head(self.name, self._meaning, "counter")
        with self._lock:
            values = sorted(self._values.items())
        for labels, value in values:
            yield _sample(self.name, dict(zip(self._labels, labels, strict=True)), value)


class Read:
    """What somebody else knows, asked when it is shown: a gauge, or a counter that they keep."""

    def __init__(
        self,
        name: str,
        meaning: str,
        read: Callable[[], Mapping[Labels, float]],
        labels: Sequence[str] = (),
        kind: str = "gauge",
    ) -> None:
        self.name = name
        self._meaning = meaning
        self._read = read
        self._labels = tuple(labels)
        self._kind = kind

    def lines(self) -> Iterator[str]:
        """The lines of the text format."""
        yield from _head(self.name, self._meaning, self._kind)
        for labels, value in self._read().items():
            yield _sample(self.name, dict(zip(self._labels, labels, strict=True)), value)


class Histogram:
    """How often values of each size were seen. Safe to use from many threads."""

    def __init__(
        self, name: str, meaning: str, buckets: Sequence[float], labels: Sequence[str] = ()
    ) -> None:
        self.name = name
        self._meaning = meaning
        self._buckets = (*sorted(buckets), math.inf)
        self._labels = tuple(labels)
        self._counts: dict[Labels, list[int]] = {}
        self._sums: dict[Labels, float] = {}
        self._lock = threading.Lock()

    def observe(self, value: float, *labels: str) -> None:
        """Take a value in."""
        with self._lock:
            counts = self._counts.setdefault(labels, [0] * len(self._buckets))
            counts[bisect.bisect_left(self._buckets, value)] += 1
            self._sums[labels] = self._sums.get(labels, 0.0) + value

    def lines(self) -> Iterator[str]:
        """The lines of the text format; a bucket holds those before it."""
        yield from _head(self.name, self._meaning, "histogram")
        with self._lock:
            seen = sorted((labels, list(counts)) for labels, counts in self._counts.items())
            sums = dict(self._sums)
        for values, counts in seen:
            labels = dict(zip(self._labels, values, strict=True))
            for bound, count in zip(self._buckets, accumulate(counts), strict=True):
                yield _sample(f"{self.name}_bucket", {**labels, "le": _number(bound)}, count)
            yield _sample(f"{self.name}_sum", labels, sums[values])
            yield _sample(f"{self.name}_count", labels, sum(counts))


def text_of(families: Sequence[Family]) -> str:
    """Show families as Prometheus reads them."""
    return "".join(f"{line}\n" for family in families for line in family.lines())


def _head(name: str, meaning: str, kind: str) -> tuple[str, str]:
    escaped = meaning.replace("\\", r"\\").replace("\n", r"\n")
    return f"# HELP {name} {escaped}", f"# TYPE {name} {kind}"


def _sample(name: str, labels: Mapping[str, str], value: float) -> str:
    shown = ",".join(f'{label}="{_escaped(text)}"' for label, text in labels.items())
    return f"{name}{{{shown}}} {_number(value)}" if shown else f"{name} {_number(value)}"


def _escaped(text: str) -> str:
    return text.replace("\\", r"\\").replace('"', r"\"").replace("\n", r"\n")


def _number(value: float) -> str:
    if math.isinf(value):
        return "+Inf" if value > 0 else "-Inf"
    return str(int(value)) if value == int(value) and abs(value) < 2**53 else repr(float(value))
