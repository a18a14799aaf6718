"""The keys of a service, in a SQLite file of their own.

`raysvc keys` writes it and the running service reads it: a key that is added or revoked counts from
the next request on. The service looks at the file's change counter each time (SQLite's database
header, offset 24), for which it need not wait for who writes, and reads the keys when it changed.

Revoked keys stay in the file, so that a service whose last key was revoked lets nobody in, rather
than everybody.
"""

import os
import sqlite3
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

from raysvc.access.key import ApiKey, digest_of, id_in, is_key_of, new_secret
from raysvc.access.scopes import Scope
from raysvc.errors import InvalidSetting, NotFound, RaysvcError

FILE: Final = "keys.sqlite"
LONGEST_NAME: Final = 100
PATIENCE_S: Final = 5.0
"""How long to wait for another process that is writing."""

HEADER_BYTES, COUNTER_AT = 28, 24
Stamp = tuple[int, int, int, bytes] | None
"""Which file there is, how long it is, and its change counter; None without one."""

_TABLE: Final = """
CREATE TABLE IF NOT EXISTS keys (
    id TEXT PRIMARY KEY, name TEXT NOT NULL, scope TEXT NOT NULL, digest BLOB NOT NULL,
    created_s REAL NOT NULL, revoked_s REAL
) STRICT
"""
_COLUMNS: Final = "id, name, scope, digest, created_s, revoked_s"
_NO_DIGEST: Final = bytes(32)
"""What a key that is not there is compared with, so that its absence takes as long as a wrong
secret."""


class KeyStore:
    """Keys by id, in the folder that holds a service's data. Safe to use from many threads."""

    def __init__(self, data_dir: Path) -> None:
        self._path = data_dir / FILE
        self._lock = threading.Lock()
        self._connection: sqlite3.Connection | None = None
        self._guarded = False
        self._remembered: tuple[Stamp, Mapping[str, ApiKey]] | None = None

    @property
    def is_fresh(self) -> bool:
        """Whether what is remembered of the file is what it holds; never waits for a writer."""
        return self._remembered is not None and self._remembered[0] == self._stamp()

    def refresh(self) -> None:
        """Read the file, if it has changed; may wait. Raises RaysvcError where SQLite fails."""
        self._known()

    @property
    def guarded(self) -> bool:
        """Whether requests need a key: once there was one, until this object is gone."""
        if not self._guarded:
            self._guarded = bool(self._known())
        return self._guarded

    def add(self, name: str, scope: Scope) -> str:
        """Make a key; returns it, for the only time. Raises InvalidSetting for a bad name."""
        if not name.isprintable() or not 1 <= len(name) <= LONGEST_NAME:
            raise InvalidSetting(f"must be 1 to {LONGEST_NAME} printable characters", field="name")
        id, key = new_secret()
        self._path.parent.mkdir(parents=True, exist_ok=True)
        with self._opened(create=True) as connection:
            connection.execute(
                f"INSERT INTO keys ({_COLUMNS}) VALUES (?, ?, ?, ?, ?, NULL)",
                (id, name, str(scope), digest_of(key), time.time()),
            )
        return key

    def keys(self) -> list[ApiKey]:
        """All keys that there ever were, oldest first."""
        return [_key(row) for row in self._rows(f"SELECT {_COLUMNS} FROM keys ORDER BY created_s")]

    def revoke(self, id: str) -> ApiKey:
        """Let a key in no more; doing it again changes nothing. Raises NotFound."""
        if self._rows("SELECT 1 FROM keys WHERE id = ?", id):
            with self._opened() as connection:
                connection.execute(
                    "UPDATE keys SET revoked_s = ? WHERE id = ? AND revoked_s IS NULL",
                    (time.time(), id),
                )
        found = self._rows(f"SELECT {_COLUMNS} FROM keys WHERE id = ?", id)
        if not found:
            raise NotFound(f"no key {id[:64]!r}", field="id")
        return _key(found[0])

    def check(self, key: str) -> ApiKey | None:
        """The entry of a key that is good, or None."""
        entry = self._known().get(id_in(key) or "")
        same = is_key_of(key, entry.digest if entry else _NO_DIGEST)
        return entry if same and entry is not None and entry.revoked_s is None else None

    def close(self) -> None:
        """Let go of the file."""
        with self._lock:
            if self._connection is not None:
                self._connection.close()
                self._connection = None

    def _known(self) -> Mapping[str, ApiKey]:
        """All keys by their ids."""
        # Looked at before the file is read: what is written meanwhile is read the next time.
        stamp, remembered = self._stamp(), self._remembered
        if remembered is not None and remembered[0] == stamp:
            return remembered[1]
        self.close()  # it may be another file by now
        keys = {key.id: key for key in self.keys()}
        self._remembered = stamp, keys
        return keys

    def _stamp(self) -> Stamp:
        try:
            with self._path.open("rb") as file:
                status, counter = os.fstat(file.fileno()), file.read(HEADER_BYTES)[COUNTER_AT:]
        except FileNotFoundError:
            return None
        return status.st_dev, status.st_ino, status.st_size, counter

    def _rows(self, query: str, *values: str) -> list[tuple[Any, ...]]:
        if not self._path.exists():
            return []
        with self._opened() as connection:
            return connection.execute(query, values).fetchall()

    @contextmanager
    def _opened(self, create: bool = False) -> Iterator[sqlite3.Connection]:
        """Hold the connection for one transaction. Raises RaysvcError where SQLite fails."""
        try:
            with self._lock, self._connected(create) as connection:
                yield connection
        except sqlite3.Error as error:
            raise RaysvcError(f"{self._path} cannot be used: {error}") from None

    def _connected(self, create: bool) -> sqlite3.Connection:
        if self._connection is None:
            if create:
                # Nobody else has a reason to read it, though it opens nothing.
                os.close(os.open(self._path, os.O_CREAT | os.O_RDWR, 0o600))
            self._connection = sqlite3.connect(
                self._path, timeout=PATIENCE_S, check_same_thread=False
            )
            self._connection.execute(_TABLE)
        return self._connection


def _key(row: tuple[Any, ...]) -> ApiKey:
    id, name, scope, digest, created_s, revoked_s = row
    return ApiKey(id, name, Scope(scope), digest, created_s, revoked_s)
