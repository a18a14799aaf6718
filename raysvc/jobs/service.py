"""Stores, queue, worker and results, wired together: the service without its protocol."""

import secrets
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, TypeVar

from raysvc.compare.result import Comparison
from raysvc.compare.settings import candidates, check_size
from raysvc.errors import Gone, NotFinished
from raysvc.frame.cost import check_estimate
from raysvc.frame.probe import check_probe
from raysvc.frame.settings import check_cost
from raysvc.frame.view import camera_from
from raysvc.jobs.disk_budget import DiskCounts
from raysvc.jobs.folder_lock import FolderLock
from raysvc.jobs.kinds import environment_kind, scene_kind
from raysvc.jobs.ledger import IdempotencyKey, Ledger
from raysvc.jobs.lru import Counts
from raysvc.jobs.model import Job, JobState
from raysvc.jobs.observer import Observer
from raysvc.jobs.queue import JobQueue
from raysvc.jobs.register import JobRegister
from raysvc.jobs.renderer import Picture, Renderer
from raysvc.jobs.requests import ComparisonRequest, RenderRequest, Request
from raysvc.jobs.result_folder import ResultFolder
from raysvc.jobs.results import Results
from raysvc.jobs.scene_comparer import SceneComparer
from raysvc.jobs.scene_store import SceneStore
from raysvc.jobs.store import ContentStore
from raysvc.jobs.worker import Worker
from raysvc.limits import DEFAULT_LIMITS, Limits
from raysvc.parallel import Control
from raysvc.parsing import DEFAULT_OPTIONS, Parser, ParserOptions
from raysvc.scene import Environment, Scene

MakeRenderer = Callable[[ContentStore[Scene], ContentStore[Environment], Limits], Renderer]
"""From the stores and limits of a service."""

Asked = TypeVar("Asked", RenderRequest, ComparisonRequest)

INTERRUPTION_S: Final = 5.0
"""What an interrupted job is given to notice, on top of the grace."""


@dataclass(frozen=True, slots=True)
class ServiceOptions:
    """What a service may use."""

    data_dir: Path
    """Where scenes, environments, jobs and results are kept; made if need be, owned by one
    process."""
    queue_size: int = 16
    """How many jobs may wait."""
    kept_jobs: int = 1_000
    """How many jobs are remembered."""
    idempotency_key_life_s: float = 86_400.0
    """How long an idempotency key stands for its job."""
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
    scene_disk_bytes: int = 8 << 30
    """Files of scenes; those that were not used longest make room."""
    environment_disk_bytes: int = 4 << 30
    """Files of environments."""
    result_disk_bytes: int = 4 << 30
    """Files of finished pictures and comparisons."""
    parsing: ParserOptions = DEFAULT_OPTIONS
    """The processes that read uploads."""
    limits: Limits = DEFAULT_LIMITS


class RenderService:
    """Takes requests in, hands pictures and comparisons out; `close` when done.

    What an earlier process has not finished is taken up again. Raises FolderInUse where another
    process has the folder.
    """

    def __init__(
        self,
        options: ServiceOptions,
        make_renderer: MakeRenderer,
        observer: Observer | None = None,
    ) -> None:
        self.limits = options.limits
        folder = options.data_dir
        self._lock = FolderLock(folder)
        self._queue = JobQueue(options.queue_size)
        self._ledger = Ledger(
            folder, secrets.token_hex(8), options.kept_jobs, options.idempotency_key_life_s
        )
        self._register = JobRegister(self._ledger, self._queue, observer or Observer())
        self._results = Results(
            ResultFolder(folder / "results", options.result_disk_bytes),
            options.result_memory_bytes,
            options.comparison_memory_bytes,
        )
        # Before the stores, which leave what unfinished jobs need when they make room.
        self._register.recover(self._held)
        self.parser = Parser(options.parsing, options.limits)
        self.scenes = SceneStore(
            folder / "scenes",
            scene_kind(self.parser),
            options.scene_memory_bytes,
            options.scene_disk_bytes,
            lambda: self._needed("scene"),
        )
        self.environments = ContentStore(
            folder / "environments",
            environment_kind(self.parser),
            options.environment_memory_bytes,
            options.environment_disk_bytes,
            lambda: self._needed("environment"),
        )
        self._renderer = make_renderer(self.scenes, self.environments, options.limits)
        self._comparer = SceneComparer(self.scenes, options.limits)
        self._worker = Worker(
            self._queue,
            self._fulfil,
            self._warm_up,
            options.deadline_s,
            self._register.beat,
        )
        self._drained_s: float | None = None
        """On the monotonic clock."""

    def start(self) -> None:
        """Begin to warm up and to render."""
        self._worker.start()

    @property
    def draining(self) -> bool:
        """Will what waits now wait for another process?"""
        return self._drained_s is not None

    @property
    def not_ready(self) -> str | None:
        """Why work had better go elsewhere, or None."""
        if self.draining:
            return "draining"
        if self._worker.stalled:
            return "stalled"
        return None if self._worker.warm.is_set() else "warming up"

    @property
    def waiting(self) -> int:
        """How many jobs wait."""
        return len(self._queue)

    @property
    def retry_after_s(self) -> float:
        """In how long the jobs that wait now may have run."""
        return self._queue.retry_after_s

    @property
    def caches(self) -> Mapping[str, Counts]:
        """What is held in memory, and how often it was there when it was asked for."""
        return {
            "scenes": self.scenes.counts,
            "environments": self.environments.counts,
            "results": self._results.picture_counts,
            "comparisons": self._results.comparison_counts,
        }

    @property
    def folders(self) -> Mapping[str, DiskCounts]:
        """What is held on the disk, and how often something made room there."""
        return {
            "scenes": self.scenes.disk_counts,
            "environments": self.environments.disk_counts,
            "results": self._results.disk_counts,
        }

    def submit(
        self, request: RenderRequest, key: IdempotencyKey | None = None
    ) -> Job[RenderRequest]:
        """Accept a render after checking it against its scene; one that is held is done at once.

        It is kept when this returns. A key that was sent before brings the job that it stands for.
        Raises InvalidInput, NotFound, QueueFull, Draining, StorageFull.
        """
        known = self.known(key, RenderRequest)
        if known is not None:
            return known
        self.scenes.record(request.scene)
        if request.environment is not None:
            self.environments.record(request.environment)
        job = Job(secrets.token_hex(16), request)
        held = self._results.picture(request)
        if held is not None:
            job.finish(held.statistics.to_dict())
        else:
            # First of all: a crowd that is turned away should not cost the reading of its scenes.
            self._queue.check_room()
            self._check(request)
        return self._register.accept(job, key)

    def submit_comparison(
        self, request: ComparisonRequest, key: IdempotencyKey | None = None
    ) -> Job[ComparisonRequest]:
        """Accept a comparison after checking it against its scene, as `submit` does a render.

        Raises InvalidInput, Unavailable, NotFound, QueueFull, Draining, StorageFull.
        """
        known = self.known(key, ComparisonRequest)
        if known is not None:
            return known
        self._queue.check_room()
        scene = self.scenes.get(request.scene)
        camera_from(request.settings.camera, scene, self.limits)
        candidates(request.settings)
        check_size(request.settings, len(scene.triangles), self.limits)
        return self._register.accept(Job(secrets.token_hex(16), request), key)

    def known(self, key: IdempotencyKey | None, kind: type[Asked]) -> Job[Asked] | None:
        """Return the job that a key stands for, or None; its scene may have gone since.

        Raises IdempotencyKeyReused.
        """
        return self._register.keyed(key, kind)

    def job(self, id: str, kind: type[Asked]) -> Job[Asked]:
        """Return a job that was asked for with such a request. Raises NotFound."""
        return self._register.find(id, kind)

    def position(self, job: Job[Request]) -> int | None:
        """How many jobs will run before this one, or None if it does not wait."""
        return self._queue.position(job)

    def picture(self, job: Job[RenderRequest]) -> Picture:
        """Return a finished job's picture. Raises NotFinished, Gone, or what made the job fail."""
        _check_done(job)
        picture = self._results.picture(job.request)
        if picture is None:
            raise Gone("the picture made room for newer ones; ask for the render again", "render")
        return picture

    def comparison(self, job: Job[ComparisonRequest]) -> Comparison:
        """Return a finished job's figures. Raises NotFinished, Gone, or what made the job fail."""
        _check_done(job)
        comparison = self._results.comparison(job.request)
        if comparison is None:
            raise Gone("it made room for newer ones; ask for the comparison again", "comparison")
        return comparison

    def drain(self) -> None:
        """Take no more work; what runs goes on, what waits is left to the next process."""
        if self._drained_s is None:
            self._drained_s = time.monotonic()
        self._queue.close()

    def close(self, grace_s: float) -> None:
        """Drain, give the running job some time, then interrupt it and let the folder go.

        The grace begins with the draining, which may have been earlier. Without a running job this
        returns at once, and during a warm-up too. A job that was interrupted is run again by the
        next process, from its beginning.
        """
        self.drain()
        assert self._drained_s is not None
        ended = self._worker.join(max(self._drained_s + grace_s - time.monotonic(), 0.0))
        if not ended:
            for job in self._register.unfinished():
                job.interrupt()
            ended = self._worker.join(INTERRUPTION_S)
        self.parser.close()
        if ended:
            self._register.close()
            self._ledger.close()
            self._lock.release()

    def _warm_up(self) -> None:
        """Get the kernels ready, and then the readers of uploads.

        Those import as much as this process did. At the same time they would make it wait for
        processors; an upload that comes before has its reader started at once.
        """
        try:
            self._renderer.warm_up()
        finally:
            if not self.draining:
                self.parser.start()

    def _check(self, request: RenderRequest) -> None:
        """Raise InvalidInput for what the scene cannot be asked for, or is too much."""
        scene = self.scenes.get(request.scene)
        camera = camera_from(request.camera, scene, self.limits)
        check_cost(request.settings, camera, self.limits)
        check_estimate(request.settings, camera, scene, self.limits)
        if request.probe is not None:
            check_probe(request.probe, request.settings, scene)

    def _needed(self, kind: str) -> set[str]:
        """Names of the scenes or environments that jobs are going to read."""
        requests = [job.request for job in self._register.unfinished()]
        return {name for request in requests if (name := getattr(request, kind, None)) is not None}

    def _held(self, request: Request) -> Mapping[str, Any] | None:
        """What there is to say about the result of a request, if it is kept."""
        if isinstance(request, ComparisonRequest):
            comparison = self._results.comparison(request)
            return None if comparison is None else comparison.to_dict()
        assert isinstance(request, RenderRequest)
        picture = self._results.picture(request) if self._results.has_picture(request) else None
        return None if picture is None else picture.statistics.to_dict()

    def _fulfil(self, job: Job[Request], control: Control) -> Mapping[str, Any]:
        """Make a picture or a comparison, and keep it."""
        request: Request = job.request
        assert isinstance(request, RenderRequest | ComparisonRequest)
        # Another job may have made it meanwhile, or a process that died before it could say so.
        held = self._held(request)
        if held is not None:
            return held
        # Before `begin`: an end of the process while files are read is not this job's fault.
        self.scenes.get(request.scene)
        if isinstance(request, ComparisonRequest):
            job.begin()
            comparison = self._comparer.compare(request, control)
            self._results.put_comparison(request, comparison)
            return comparison.to_dict()
        if request.environment is not None:
            self.environments.get(request.environment)
        job.begin()
        picture = self._renderer.render(request, control)
        statistics = picture.statistics.to_dict()
        self._results.put_picture(request, picture)
        return statistics


def _check_done(job: Job[Request]) -> None:
    """Raise NotFinished, or what made the job fail."""
    if job.error is not None:
        # Every raise adds frames to an exception, and frames hold on to what they work with.
        raise job.error.with_traceback(None)
    if job.state is not JobState.DONE:
        kind = job.request.kind
        waiting = job.state in (JobState.QUEUED, JobState.RUNNING)
        raise NotFinished(f"the {kind} is {job.state}", field=kind, retryable=waiting)
