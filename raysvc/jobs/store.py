"""Scenes and environments, named by the SHA-256 of their content.

    FOLDER/ID/record.json     what the thing is called, its files, what is said of it
    FOLDER/ID/0, 1, ...       the files as they were sent
    FOLDER/incoming/...       what is being written; a rename makes it visible, whole

Only numbers become file names, whatever names a caller sends. The parsed things are kept in memory
while there is room. One process owns a folder.
"""

import contextlib
import hashlib
import json
import logging
import os
import secrets
import shutil
import time
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final, Generic, TypeVar

from raysvc.errors import InUse, InvalidSetting, NotFound
from raysvc.jobs.disk_budget import DiskBudget, DiskCounts
from raysvc.jobs.durable_file import room_needed, sync_folder, write_file
from raysvc.jobs.lru import Counts, LeastRecentlyUsed
from raysvc.loading.scene_file import BUILTIN_PREFIX
from raysvc.version import VERSION

logger = logging.getLogger(__name__)

Thing = TypeVar("Thing")

ID_DIGITS: Final = 64
RECORD_FILE: Final = "record.json"
"""In the folder of a thing; its time is that of the last use."""
UNBOUNDED: Final = 1 << 62


@dataclass(frozen=True, slots=True)
class Upload:
    """Files as a caller sent them; `main` says which one is the scene where several could be."""

    files: Mapping[str, bytes]
    main: str | None = None

    @property
    def id(self) -> str:
        """SHA-256 in hex of the sorted names with their contents."""
        digest = hashlib.sha256((self.main or "").encode() + b"\0")
        for name, data in sorted(self.files.items()):
            digest.update(f"{name}\0{len(data)}\0".encode())
            digest.update(data)
        return digest.hexdigest()


@dataclass(frozen=True, slots=True)
class Record:
    """What is kept about a thing, beside its files."""

    id: str
    created_s: float
    summary: dict[str, Any]
    builtin: str | None = None
    """Name of the built-in thing; it then has no files."""
    main: str | None = None
    files: tuple[str, ...] = ()
    """Names of the files 0, 1, ..."""
    version: str = VERSION
    rest: str | None = None
    """Of a deformed scene, the name of the scene that it was made from."""
    rest_builtin: str | None = None
    """That scene's `builtin`."""


@dataclass(frozen=True, slots=True)
class Kind(Generic[Thing]):
    """What a store must know about the things in it."""

    name: str
    load: Callable[[str | Upload], Thing]
    """From `builtin:NAME` or files; raises InvalidInput."""
    summarise: Callable[[Thing], dict[str, Any]]
    weigh: Callable[[Thing], int]
    """Bytes in memory."""


class ContentStore(Generic[Thing]):
    """Immutable things by name. Adding the same content twice is one thing.

    Parameters
    ----------
    folder
        where they are kept; owned by one process
    kind
        what they are
    memory_bytes
        for those that are held parsed
    disk_bytes
        for all files; what was not used longest makes room for what is new
    needed
        says what may not go, whatever the budget
    """

    def __init__(
        self,
        folder: Path,
        kind: Kind[Thing],
        memory_bytes: int,
        disk_bytes: int = UNBOUNDED,
        needed: Callable[[], Collection[str]] = frozenset[str],
    ) -> None:
        self._folder = folder
        self._kind = kind
        self._parsed: LeastRecentlyUsed[Thing] = LeastRecentlyUsed(memory_bytes, kind.weigh)
        shutil.rmtree(folder / "incoming", ignore_errors=True)
        (folder / "incoming").mkdir(parents=True)
        found = [_read_record(path) for path in folder.iterdir() if len(path.name) == ID_DIGITS]
        self._records = {record.id: record for record in found if record is not None}
        self._needed = needed
        self._budget = DiskBudget(disk_bytes, needed)
        self._budget.take_in(_use_and_size(folder / id) for id in self._records)
        self._evict()

    def add(self, upload: Upload) -> tuple[Record, bool]:
        """Parse and keep; returns the record and whether it is new. Bad input leaves nothing."""
        id = upload.id
        known = self._records.get(id)
        if known is not None:
            self._touch(id)
            return known, False
        thing = self._kind.load(upload)
        record = Record(
            id, time.time(), self._kind.summarise(thing), None, upload.main, tuple(upload.files)
        )
        return self._keep(record, thing, list(upload.files.values()))

    def add_builtin(self, name: str) -> tuple[Record, bool]:
        """Keep the built-in thing of that name, without `builtin:`. Raises InvalidSetting."""
        id = hashlib.sha256(f"{BUILTIN_PREFIX}{name}\0{VERSION}".encode()).hexdigest()
        known = self._records.get(id)
        if known is not None:
            self._touch(id)
            return known, False
        try:
            thing = self._kind.load(BUILTIN_PREFIX + name)
        except NotFound as error:
            raise InvalidSetting(error.message, field="builtin") from None
        record = Record(id, time.time(), self._kind.summarise(thing), builtin=name)
        return self._keep(record, thing, [])

    def record(self, id: str) -> Record:
        """Return what is known about a thing. Raises NotFound."""
        try:
            return self._records[id]
        except KeyError:
            raise NotFound(f"no {self._kind.name} {id[:ID_DIGITS]!r}", self._kind.name) from None

    def records(self) -> list[Record]:
        """All that is kept, newest first."""
        return sorted(self._records.values(), key=lambda r: (-r.created_s, r.id))

    def get(self, id: str) -> Thing:
        """Return the thing itself, parsed again if it had to make room. Raises NotFound."""
        record = self.record(id)
        thing = self._parsed.get(id)
        self._touch(id)
        if thing is None:
            thing = self._load(record)
            self._parsed.put(id, thing)
        return thing

    @property
    def counts(self) -> Counts:
        """How often parsed things were held when they were asked for."""
        return self._parsed.counts

    @property
    def disk_counts(self) -> DiskCounts:
        """How many things made room since the store was opened, and what the others' files take."""
        return self._budget.counts

    def delete(self, id: str) -> None:
        """Forget a thing and its files. Raises NotFound, and InUse for what jobs need."""
        self.record(id)
        if id in self._needed():
            raise InUse(f"jobs are going to need the {self._kind.name}", self._kind.name)
        self._remove(id)

    def _remove(self, id: str) -> None:
        self._records.pop(id, None)
        self._parsed.drop(id)
        self._budget.drop(id)
        grave = self._folder / "incoming" / secrets.token_hex(16)
        try:
            (self._folder / id).rename(grave)
        except FileNotFoundError:
            return  # another thread was quicker
        shutil.rmtree(grave, ignore_errors=True)

    def _touch(self, id: str) -> None:
        """Note that a thing is used now."""
        if self._budget.touch(id):
            with contextlib.suppress(OSError):
                os.utime(self._folder / id / RECORD_FILE)

    def _evict(self) -> None:
        for id in self._budget.surplus():
            logger.info("the %s %s makes room", self._kind.name, id)
            self._remove(id)

    def _load(self, record: Record) -> Thing:
        if record.builtin is not None:
            return self._kind.load(BUILTIN_PREFIX + record.builtin)
        files = dict(zip(record.files, self._read(record), strict=True))
        return self._kind.load(Upload(files, record.main))

    def _read(self, record: Record) -> list[bytes]:
        """Contents of a record's files."""
        folder = self._folder / record.id
        try:
            return [(folder / str(number)).read_bytes() for number in range(len(record.files))]
        except FileNotFoundError:
            raise self._deleted() from None

    def _deleted(self) -> NotFound:
        return NotFound(f"the {self._kind.name} was deleted", self._kind.name)

    def _keep(
        self, record: Record, thing: Thing, files: Sequence[bytes | Path]
    ) -> tuple[Record, bool]:
        """Make a record and its files visible; a path is a file that is in the store already."""
        draft = self._folder / "incoming" / secrets.token_hex(16)
        try:
            draft.mkdir()
            for number, data in enumerate(files):
                if isinstance(data, Path):
                    _link(data, draft / str(number))
                else:
                    write_file(draft / str(number), data)
            write_file(draft / RECORD_FILE, json.dumps(asdict(record)).encode())
            sync_folder(draft)
            draft.rename(self._folder / record.id)
            sync_folder(self._folder)
        except FileExistsError:
            return self._records.setdefault(record.id, record), False
        except FileNotFoundError:
            raise self._deleted() from None
        except OSError as error:
            # Renaming onto a folder that is not empty: another thread has kept the same content.
            if not (self._folder / record.id / RECORD_FILE).is_file():
                with room_needed(f"the {self._kind.name}"):
                    raise error from None
            return self._records.setdefault(record.id, record), False
        finally:
            shutil.rmtree(draft, ignore_errors=True)
        self._records[record.id] = record
        self._parsed.put(record.id, thing)
        _, _, size = _use_and_size(self._folder / record.id)
        self._budget.add(record.id, size)
        self._evict()
        return record, True


def _link(file: Path, copy: Path) -> None:
    """Let two names lead to one file, where the file system can, or copy it."""
    try:
        os.link(file, copy)
    except FileNotFoundError:
        raise
    except OSError:
        shutil.copyfile(file, copy)


def _use_and_size(folder: Path) -> tuple[int, str, int]:
    """When a thing was last used, its name, and the bytes of its files."""
    stats = [entry.stat() for entry in os.scandir(folder)]
    return max(s.st_mtime_ns for s in stats), folder.name, sum(s.st_size for s in stats)


def _read_record(folder: Path) -> Record | None:
    """Read what an earlier process kept; skip what is damaged, or depends on another version."""
    try:
        values = json.loads((folder / RECORD_FILE).read_text(encoding="utf-8"))
        record = Record(**{**values, "files": tuple(values["files"])})
    except (OSError, ValueError, TypeError, KeyError):
        logger.warning("skipping the damaged entry %s", folder)
        return None
    # What is made in code, and the order of vertices, may be others in another version.
    depends = record.builtin is not None or record.rest is not None
    stale = depends and record.version != VERSION
    return None if stale or record.id != folder.name else record
