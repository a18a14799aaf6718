"""The line in which jobs wait: bounded, and refusing at once when it is full."""

import threading
from collections import deque

from raysvc.errors import Draining, QueueFull
from raysvc.jobs.model import Job, JobState
from raysvc.jobs.requests import Request

SHORTEST_RETRY_S = 1.0
LONGEST_RETRY_S = 600.0


class JobQueue:
    """First come, first served. Safe to use from many threads.

    Parameters
    ----------
    size
        how many jobs may wait; the one that runs does not count
    """

    def __init__(self, size: int) -> None:
        self._size = size
        self._waiting: deque[Job[Request]] = deque()
        self._changed = threading.Condition()
        self._closed = False
        self._mean_seconds = SHORTEST_RETRY_S

    def __len__(self) -> int:
        with self._changed:
            self._forget_cancelled()
            return len(self._waiting)

    def check_room(self) -> None:
        """Raise QueueFull, which says when to try again, or Draining, where `put` would."""
        with self._changed:
            self._forget_cancelled()
            if self._closed:
                raise Draining("the service is shutting down")
            if len(self._waiting) >= self._size:
                raise QueueFull(
                    f"{len(self._waiting)} jobs are waiting already", self._retry_after_s()
                )

    def put(self, job: Job[Request]) -> None:
        """Join the line. Raises QueueFull, which says when to try again, and Draining."""
        with self._changed:
            self.check_room()
            self._waiting.append(job)
            self._changed.notify()

    def put_back(self, job: Job[Request]) -> None:
        """Join the line however long it is: the job was accepted before."""
        with self._changed:
            self._waiting.append(job)
            self._changed.notify()

    def take(self) -> Job[Request] | None:
        """Leave the line; waits until there is a job, and is None once the queue is closed."""
        with self._changed:
            while True:
                self._forget_cancelled()
                if self._waiting and not self._closed:
                    return self._waiting.popleft()
                if self._closed:
                    return None
                self._changed.wait()

    def position(self, job: Job[Request]) -> int | None:
        """How many jobs are before this one, or None if it is not waiting."""
        with self._changed:
            self._forget_cancelled()
            return self._waiting.index(job) if job in self._waiting else None

    def took(self, seconds: float) -> None:
        """Learn how long a job ran, for the advice that goes with QueueFull."""
        with self._changed:
            self._mean_seconds += 0.3 * (seconds - self._mean_seconds)

    def close(self) -> None:
        """Let nobody in or out any more; who waits stays in the line."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()

    def _forget_cancelled(self) -> None:
        self._waiting = deque(job for job in self._waiting if job.state is JobState.QUEUED)

    @property
    def retry_after_s(self) -> float:
        """How long those that wait may take, going by those before."""
        with self._changed:
            self._forget_cancelled()
            return self._retry_after_s()

    def _retry_after_s(self) -> float:
        expected = self._mean_seconds * len(self._waiting)
        return min(max(expected, SHORTEST_RETRY_S), LONGEST_RETRY_S)
