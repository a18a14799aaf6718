"""Finished pictures, held in memory by the name of their request."""

from raysvc.jobs.lru import Counts, LeastRecentlyUsed
from raysvc.jobs.renderer import Picture


class Results:
    """Pictures by request name; those that were not asked for longest make room for new ones."""

    def __init__(self, memory_bytes: int) -> None:
        self._pictures: LeastRecentlyUsed[Picture] = LeastRecentlyUsed(memory_bytes, _bytes_of)

    def put(self, name: str, picture: Picture) -> None:
        """Keep a picture."""
        self._pictures.put(name, picture)

    def get(self, name: str) -> Picture | None:
        """Return a picture if it is still held."""
        return self._pictures.get(name)

    @property
    def counts(self) -> Counts:
        """How often pictures were held when they were asked for."""
        return self._pictures.counts


def _bytes_of(picture: Picture) -> int:
    return sum(layer.nbytes for layer in picture.layers.values())
