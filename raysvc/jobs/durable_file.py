"""Files that are whole or not there: written beside their place, synced, and renamed into it."""

import errno
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO, Final

from raysvc.errors import StorageFull

NO_ROOM: Final = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EFBIG})


@contextmanager
def room_needed(what: str) -> Iterator[None]:
    """Raise StorageFull for an OSError that says that the disk is full; `what` was to be kept."""
    try:
        yield
    except OSError as error:
        if error.errno not in NO_ROOM:
            raise
        raise StorageFull(f"there is no room on the disk for {what}") from None


def write_file(path: Path, content: bytes | Callable[[BinaryIO], None]) -> None:
    """Make a new file of bytes, or of what a function writes; returns when that would survive a
    loss of power."""
    with path.open("xb") as file:
        if callable(content):
            content(file)
        else:
            file.write(content)
        file.flush()
        os.fsync(file.fileno())


def sync_folder(folder: Path) -> None:
    """Return when the names in a folder would survive a loss of power, where a system can tell."""
    if os.name == "nt":
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
