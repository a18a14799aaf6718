"""Finished results on the disk: files by the name of their request, within a budget."""

import contextlib
import errno
import logging
import os
import secrets
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from numpy.typing import NDArray

from raysvc.jobs.array_file import Arrays, read_arrays, write_arrays
from raysvc.jobs.disk_budget import DiskBudget, DiskCounts
from raysvc.jobs.durable_file import room_needed, sync_folder, write_file

logger = logging.getLogger(__name__)

UNFINISHED: Final = "incoming"
"""Where files are written before they are whole; emptied at start."""
SLACK_BYTES: Final = 64 << 10
"""What a file takes beside its arrays, at most, for all that makes room for it."""


class ResultFolder:
    """Arrays by name, of at most `budget_bytes` together; the newest is kept whatever it weighs.

    Those that were not asked for longest make room, also when the disk is full. A file appears
    whole, or not at all. Safe to use from many threads of the one process that owns the folder.
    """

    def __init__(self, folder: Path, budget_bytes: int) -> None:
        self._folder = folder
        self._incoming = folder / UNFINISHED
        shutil.rmtree(self._incoming, ignore_errors=True)
        self._incoming.mkdir(parents=True)
        self._budget = DiskBudget(budget_bytes)
        files = [entry for entry in os.scandir(folder) if entry.is_file()]
        stats = [(entry.stat(), entry.name) for entry in files]
        self._budget.take_in((stat.st_mtime_ns, name, stat.st_size) for stat, name in stats)
        self._evict(self._budget.surplus())

    @property
    def counts(self) -> DiskCounts:
        """How many files made room since the folder was opened, and what the others take."""
        return self._budget.counts

    def put(self, name: str, about: Mapping[str, Any], arrays: Arrays) -> None:
        """Keep arrays and what is said about them. Raises StorageFull.

        On a full disk about as much makes room as these take; what is too large for that, or for
        one file, costs the others no more.
        """
        lacking = sum(array.nbytes for array in arrays.values()) + SLACK_BYTES
        with room_needed("a result"):
            while True:
                try:
                    self._write(name, about, arrays)
                    break
                except OSError as error:
                    oldest = None
                    if error.errno in (errno.ENOSPC, errno.EDQUOT) and lacking > 0:
                        oldest = self._budget.oldest()
                    if oldest is None:
                        raise
                    with contextlib.suppress(FileNotFoundError):
                        lacking -= (self._folder / oldest).stat().st_size
                    self._evict([oldest])
        self._evict(self._budget.surplus())

    def get(self, name: str) -> tuple[dict[str, Any], dict[str, NDArray[Any]]] | None:
        """Return what is kept under a name, which thereby was used now, or None."""
        path = self._folder / name
        if not self.touch(name):
            return None
        try:
            return read_arrays(path)
        except FileNotFoundError:
            return None
        except (OSError, ValueError, KeyError, TypeError):
            logger.warning("dropping the damaged result %s", path)
            self._budget.drop(name)
            path.unlink(missing_ok=True)
            return None

    def touch(self, name: str) -> bool:
        """Note that something is used now; False if it is not there."""
        if not self._budget.touch(name):
            return False
        try:
            os.utime(self._folder / name)
        except OSError:
            return False
        return True

    def _write(self, name: str, about: Mapping[str, Any], arrays: Arrays) -> None:
        draft = self._incoming / secrets.token_hex(16)
        try:
            write_file(draft, lambda file: write_arrays(file, about, arrays))
            size = draft.stat().st_size
            draft.replace(self._folder / name)
            self._budget.add(name, size)
            sync_folder(self._folder)
        finally:
            draft.unlink(missing_ok=True)

    def _evict(self, names: list[str]) -> None:
        for name in names:
            (self._folder / name).unlink(missing_ok=True)
