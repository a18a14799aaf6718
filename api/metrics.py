"""What is measured of the service while it runs; `/metrics` shows it."""

from collections.abc import Callable
from typing import Any, Final

from api.exposition import Counter, Family, Histogram, Labels, Read, text_of
from raysvc.jobs import Job, JobState, Observer, RenderRequest, RenderService
from raysvc.version import VERSION

SECONDS: Final = (0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0)
"""Two buckets to a power of ten: a stage takes from a millisecond to minutes."""


class Metrics(Observer):
    """Hears of jobs, requests and refusals, and counts them."""

    def __init__(self) -> None:
        self.requests = Counter(
            "raysvc_http_requests_total",
            "HTTP requests that were answered.",
            ("method", "route", "status"),
        )
        self.request_seconds = Histogram(
            "raysvc_http_request_seconds",
            "From a request to the end of its answer.",
            SECONDS,
            ("method", "route"),
        )
        self.rejections = Counter(
            "raysvc_rejections_total", "Requests answered with a problem, by its type.", ("reason",)
        )
        self.jobs = Counter("raysvc_jobs_total", "Jobs that ended.", ("kind", "state"))
        self.served = Counter(
            "raysvc_jobs_served_total", "Jobs whose result was held, so that none ran.", ("kind",)
        )
        self.wait_seconds = Histogram(
            "raysvc_queue_wait_seconds", "How long jobs waited before they ran.", SECONDS, ("kind",)
        )
        self.job_seconds = Histogram("raysvc_job_seconds", "How long jobs ran.", SECONDS, ("kind",))
        self.stage_seconds = Histogram(
            "raysvc_stage_seconds", "How long stages of renders took.", SECONDS, ("stage",)
        )
        self.rays = Counter("raysvc_rays_total", "Rays of renders.", ("kind",))
        self._last_rays_per_second = 0.0

    def accepted(self, job: Job[Any]) -> None:
        """A job whose result was held never waits."""
        if job.state is JobState.DONE and job.started_s is None:
            self.served.add(job.request.kind)

    def ended(self, job: Job[Any]) -> None:
        """Count a job, and what its statistics say."""
        kind = job.request.kind
        self.jobs.add(kind, str(job.state))
        if job.started_s is None or job.finished_s is None:
            return
        self.wait_seconds.observe(max(job.started_s - job.created_s, 0.0), kind)
        self.job_seconds.observe(max(job.finished_s - job.started_s, 0.0), kind)
        if job.statistics is None or not isinstance(job.request, RenderRequest):
            return
        for stage in job.statistics.get("stages", ()):
            self.stage_seconds.observe(stage["seconds"], stage["name"])
        rays = job.statistics.get("rays", {})
        for name, count in rays.items():
            self.rays.add(name, amount=count)
        seconds = job.statistics.get("total_seconds", 0.0)
        if rays and seconds > 0:
            self._last_rays_per_second = sum(rays.values()) / seconds

    def text(self, service: RenderService) -> str:
        """Everything, as Prometheus reads it."""
        return text_of(
            [
                self.requests,
                self.request_seconds,
                self.rejections,
                self.jobs,
                self.served,
                self.wait_seconds,
                self.job_seconds,
                self.stage_seconds,
                self.rays,
                *self._read_from(service),
            ]
        )

    def _read_from(self, service: RenderService) -> list[Family]:
        """What the service knows itself."""

        def one(value: float) -> Callable[[], dict[Labels, float]]:
            return lambda: {(): value}

        def of_caches(part: str) -> Callable[[], dict[Labels, float]]:
            return lambda: {
                (name,): getattr(counts, part) for name, counts in service.caches.items()
            }

        cache = ("cache",)
        return [
            Read(
                "raysvc_rays_per_second",
                "Rays of the last render, of all kinds, by the seconds of all its stages.",
                one(self._last_rays_per_second),
            ),
            Read("raysvc_queue_jobs", "Jobs that wait.", one(service.waiting)),
            Read(
                "raysvc_ready",
                "1 while work is taken and the kernels are compiled.",
                one(service.not_ready is None),
            ),
            Read(
                "raysvc_cache_hits_total",
                "Things that were asked for and held in memory.",
                of_caches("hits"),
                cache,
                "counter",
            ),
            Read(
                "raysvc_cache_misses_total",
                "Things that were asked for and not held.",
                of_caches("misses"),
                cache,
                "counter",
            ),
            Read(
                "raysvc_cache_evictions_total",
                "Things that made room for others.",
                of_caches("evictions"),
                cache,
                "counter",
            ),
            Read("raysvc_cache_bytes", "What is held in memory.", of_caches("held_bytes"), cache),
            Read("raysvc_info", "1; which version this is.", lambda: {(VERSION,): 1}, ("version",)),
        ]
