"""Which of the things on the disk make room for others."""

import threading
from collections import OrderedDict
from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class DiskCounts:
    """What has happened on the disk since this process looks after it."""

    evictions: int
    """Things that made room."""
    held_bytes: int
    """What all files take; a file with two names counts twice."""


class DiskBudget:
    """Names with their sizes, from the one that was not used longest to the one used last.

    `needed` says which may not go, whatever the budget. Safe to use from many threads.
    """

    def __init__(
        self, budget_bytes: int, needed: Callable[[], Collection[str]] = frozenset[str]
    ) -> None:
        self._budget, self._needed = budget_bytes, needed
        self._sizes: OrderedDict[str, int] = OrderedDict()
        self._evictions = 0
        self._lock = threading.Lock()

    def __contains__(self, name: object) -> bool:
        with self._lock:
            return name in self._sizes

    @property
    def counts(self) -> DiskCounts:
        """What made room, and what everything takes."""
        with self._lock:
            return DiskCounts(self._evictions, sum(self._sizes.values()))

    def take_in(self, items: Iterable[tuple[int, str, int]]) -> None:
        """Add what was found on the disk: (time of last use, name, bytes)."""
        for _, name, size in sorted(items):
            self.add(name, size)

    def add(self, name: str, size: int) -> None:
        """Add a thing, which is used now."""
        with self._lock:
            self._sizes[name] = size
            self._sizes.move_to_end(name)

    def touch(self, name: str) -> bool:
        """Note that a thing is used now; False if it is not there."""
        with self._lock:
            if name not in self._sizes:
                return False
            self._sizes.move_to_end(name)
            return True

    def drop(self, name: str) -> None:
        """Forget a thing if it is there."""
        with self._lock:
            self._sizes.pop(name, None)

    def surplus(self) -> list[str]:
        """Take out what has to go, so that the rest fits; what was used last always stays."""
        with self._lock:
            total = sum(self._sizes.values())
            if total <= self._budget:
                return []
            needed, gone = self._needed(), []
            for name in list(self._sizes)[:-1]:
                if total <= self._budget:
                    break
                if name not in needed:
                    total -= self._sizes.pop(name)
                    gone.append(name)
            self._evictions += len(gone)
            return gone

    def oldest(self) -> str | None:
        """Take out what was not used longest and may go, or None."""
        with self._lock:
            needed = self._needed()
            name = next((name for name in self._sizes if name not in needed), None)
            if name is not None:
                del self._sizes[name]
                self._evictions += 1
            return name
