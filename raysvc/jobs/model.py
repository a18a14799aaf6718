"""A job: what was asked for, and how far it is."""

import threading
import time
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from dataclasses import dataclass, replace
from enum import StrEnum
from types import MappingProxyType
from typing import Any, Final, Generic, TypeVar

from raysvc.errors import Crashed, RaysvcError
from raysvc.jobs.requests import Request
from raysvc.parallel import Control


class JobState(StrEnum):
    """Where a job is in its life."""

    QUEUED = "queued"
    RUNNING = "running"
    DONE = "done"
    FAILED = "failed"
    CANCELLED = "cancelled"


TRANSITIONS: Final[Mapping[JobState, frozenset[JobState]]] = MappingProxyType(
    {
        JobState.QUEUED: frozenset({JobState.RUNNING, JobState.DONE, JobState.CANCELLED}),
        JobState.RUNNING: frozenset(
            {JobState.DONE, JobState.FAILED, JobState.CANCELLED, JobState.QUEUED}
        ),
        JobState.DONE: frozenset(),
        JobState.FAILED: frozenset(),
        JobState.CANCELLED: frozenset(),
    }
)
"""What may follow what. A queued job is done at once when its result is already held; a running one
is queued again when the process ends before it does."""

MOST_ATTEMPTS: Final = 3
"""A job that was running so often when the process died is not tried again."""

MOST_FALSE_STARTS: Final = 10
"""Nor is one that the process died of so often while it only read what the job needs."""

REVISIONS_OF_A_START: Final = 1_000_000
"""Revisions after a restart are greater than those before it; that of the end is known again."""


@dataclass(frozen=True, slots=True)
class JobRecord:
    """What outlives the process."""

    id: str
    request: Request
    state: JobState
    attempts: int
    """How often its work was begun; not counted when the process was told to end meanwhile."""
    cancel_asked: bool
    stage_fraction: float
    created_s: float
    started_s: float | None
    finished_s: float | None
    statistics: Mapping[str, Any] | None
    error: RaysvcError | None
    starts: int = 0
    """How often its turn came."""
    interruptions: int = 0
    """How often the process was told to end meanwhile."""
    heartbeat_s: float | None = None
    """When it was last seen to get on, in seconds since 1970; None before its turn came."""


Asked = TypeVar("Asked", bound=Request, covariant=True)

Keep = Callable[[JobRecord], None]


class Job(Generic[Asked]):
    """One request on its way to its result. Any thread may look; changes go through methods.

    Every move is handed to `keep` before anyone can see it.
    """

    def __init__(self, id: str, request: Asked) -> None:
        self.id = id
        self.request = request
        self.state = JobState.QUEUED
        self.attempts = 0
        """How often it ran, this time included."""
        self.starts = self.interruptions = 0
        self.heartbeat_s: float | None = None
        self.stage: str | None = None
        self.stage_fraction = 0.0
        self.revision = 0
        """Grows with everything that there is to say; see `REVISIONS_OF_A_START`."""
        self.created_s = time.time()
        self.started_s: float | None = None
        self.finished_s: float | None = None
        self.statistics: Mapping[str, Any] | None = None
        self.error: RaysvcError | None = None
        self.finished: Future[None] = Future()
        """Resolved when the job is done, failed or cancelled; its result is always None."""
        self.keep: Keep = _keep_nothing
        self._cancel_asked = False
        self._control: Control | None = None
        self._begun = True
        """Does the attempt that runs count already?"""
        self._lock = threading.RLock()

    @classmethod
    def restored(cls, record: JobRecord) -> "Job[Any]":
        """Return the job that a record was made of; what was running is so no longer."""
        job: Job[Any] = cls(record.id, record.request)  # type: ignore[arg-type]
        job.state, job.attempts = record.state, record.attempts
        job.starts, job.interruptions = record.starts, record.interruptions
        job.heartbeat_s = record.heartbeat_s
        ended = not TRANSITIONS[record.state]
        job.revision = (record.starts + ended) * REVISIONS_OF_A_START
        job.stage_fraction = record.stage_fraction
        job.created_s, job.started_s = record.created_s, record.started_s
        job.finished_s, job.statistics = record.finished_s, record.statistics
        job.error, job._cancel_asked = record.error, record.cancel_asked
        if ended:
            job.finished.set_result(None)
        return job

    def record(self) -> JobRecord:
        """What there is to keep."""
        with self._lock:
            return self._record(self.state)

    def start(self, control: Control) -> bool:
        """Begin to run, unless the job was cancelled while it waited.

        The attempt counts against the job from `begin` on.
        """
        with self._lock:
            if self.state is not JobState.QUEUED:
                return False
            self._control, self._begun = control, False
            self.started_s = self.heartbeat_s = time.time()
            self.attempts += 1
            self.starts += 1
            self._move(JobState.RUNNING)
            return True

    def begin(self) -> None:
        """Everything is at hand, and the work itself comes now: what ends the process from here on
        may be this job's fault."""
        with self._lock:
            if not self._begun:
                self._begun = True
                self.keep(self._record(self.state))

    def report(self, stage: str, fraction: float) -> None:
        """Note which stage is running, and how much of it is done."""
        self.stage, self.stage_fraction = stage, fraction
        self.heartbeat_s = time.time()
        self.revision += 1

    def finish(self, statistics: Mapping[str, Any]) -> None:
        """The result is there."""
        with self._lock:
            self._move(JobState.DONE, statistics=statistics)

    def fail(self, error: RaysvcError) -> None:
        """There will be no result, and why."""
        with self._lock:
            self._move(JobState.FAILED, error=error)

    def stop(self) -> None:
        """The running job heeded `cancel`, or `interrupt`: then it will run again."""
        with self._lock:
            if self._cancel_asked:
                self._move(JobState.CANCELLED)
            else:
                self.attempts -= 1
                self.interruptions += 1
                self._begun = True
                self._move(JobState.QUEUED)

    def recover(self, held: Mapping[str, Any] | None = None) -> None:
        """The process that ran the job is no more: run it again, unless that was tried enough.

        `held` is what there is to say about its result, if that process came to keep it.
        """
        false_starts = self.starts - self.interruptions - self.attempts
        with self._lock:
            if self._cancel_asked:
                self._move(JobState.CANCELLED)
            elif held is not None:
                self._move(JobState.DONE, statistics=held)
            elif self.attempts >= MOST_ATTEMPTS:
                self.fail(
                    Crashed(f"the process ended {self.attempts} times while it did this work")
                )
            elif false_starts >= MOST_FALSE_STARTS:
                self.fail(
                    Crashed(f"the process ended {false_starts} times before it could begin this")
                )
            else:
                self._move(JobState.QUEUED)

    def cancel(self) -> None:
        """Ask for the job to end: at once while it waits, at its next check while it runs.

        Raises what `keep` does, and then nothing was asked.
        """
        with self._lock:
            if not TRANSITIONS[self.state]:
                return
            before, self._cancel_asked = self._cancel_asked, True
            try:
                if self._control is None:
                    self._move(JobState.CANCELLED)
                else:
                    self.keep(self._record(self.state))
                    self._control.cancel()
            except RaysvcError:
                self._cancel_asked = before
                raise

    def interrupt(self) -> None:
        """Ask a running job to end for now."""
        with self._lock:
            if self._control is not None:
                self._control.cancel()

    def _move(
        self,
        state: JobState,
        statistics: Mapping[str, Any] | None = None,
        error: RaysvcError | None = None,
    ) -> None:
        if state not in TRANSITIONS[self.state]:
            raise AssertionError(f"a {self.state} job cannot become {state}")
        ended = not TRANSITIONS[state]
        finished_s = time.time() if ended else None
        self._begun = self._begun or ended  # a result that was held is an attempt as well
        # Writing takes its time, in which the job is still seen as it was.
        record = self._record(state)
        self.keep(replace(record, finished_s=finished_s, statistics=statistics, error=error))
        self.finished_s, self.statistics, self.error = finished_s, statistics, error
        if state is not JobState.RUNNING:
            self._control = None
        if state is JobState.QUEUED:
            self.stage_fraction = 0.0
        self.state = state  # last: who sees a state sees what belongs to it
        self.revision += 1
        if ended:
            self.revision = (self.starts + 1) * REVISIONS_OF_A_START
            self.finished.set_result(None)

    def _record(self, state: JobState) -> JobRecord:
        return JobRecord(
            self.id,
            self.request,
            state,
            self.attempts if self._begun else self.attempts - 1,
            self._cancel_asked,
            self.stage_fraction,
            self.created_s,
            self.started_s,
            self.finished_s,
            self.statistics,
            self.error,
            self.starts,
            self.interruptions,
            self.heartbeat_s,
        )


def _keep_nothing(record: JobRecord) -> None:
    """Until it is accepted, a job is nobody's business."""
