"""A job: what was asked for, and how far it is."""

import threading
import time
from collections.abc import Mapping
from concurrent.futures import Future
from enum import StrEnum
from types import MappingProxyType
from typing import Any, Final, Generic, TypeVar

from raysvc.errors import RaysvcError
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
        JobState.RUNNING: frozenset({JobState.DONE, JobState.FAILED, JobState.CANCELLED}),
        JobState.DONE: frozenset(),
        JobState.FAILED: frozenset(),
        JobState.CANCELLED: frozenset(),
    }
)
"""What may follow what; a queued job is done at once when its result is already held."""


Asked = TypeVar("Asked", bound=Request, covariant=True)


class Job(Generic[Asked]):
    """One request on its way to its result. Any thread may look; changes go through methods."""

    def __init__(self, id: str, request: Asked) -> None:
        self.id = id
        self.request = request
        self.state = JobState.QUEUED
        self.stage: str | None = None
        self.stage_fraction = 0.0
        self.created_s = time.time()
        self.started_s: float | None = None
        self.finished_s: float | None = None
        self.statistics: Mapping[str, Any] | None = None
        self.error: RaysvcError | None = None
        self.finished: Future[None] = Future()
        """Resolved when the job is done, failed or cancelled; its result is always None."""
        self._control: Control | None = None
        self._lock = threading.Lock()

    def start(self, control: Control) -> bool:
        """Begin to run, unless the job was cancelled while it waited."""
        with self._lock:
            if self.state is not JobState.QUEUED:
                return False
            self._control = control
            self.started_s = time.time()
            self._move(JobState.RUNNING)
            return True

    def report(self, stage: str, fraction: float) -> None:
        """Note which stage is running, and how much of it is done."""
        self.stage, self.stage_fraction = stage, fraction

    def finish(self, statistics: Mapping[str, Any]) -> None:
        """The result is there."""
        with self._lock:
            self.statistics = statistics
            self._move(JobState.DONE)

    def fail(self, error: RaysvcError) -> None:
        """There will be no result, and why."""
        with self._lock:
            self.error = error
            self._move(JobState.FAILED)

    def stop(self) -> None:
        """The running job heeded `cancel`."""
        with self._lock:
            self._move(JobState.CANCELLED)

    def cancel(self) -> None:
        """Ask for the job to end: at once while it waits, at its next check while it runs."""
        with self._lock:
            if self.state is JobState.QUEUED:
                self._move(JobState.CANCELLED)
            elif self._control is not None:
                self._control.cancel()

    def _move(self, state: JobState) -> None:
        if state not in TRANSITIONS[self.state]:
            raise AssertionError(f"a {self.state} job cannot become {state}")
        ended = not TRANSITIONS[state]
        if ended:
            self.finished_s = time.time()
            self._control = None
        self.state = state  # last: who sees a state sees what belongs to it
        if ended:
            self.finished.set_result(None)
