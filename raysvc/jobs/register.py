"""All jobs: those that wait or run are objects, the others are looked up in the ledger."""

import logging
import threading
import time
from collections.abc import Callable, Mapping
from typing import Any, Final, TypeVar

from raysvc.errors import IdempotencyKeyReused, NotFound, RaysvcError, StorageFull
from raysvc.jobs.ledger import IdempotencyKey, Ledger
from raysvc.jobs.model import TRANSITIONS, Job, JobRecord, JobState
from raysvc.jobs.observer import Observer
from raysvc.jobs.queue import JobQueue
from raysvc.jobs.requests import ComparisonRequest, RenderRequest, Request

logger = logging.getLogger(__name__)

Asked = TypeVar("Asked", RenderRequest, ComparisonRequest)

HEARTBEAT_S: Final = 1.0
"""The shortest time between two signs of life that are written down."""


class JobRegister:
    """Accepts jobs, finds them again, and takes up those that another process left.

    A job is in the ledger before anyone hears of it, and so is whatever becomes of it; where the
    disk has no room for how a job ended, that is written down as soon as it has. Safe to use from
    many threads.
    """

    def __init__(self, ledger: Ledger, queue: JobQueue, observer: Observer) -> None:
        self._ledger, self._queue, self._observer = ledger, queue, observer
        self._unfinished: dict[str, Job[Any]] = {}
        self._unwritten: dict[str, JobRecord] = {}
        """How jobs ended that the ledger still thinks unfinished."""
        self._accepting = threading.Lock()
        self._beaten_s = 0.0

    def recover(
        self, held: Callable[[Request], Mapping[str, Any] | None] = lambda request: None
    ) -> None:
        """Queue what waited or ran when an earlier process ended.

        `held` returns what there is to say about a result that is kept already, or None. Whoever
        calls this owns the folder: a process that has jobs there is dead, or has lost them.
        """
        self._ledger.take_over()
        for record in self._ledger.unfinished():
            job = Job.restored(record)
            job.keep = self._keep
            self._unfinished[job.id] = job
            if job.state is JobState.RUNNING:
                silent_s = time.time() - (job.heartbeat_s or job.created_s)
                logger.warning(
                    "job %s was running when its process ended; last seen %.0f s ago",
                    job.id,
                    silent_s,
                )
                job.recover(held(job.request))
            if job.state is JobState.QUEUED:
                self._observe(job)
                self._queue.put_back(job)

    def accept(self, job: Job[Asked], key: IdempotencyKey | None = None) -> Job[Asked]:
        """Take a new job in; returns that which the key stands for, if it was sent before.

        Raises QueueFull, Draining, IdempotencyKeyReused, StorageFull.
        """
        with self._accepting:
            self._settle()
            known = self.keyed(key, type(job.request))
            if known is not None:
                return known
            waits = job.state is JobState.QUEUED
            if waits:
                self._queue.check_room()
                # Before the ledger knows the key: whoever sends it again finds this very job.
                self._unfinished[job.id] = job
            job.keep = self._keep
            try:
                self._ledger.accept(job.record(), key)
            except RaysvcError:
                self._unfinished.pop(job.id, None)
                raise
            self._observe(job)
            if waits:
                # It is accepted now, even if the queue was closed meanwhile: then it is left to
                # the next process.
                self._queue.put_back(job)
        return job

    def keyed(self, key: IdempotencyKey | None, kind: type[Asked]) -> Job[Asked] | None:
        """Return the job that a key stands for, or None. Raises IdempotencyKeyReused."""
        known = None if key is None else self._ledger.keyed(key.key)
        if key is None or known is None:
            return None
        fingerprint, id = known
        if fingerprint != key.fingerprint:
            raise IdempotencyKeyReused(
                "was sent with another request before", field="Idempotency-Key"
            )
        return self.find(id, kind)

    def find(self, id: str, kind: type[Asked]) -> Job[Asked]:
        """Return a job that was asked for with such a request. Raises NotFound."""
        job = self._unfinished.get(id)
        if job is None:
            record = self._unwritten.get(id) or self._ledger.find(id)
            job = None if record is None else Job.restored(record)
        if job is None or not isinstance(job.request, kind):
            raise NotFound(f"no {kind.kind} {id[:64]!r}", field=kind.kind)
        return job

    def unfinished(self) -> list[Job[Any]]:
        """All jobs that wait or run."""
        return list(self._unfinished.values())

    def beat(self, job: Job[Request]) -> None:
        """Note that a running job gets on; written down now and then."""
        now = time.monotonic()
        if now - self._beaten_s < HEARTBEAT_S:
            return
        self._beaten_s = now
        self._settle()
        try:
            self._ledger.beat(job.id)
        except RaysvcError as error:
            logger.warning("%s", error)

    def close(self) -> None:
        """Write down what there was no room for, if there is now."""
        self._settle()

    def _settle(self) -> None:
        for id, record in list(self._unwritten.items()):
            try:
                self._ledger.write(record)
            except StorageFull:
                return
            except RaysvcError as error:
                logger.warning("%s", error)
            self._unwritten.pop(id, None)

    def _observe(self, job: Job[Any]) -> None:
        self._observer.accepted(job)
        job.finished.add_done_callback(lambda _: self._observer.ended(job))

    def _keep(self, record: JobRecord) -> None:
        job, ended = self._unfinished.get(record.id), not TRANSITIONS[record.state]
        try:
            self._ledger.write(record)
        except RaysvcError:
            if job is not None and _asked_by_client(job, record):
                raise
            # It goes on nevertheless: what is not written down is done again after a restart.
            logger.exception("job %s is %s", record.id, record.state)
            if ended:
                self._unwritten[record.id] = record
        if ended:
            self._unfinished.pop(record.id, None)


def _asked_by_client(job: Job[Any], record: JobRecord) -> bool:
    """Is a record that of a job that somebody cancels? Whoever asks can be told that it failed."""
    if record.state is JobState.CANCELLED:
        return job.state is JobState.QUEUED
    return record.cancel_asked and record.state is job.state
