"""The jobs of a service in SQLite, as they outlive the process.

Write-ahead log, and `synchronous=FULL`: when a call returns, what it wrote survives the death of
the process and the loss of power. That a job runs, and its signs of life, are the exception: they
survive the process alone, since after a loss of power nobody asks whose fault it was.
A row is written anew with each move of its job; `raysvc.jobs.model` knows the legal ones.
"""

import json
import sqlite3
import threading
import time
import weakref
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from raysvc.errors import RaysvcError, StorageFull
from raysvc.jobs.error_text import error_from, error_text
from raysvc.jobs.model import JobRecord, JobState
from raysvc.jobs.request_text import request_from, request_text

LEDGER_FILE: Final = "jobs.sqlite"
LAYOUT: Final = 2
"""Kept as SQLite's `user_version`."""

NO_ROOM: Final = frozenset({sqlite3.SQLITE_FULL, sqlite3.SQLITE_IOERR})
"""Primary codes of what a full disk looks like."""

SCHEMA: Final = """
CREATE TABLE jobs (
    number INTEGER PRIMARY KEY,          -- the order in which they were accepted
    id TEXT NOT NULL UNIQUE,
    state TEXT NOT NULL,
    attempts INTEGER NOT NULL,
    starts INTEGER NOT NULL,
    interruptions INTEGER NOT NULL,
    cancel_asked INTEGER NOT NULL,
    stage_fraction REAL NOT NULL,        -- of the stage that ran when this was written
    owner TEXT,                          -- the process that runs it, and that alone may move it
    heartbeat_s REAL,                    -- when that was last seen to get on
    created_s REAL NOT NULL,
    started_s REAL,
    finished_s REAL,
    request TEXT NOT NULL,
    statistics TEXT,
    error TEXT
);
CREATE INDEX unfinished ON jobs (number) WHERE finished_s IS NULL;
CREATE INDEX finished ON jobs (finished_s) WHERE finished_s IS NOT NULL;
CREATE TABLE idempotency_keys (
    key TEXT PRIMARY KEY,
    fingerprint TEXT NOT NULL,           -- of the request that it was first sent with
    job TEXT NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
    created_s REAL NOT NULL
);
"""

_FROM_LAYOUT_1: Final = """
ALTER TABLE jobs ADD COLUMN starts INTEGER NOT NULL DEFAULT 0;
ALTER TABLE jobs ADD COLUMN interruptions INTEGER NOT NULL DEFAULT 0;
UPDATE jobs SET starts = attempts;
ALTER TABLE keys RENAME TO idempotency_keys;
"""

_INSERT: Final = """
INSERT INTO jobs (id, state, attempts, starts, interruptions, cancel_asked, stage_fraction, owner,
                  heartbeat_s, created_s, started_s, finished_s, request, statistics, error)
VALUES (:id, :state, :attempts, :starts, :interruptions, :cancel_asked, :stage_fraction, :owner,
        :heartbeat_s, :created_s, :started_s, :finished_s, :request, :statistics, :error)
"""
_UPDATE: Final = """
UPDATE jobs SET state = :state, attempts = :attempts, starts = :starts,
    interruptions = :interruptions, cancel_asked = :cancel_asked,
    stage_fraction = :stage_fraction, owner = :owner, heartbeat_s = :heartbeat_s,
    started_s = :started_s, finished_s = :finished_s, statistics = :statistics, error = :error
WHERE id = :id AND (owner IS NULL OR owner = :me)
"""


@dataclass(frozen=True, slots=True)
class IdempotencyKey:
    """A name that a client gives to a request, so that sending it again does nothing again."""

    key: str
    fingerprint: str
    """Of the request, such as a hash of its body."""


class Ledger:
    """The jobs in a folder. Safe to use from many threads of the one process that owns it.

    Parameters
    ----------
    folder
        where the file is, or will be
    owner
        what running jobs are marked with
    kept_jobs
        how many jobs are remembered; of more, those go that finished first
    idempotency_key_life_s
        how long an idempotency key stands for its job, in seconds

    Raises RaysvcError for a damaged file, and for one of another layout.
    """

    def __init__(
        self, folder: Path, owner: str, kept_jobs: int, idempotency_key_life_s: float
    ) -> None:
        path = folder / LEDGER_FILE
        self._owner, self._kept_jobs, self._key_life_s = owner, kept_jobs, idempotency_key_life_s
        self._write_lock, self._read_lock = threading.Lock(), threading.Lock()
        try:
            self._writer, self._reader = _connected(path), _connected(path)
            self._closed = weakref.finalize(self, _close, self._reader, self._writer)
            _prepare(self._writer)
        except sqlite3.DatabaseError as error:
            raise RaysvcError(f"{path} cannot be used ({error}); move it away") from None

    def close(self) -> None:
        """Write the log back, and leave the file."""
        with self._read_lock, self._write_lock:
            self._closed()

    def accept(self, record: JobRecord, key: IdempotencyKey | None = None) -> None:
        """Write a new job down, and the key that it was sent with. Raises StorageFull."""
        with self._transaction() as cursor:
            self._forget(cursor)
            cursor.execute(_INSERT, self._row(record))
            if key is not None:
                cursor.execute(
                    "INSERT INTO idempotency_keys VALUES (?, ?, ?, ?)",
                    (key.key, key.fingerprint, record.id, time.time()),
                )

    def write(self, record: JobRecord) -> None:
        """Write down what became of a job.

        Raises StorageFull, and RaysvcError for a job that another process has taken over.
        """
        only_runs = record.state is JobState.RUNNING and not record.cancel_asked
        with self._transaction(sync=not only_runs) as cursor:
            cursor.execute(_UPDATE, self._row(record) | {"me": self._owner})
            if cursor.rowcount != 1:
                raise RaysvcError(f"another process has taken job {record.id} over")

    def take_over(self) -> None:
        """Become the owner of what others run: from now on, they cannot move it any more."""
        with self._transaction() as cursor:
            cursor.execute("UPDATE jobs SET owner = ? WHERE owner IS NOT NULL", (self._owner,))

    def beat(self, id: str) -> None:
        """Note that a job that runs here gets on."""
        with self._transaction(sync=False) as cursor:
            cursor.execute(
                "UPDATE jobs SET heartbeat_s = ? WHERE id = ? AND owner = ?",
                (time.time(), id, self._owner),
            )

    def find(self, id: str) -> JobRecord | None:
        """Return a job, or None. One whose request this version cannot read is not found."""
        found = self._read("SELECT * FROM jobs WHERE id = ?", (id,))
        try:
            return _record(found[0]) if found else None
        except ValueError:
            return None

    def unfinished(self) -> list[JobRecord]:
        """All jobs that wait or run, in the order in which they were accepted.

        Those whose request this version cannot read are written off.
        """
        records = []
        for row in self._read("SELECT * FROM jobs WHERE finished_s IS NULL ORDER BY number"):
            try:
                records.append(_record(row))
            except ValueError as error:
                self._write_off(row["id"], str(error))
        return records

    def keyed(self, key: str) -> tuple[str, str] | None:
        """Return the fingerprint and the job that a key stands for."""
        found = self._read(
            "SELECT fingerprint, job FROM idempotency_keys WHERE key = ? AND created_s > ?",
            (key, time.time() - self._key_life_s),
        )
        return (found[0]["fingerprint"], found[0]["job"]) if found else None

    def _forget(self, cursor: sqlite3.Cursor) -> None:
        """Make room for a new job and a new key."""
        cursor.execute(
            "DELETE FROM idempotency_keys WHERE created_s <= ?", (time.time() - self._key_life_s,)
        )
        (count,) = cursor.execute("SELECT count(*) FROM jobs").fetchone()
        surplus = count + 1 - self._kept_jobs
        if surplus > 0:
            cursor.execute(
                "DELETE FROM jobs WHERE number IN (SELECT number FROM jobs WHERE finished_s "
                "IS NOT NULL ORDER BY finished_s, number LIMIT ?)",
                (surplus,),
            )

    def _write_off(self, id: str, why: str) -> None:
        with self._transaction() as cursor:
            cursor.execute(
                "UPDATE jobs SET state = ?, finished_s = ?, error = ? WHERE id = ?",
                (JobState.FAILED, time.time(), error_text(RaysvcError(why)), id),
            )

    def _row(self, record: JobRecord) -> dict[str, Any]:
        running = record.state is JobState.RUNNING
        return {
            "id": record.id,
            "state": record.state,
            "attempts": record.attempts,
            "starts": record.starts,
            "interruptions": record.interruptions,
            "cancel_asked": record.cancel_asked,
            "stage_fraction": record.stage_fraction,
            "owner": self._owner if running else None,
            "heartbeat_s": record.heartbeat_s,
            "created_s": record.created_s,
            "started_s": record.started_s,
            "finished_s": record.finished_s,
            "request": request_text(record.request),
            "statistics": None if record.statistics is None else json.dumps(record.statistics),
            "error": None if record.error is None else error_text(record.error),
        }

    @contextmanager
    def _transaction(self, sync: bool = True) -> Iterator[sqlite3.Cursor]:
        """Commit what is done within, or nothing of it."""
        with self._write_lock:
            cursor = self._writer.cursor()
            try:
                cursor.execute(f"PRAGMA synchronous = {'FULL' if sync else 'NORMAL'}")
                cursor.execute("BEGIN IMMEDIATE")
                yield cursor
                cursor.execute("COMMIT")
            except sqlite3.Error as error:
                full = getattr(error, "sqlite_errorcode", 0) & 0xFF in NO_ROOM
                kind = StorageFull if full else RaysvcError
                raise kind(f"the job cannot be written down: {error}") from None
            finally:
                if self._writer.in_transaction:
                    self._writer.rollback()

    def _read(self, query: str, values: tuple[Any, ...] = ()) -> list[sqlite3.Row]:
        # Readers of a write-ahead log do not wait for the disk as the writer does.
        with self._read_lock:
            return self._reader.execute(query, values).fetchall()


def _connected(path: Path) -> sqlite3.Connection:
    connection = sqlite3.connect(path, isolation_level=None, check_same_thread=False, timeout=30)
    connection.row_factory = sqlite3.Row
    connection.execute("PRAGMA journal_mode = WAL")
    connection.execute("PRAGMA foreign_keys = ON")
    return connection


def _close(*connections: sqlite3.Connection) -> None:
    for connection in connections:
        connection.close()


def _prepare(connection: sqlite3.Connection) -> None:
    (layout,) = connection.execute("PRAGMA user_version").fetchone()
    if layout == 0:
        connection.executescript(f"BEGIN; {SCHEMA} PRAGMA user_version = {LAYOUT}; COMMIT;")
    elif layout == 1:
        connection.executescript(f"BEGIN; {_FROM_LAYOUT_1} PRAGMA user_version = {LAYOUT}; COMMIT;")
    elif layout != LAYOUT:
        raise sqlite3.DatabaseError(f"its layout is {layout}, and this version reads {LAYOUT}")


def _record(row: sqlite3.Row) -> JobRecord:
    statistics, error = row["statistics"], row["error"]
    return JobRecord(
        row["id"],
        request_from(row["request"]),
        JobState(row["state"]),
        row["attempts"],
        bool(row["cancel_asked"]),
        row["stage_fraction"],
        row["created_s"],
        row["started_s"],
        row["finished_s"],
        None if statistics is None else json.loads(statistics),
        None if error is None else error_from(error),
        row["starts"],
        row["interruptions"],
        row["heartbeat_s"],
    )
