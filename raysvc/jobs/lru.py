"""A mapping that forgets what was used longest ago once it weighs too much."""

import threading
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

Value = TypeVar("Value")


@dataclass(frozen=True, slots=True)
class Counts:
    """What has happened in a mapping since it was made."""

    hits: int
    misses: int
    evictions: int
    held_bytes: int
    """What the values that are held weigh."""


class LeastRecentlyUsed(Generic[Value]):
    """Values by name, of at most `capacity` together; the newest is kept whatever it weighs.

    Safe to use from many threads.
    """

    def __init__(self, capacity: int, weigh: Callable[[Value], int]) -> None:
        self._capacity = capacity
        self._weigh = weigh
        self._values: OrderedDict[str, tuple[Value, int]] = OrderedDict()
        self._total = 0
        self._hits = self._misses = self._evictions = 0
        self._lock = threading.Lock()

    def __contains__(self, name: str) -> bool:
        """Is a value there? Asking is no use of it."""
        with self._lock:
            return name in self._values

    def get(self, name: str) -> Value | None:
        """Return a value, which thereby was used now, or None."""
        with self._lock:
            if name not in self._values:
                self._misses += 1
                return None
            self._hits += 1
            self._values.move_to_end(name)
            return self._values[name][0]

    def put(self, name: str, value: Value) -> None:
        """Keep a value; older ones make room for it."""
        weight = self._weigh(value)
        with self._lock:
            self._remove(name)
            self._values[name] = (value, weight)
            self._total += weight
            while self._total > self._capacity and len(self._values) > 1:
                self._remove(next(iter(self._values)))
                self._evictions += 1

    def drop(self, name: str) -> None:
        """Forget a value if it is there."""
        with self._lock:
            self._remove(name)

    @property
    def counts(self) -> Counts:
        """Lookups that found something, and that did not; what made room; what is held."""
        with self._lock:
            return Counts(self._hits, self._misses, self._evictions, self._total)

    def _remove(self, name: str) -> None:
        if name in self._values:
            self._total -= self._values.pop(name)[1]
