"""The thread that renders, one job at a time: the kernels below use all processors themselves."""

import logging
import threading
import time

from raysvc.errors import Cancelled, RaysvcError
from raysvc.jobs.model import Job
from raysvc.jobs.queue import JobQueue
from raysvc.jobs.renderer import Renderer
from raysvc.jobs.results import Results
from raysvc.parallel import Control

logger = logging.getLogger(__name__)


class Worker:
    """Warms the renderer up, then takes jobs until the queue is closed."""

    def __init__(
        self, queue: JobQueue, renderer: Renderer, results: Results, deadline_s: float | None
    ) -> None:
        self.warm = threading.Event()
        """Set once the first frame would not have to wait for the compiler."""
        self._queue = queue
        self._renderer = renderer
        self._results = results
        self._deadline_s = deadline_s
        self._thread = threading.Thread(target=self._run, name="raysvc-worker", daemon=True)

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def join(self, timeout_s: float) -> bool:
        """Wait for the thread to end after the queue was closed; False if it is still busy."""
        if self._thread.ident is not None:
            self._thread.join(timeout_s)
        return not self._thread.is_alive()

    def _run(self) -> None:
        try:
            self._renderer.warm_up()
            self.warm.set()
        except Exception:
            logger.exception("the renderer could not be warmed up; this service will not get ready")
        while (job := self._queue.take()) is not None:
            self._render(job)

    def _render(self, job: Job) -> None:
        settings = job.request.settings
        deadline_s = settings.deadline_s or self._deadline_s
        control = Control(settings.threads, deadline_s, job.report)
        if not job.start(control):
            return
        began = time.monotonic()
        try:
            picture = self._renderer.render(job.request, control)
            statistics = picture.statistics.to_dict()
            self._results.put(job.request.name, picture)
        except Cancelled:
            job.stop()
        except RaysvcError as error:
            job.fail(error)
        except MemoryError:
            job.fail(RaysvcError("there was not enough memory"))
        except Exception:
            logger.exception("render %s failed", job.id)
            job.fail(RaysvcError("an internal error; the service's log says more"))
        else:
            job.finish(statistics)
        self._queue.took(time.monotonic() - began)
