"""Things that are made once and kept as long as what they were made from."""

import threading
import weakref
from collections.abc import Callable
from typing import Generic, TypeVar

Owner = TypeVar("Owner")
Made = TypeVar("Made")


class Kept(Generic[Owner, Made]):
    """Things made from an owner and a key, kept as long as the owner lives; the last few keys of
    each."""

    KEYS = 4

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._made: weakref.WeakKeyDictionary[Owner, dict[object, Made]] = (
            weakref.WeakKeyDictionary()
        )

    def find(self, owner: Owner, key: object) -> Made | None:
        """Return what was kept, or None."""
        with self._lock:
            made = self._made.get(owner, {})
            if key in made:
                made[key] = made.pop(key)  # most recently used last
            return made.get(key)

    def keep(self, owner: Owner, key: object, thing: Made) -> None:
        """Keep a thing in place of what was kept."""
        with self._lock:
            made = self._made.setdefault(owner, {})
            made.pop(key, None)
            made[key] = thing
            while len(made) > self.KEYS:
                del made[next(iter(made))]

    def get(self, owner: Owner, key: object, make: Callable[[], Made]) -> tuple[Made, bool]:
        """Return what was made earlier and True, or make it."""
        found = self.find(owner, key)
        if found is not None:
            return found, True
        thing = make()
        self.keep(owner, key, thing)
        return thing, False
