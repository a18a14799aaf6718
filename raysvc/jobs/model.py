"""A job: what was asked for, and how far it is."""

import hashlib
import json
import threading
import time
from collections.abc import Mapping
from concurrent.futures import Future
from dataclasses import dataclass
from enum import StrEnum
from types import MappingProxyType
from typing import Any, Final

from raysvc.errors import RaysvcError
from raysvc.frame.settings import Settings
from raysvc.frame.view import View
from raysvc.parallel import Control
from raysvc.version import VERSION


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
"""What may follow what; a queued job is done at once when its picture is already held."""


@dataclass(frozen=True, slots=True)
class RenderRequest:
    """Everything that a picture depends on. Scene and environment are names in their stores."""

    scene: str
    environment: str | None
    """None is the built-in sky."""
    camera: View
    settings: Settings

    @property
    def name(self) -> str:
        """SHA-256 in hex of what decides the picture: not of threads, nor of patience."""
        decisive = {
            "version": VERSION,
            "scene": self.scene,
            "environment": self.environment,
            "camera": self.camera.model_dump(mode="json"),
            "settings": self.settings.model_dump(mode="json", exclude={"threads", "deadline_s"}),
        }
        return hashlib.sha256(json.dumps(decisive, sort_keys=True).encode()).hexdigest()


class Job:
    """One request on its way to a picture. Any thread may look; changes go through the methods."""

    def __init__(self, id: str, request: RenderRequest) -> None:
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
        """The picture is there."""
        with self._lock:
            self.statistics = statistics
            self._move(JobState.DONE)

    def fail(self, error: RaysvcError) -> None:
        """There will be no picture, and why."""
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
