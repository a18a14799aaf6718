"""Bytes under a path, for libraries that read from files only.

On Linux the file is in memory, and has no other name than that of its descriptor. A process that is
about to lose the right to make files makes one first (`prepare`), and uses it for all that follow.
"""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager

_prepared: int | None = None


def prepare() -> None:
    """Make a file that all later ones of this process are written to; one at a time, then."""
    global _prepared
    if _prepared is None and hasattr(os, "memfd_create"):
        _prepared = os.memfd_create("raysvc-named")


@contextmanager
def named_file(data: bytes, suffix: str) -> Iterator[str]:
    """A path at which these bytes are, for as long as it is needed.

    Parameters
    ----------
    data
        what the file holds
    suffix
        how its name ends where files have names, such as `.hdr`
    """
    if not hasattr(os, "memfd_create"):
        with tempfile.TemporaryDirectory(prefix="raysvc-") as folder:
            path = os.path.join(folder, f"file{suffix}")
            with open(path, "wb") as file:
                file.write(data)
            yield path
        return
    descriptor = os.memfd_create("raysvc-named") if _prepared is None else _prepared
    try:
        _write(descriptor, data)
        yield f"/proc/self/fd/{descriptor}"
    finally:
        if descriptor == _prepared:
            os.ftruncate(descriptor, 0)
        else:
            os.close(descriptor)


def _write(descriptor: int, data: bytes) -> None:
    view, place = memoryview(data), 0
    while place < len(data):
        place += os.pwrite(descriptor, view[place:], place)
