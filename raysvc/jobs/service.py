"""Stores, queue, worker and results, wired together: the service without its protocol."""

import secrets
import threading
from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from raysvc.compare.result import Comparison
from raysvc.compare.settings import candidates, check_size
from raysvc.errors import Gone, NotFinished, NotFound
from raysvc.frame.probe import check_probe
from raysvc.frame.settings import check_cost
from raysvc.frame.view import camera_from
from raysvc.jobs.kinds import environment_kind, scene_kind
from raysvc.jobs.lru import Counts, LeastRecentlyUsed
from raysvc.jobs.model import Job, JobState
from raysvc.jobs.observer import Observer
from raysvc.jobs.queue import JobQueue
from raysvc.jobs.renderer import Picture, Renderer
from raysvc.jobs.requests import ComparisonRequest, RenderRequest, Request
from raysvc.jobs.results import Results
from raysvc.jobs.scene_comparer import SceneComparer, comparison_bytes
from raysvc.jobs.scene_store import SceneStore
from raysvc.jobs.store import ContentStore
from raysvc.jobs.worker import Worker
from raysvc.limits import DEFAULT_LIMITS, Limits
from raysvc.parallel import Control
from raysvc.scene import Environment, Scene

MakeRenderer = Callable[[ContentStore[Scene], ContentStore[Environment], Limits], Renderer]
"""From the stores and limits of a service."""

Asked = TypeVar("Asked", RenderRequest, ComparisonRequest)


@dataclass(frozen=True, slots=True)
class ServiceOptions:
    """What a service may use."""

    data_dir: Path
    """Where scenes and environments are kept; made if need be, owned by one process."""
    queue_size: int = 16
    """How many jobs may wait."""
    kept_jobs: int = 1_000
    """How many jobs are remembered."""
    deadline_s: float | None = 600.0
    """For jobs that do not set their own."""
    scene_memory_bytes: int = 1 << 30
    """Parsed scenes that are kept in memory."""
    environment_memory_bytes: int = 512 << 20
    """Parsed environments that are kept in memory."""
    result_memory_bytes: int = 512 << 20
    """Finished pictures that are kept in memory."""
    comparison_memory_bytes: int = 128 << 20
    """Finished comparisons, with their heat maps, that are kept in memory."""
    limits: Limits = DEFAULT_LIMITS


class RenderService:
    """Takes requests in, hands pictures and comparisons out; `close` when done."""

    def __init__(
        self,
        options: ServiceOptions,
        make_renderer: MakeRenderer,
        observer: Observer | None = None,
    ) -> None:
        self._observer = observer or Observer()
        self.limits = options.limits
        self.scenes = SceneStore(
            options.data_dir / "scenes", scene_kind(options.limits), options.scene_memory_bytes
        )
        self.environments = ContentStore(
            options.data_dir / "environments",
            environment_kind(options.limits),
            options.environment_memory_bytes,
        )
        self._results = Results(options.result_memory_bytes)
        self._queue = JobQueue(options.queue_size)
        self._comparisons: LeastRecentlyUsed[Comparison] = LeastRecentlyUsed(
            options.comparison_memory_bytes, comparison_bytes
        )
        self._renderer = make_renderer(self.scenes, self.environments, options.limits)
        self._comparer = SceneComparer(self.scenes, options.limits)
        self._worker = Worker(self._queue, self._fulfil, self._renderer.warm_up, options.deadline_s)
        self._kept_jobs = options.kept_jobs
        self._jobs: OrderedDict[str, Job[Any]] = OrderedDict()
        self._lock = threading.Lock()
        self._draining = False

    def start(self) -> None:
        """Begin to warm up and to render."""
        self._worker.start()

    @property
    def not_ready(self) -> str | None:
        """Why work had better go elsewhere, or None."""
        if self._draining:
            return "draining"
        return None if self._worker.warm.is_set() else "warming up"

    @property
    def waiting(self) -> int:
        """How many jobs wait."""
        return len(self._queue)

    @property
    def caches(self) -> Mapping[str, Counts]:
        """What is held in memory, and how often it was there when it was asked for."""
        return {
            "scenes": self.scenes.counts,
            "environments": self.environments.counts,
            "results": self._results.counts,
            "comparisons": self._comparisons.counts,
        }

    def submit(self, request: RenderRequest) -> Job[RenderRequest]:
        """Accept a render after checking it against its scene; one that is held is done at once.

        Raises InvalidInput, NotFound, QueueFull.
        """
        scene = self.scenes.get(request.scene)
        check_cost(request.settings, camera_from(request.camera, scene, self.limits), self.limits)
        if request.probe is not None:
            check_probe(request.probe, request.settings, scene)
        if request.environment is not None:
            self.environments.record(request.environment)
        job = Job(secrets.token_hex(16), request)
        held = self._results.get(request.name)
        if held is not None:
            job.finish(held.statistics.to_dict())
        else:
            self._queue.put(job)
        self._remember(job)
        return job

    def submit_comparison(self, request: ComparisonRequest) -> Job[ComparisonRequest]:
        """Accept a comparison after checking it against its scene.

        Raises InvalidInput, Unavailable, NotFound, QueueFull.
        """
        scene = self.scenes.get(request.scene)
        camera_from(request.settings.camera, scene, self.limits)
        candidates(request.settings)
        check_size(request.settings, len(scene.triangles), self.limits)
        job = Job(secrets.token_hex(16), request)
        self._queue.put(job)
        self._remember(job)
        return job

    def job(self, id: str, kind: type[Asked]) -> Job[Asked]:
        """Return a job that was asked for with such a request. Raises NotFound."""
        with self._lock:
            job = self._jobs.get(id)
        if job is None or not isinstance(job.request, kind):
            raise NotFound(f"no {kind.kind} {id[:64]!r}", field=kind.kind)
        return job

    def position(self, job: Job[Request]) -> int | None:
        """How many jobs will run before this one, or None if it does not wait."""
        return self._queue.position(job)

    def picture(self, job: Job[RenderRequest]) -> Picture:
        """Return a finished job's picture. Raises NotFinished, Gone, or what made the job fail."""
        _check_done(job)
        picture = self._results.get(job.request.name)
        if picture is None:
            raise Gone("the picture made room for newer ones; ask for the render again", "render")
        return picture

    def comparison(self, job: Job[ComparisonRequest]) -> Comparison:
        """Return a finished job's figures. Raises NotFinished, Gone, or what made the job fail."""
        _check_done(job)
        comparison = self._comparisons.get(job.request.name)
        if comparison is None:
            raise Gone("it made room for newer ones; ask for the comparison again", "comparison")
        return comparison

    def drain(self) -> None:
        """Take no more work; what waits is cancelled, what runs goes on."""
        self._draining = True
        for job in self._queue.close():
            job.cancel()

    def close(self, grace_s: float) -> None:
        """Drain, give the running job some time, then cancel it."""
        self.drain()
        if not self._worker.join(grace_s):
            with self._lock:
                unfinished = [job for job in self._jobs.values() if not job.finished.done()]
            for job in unfinished:
                job.cancel()
            self._worker.join(grace_s)

    def _fulfil(self, request: Request, control: Control) -> Mapping[str, Any]:
        """Make a picture or a comparison, and keep it."""
        if isinstance(request, ComparisonRequest):
            comparison = self._comparer.compare(request, control)
            self._comparisons.put(request.name, comparison)
            return comparison.to_dict()
        assert isinstance(request, RenderRequest)
        picture = self._renderer.render(request, control)
        statistics = picture.statistics.to_dict()
        self._results.put(request.name, picture)
        return statistics

    def _remember(self, job: Job[Any]) -> None:
        self._observer.accepted(job)
        job.finished.add_done_callback(lambda _: self._observer.ended(job))
        with self._lock:
            self._jobs[job.id] = job
            surplus = len(self._jobs) - self._kept_jobs
            finished = [id for id, known in self._jobs.items() if known.finished.done()]
            for id in finished[: max(surplus, 0)]:
                del self._jobs[id]


def _check_done(job: Job[Request]) -> None:
    """Raise NotFinished, or what made the job fail."""
    if job.error is not None:
        # Every raise adds frames to an exception, and frames hold on to what they work with.
        raise job.error.with_traceback(None)
    if job.state is not JobState.DONE:
        kind = job.request.kind
        waiting = job.state in (JobState.QUEUED, JobState.RUNNING)
        raise NotFinished(f"the {kind} is {job.state}", field=kind, retryable=waiting)
