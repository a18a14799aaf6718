"""The thread that does jobs, one at a time: the kernels below use all processors themselves, and
nothing disturbs a measurement."""

import logging
import threading
import time
from collections.abc import Callable, Mapping
from typing import Any, Final

from raysvc.errors import Cancelled, RaysvcError
from raysvc.jobs.model import Job
from raysvc.jobs.queue import JobQueue
from raysvc.jobs.requests import Request
from raysvc.parallel import Control

logger = logging.getLogger(__name__)

PATIENCE_S: Final = 30.0
"""How long after its deadline a job is thought to be on its way out."""

Fulfil = Callable[[Job[Request], Control], Mapping[str, Any]]
"""Does what a job is asked for, keeps the result, and returns what there is to say about it; calls
the job's `begin` once everything is at hand."""


class Worker:
    """Warms up, then takes jobs until the queue is closed."""

    def __init__(
        self,
        queue: JobQueue,
        fulfil: Fulfil,
        warm_up: Callable[[], None],
        deadline_s: float | None,
        beat: Callable[[Job[Request]], None] = lambda job: None,
    ) -> None:
        self.warm = threading.Event()
        """Set once the first frame would not have to wait for the compiler."""
        self._queue = queue
        self._fulfil = fulfil
        self._warm_up = warm_up
        self._deadline_s = deadline_s
        self._beat = beat
        self._overdue_s: float | None = None
        self._takes_jobs = threading.Event()
        """Set before the first job is taken."""
        self._thread = threading.Thread(target=self._run, name="raysvc-worker", daemon=True)

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def join(self, timeout_s: float) -> bool:
        """Wait for its job to end after the queue was closed; False if it is still busy.

        A warm-up is not waited for: it cannot be interrupted, and no job can follow it any more.
        """
        if not self._takes_jobs.is_set():
            return True
        if self._thread.ident is not None:
            self._thread.join(timeout_s)
        return not self._thread.is_alive()

    @property
    def stalled(self) -> bool:
        """Does a job still run long after its deadline, deaf to it?"""
        overdue_s = self._overdue_s
        return overdue_s is not None and time.monotonic() > overdue_s

    def _run(self) -> None:
        try:
            self._warm_up()
            self.warm.set()
        except Exception:
            logger.exception("warming up failed; this service will not get ready")
        self._takes_jobs.set()
        while (job := self._queue.take()) is not None:
            self._do(job)

    def _do(self, job: Job[Request]) -> None:
        request = job.request
        deadline_s = request.deadline_s or self._deadline_s

        def report(stage: str, fraction: float) -> None:
            job.report(stage, fraction)
            self._beat(job)

        control = Control(request.threads, deadline_s, report)
        if not job.start(control):
            return
        began = time.monotonic()
        self._overdue_s = None if deadline_s is None else began + deadline_s + PATIENCE_S
        try:
            job.finish(self._fulfil(job, control))
        except Cancelled:
            job.stop()
        except RaysvcError as error:
            job.fail(error)
        except MemoryError:
            job.fail(RaysvcError("there was not enough memory"))
        except Exception:
            logger.exception("%s %s failed", request.kind, job.id)
            job.fail(RaysvcError("an internal error; the service's log says more"))
        self._overdue_s = None
        self._queue.took(time.monotonic() - began)
