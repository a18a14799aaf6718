"""What is measured of the service while it runs; `/metrics` shows it."""

from collections.abc import Iterator
from typing import Any, Final

from prometheus_client import (
    CollectorRegistry,
    Counter,
    Gauge,
    Histogram,
    Info,
    Metric,
    disable_created_metrics,
    generate_latest,
)
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily

from raysvc.jobs import Job, JobState, Observer, RenderRequest, RenderService
from raysvc.version import VERSION

SECONDS: Final = (0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0)
"""Two buckets to a power of ten: a stage takes from a millisecond to minutes."""


class Metrics(Observer):
    """Hears of jobs, requests and refusals, and counts them; safe to use from many threads.

    Has a registry of its own, so that two applications in one process do not count together.
    """

    def __init__(self) -> None:
        # Another gauge beside every sample, which nobody asked for. The library can only be told so
        # for the whole process.
        disable_created_metrics()  # type: ignore[no-untyped-call]
        self._registry = registry = CollectorRegistry()
        self.requests = Counter(
            "raysvc_http_requests_total",
            "HTTP requests that were answered.",
            ("method", "route", "status"),
            registry=registry,
        )
        self.request_seconds = Histogram(
            "raysvc_http_request_seconds",
            "From a request to the end of its answer.",
            ("method", "route"),
            buckets=SECONDS,
            registry=registry,
        )
        self.rejections = Counter(
            "raysvc_rejections_total",
            "Requests answered with a problem, by its type.",
            ("reason",),
            registry=registry,
        )
        self.jobs = Counter(
            "raysvc_jobs_total", "Jobs that ended.", ("kind", "state"), registry=registry
        )
        self.served = Counter(
            "raysvc_jobs_served_total",
            "Jobs whose result was held, so that none ran.",
            ("kind",),
            registry=registry,
        )
        self.wait_seconds = Histogram(
            "raysvc_queue_wait_seconds",
            "How long jobs waited before they ran.",
            ("kind",),
            buckets=SECONDS,
            registry=registry,
        )
        self.job_seconds = Histogram(
            "raysvc_job_seconds",
            "How long jobs ran.",
            ("kind",),
            buckets=SECONDS,
            registry=registry,
        )
        self.stage_seconds = Histogram(
            "raysvc_stage_seconds",
            "How long stages of renders took.",
            ("stage",),
            buckets=SECONDS,
            registry=registry,
        )
        self.rays = Counter("raysvc_rays_total", "Rays of renders.", ("kind",), registry=registry)
        self.rays_per_second = Gauge(
            "raysvc_rays_per_second",
            "Rays of the last render, of all kinds, by the seconds of all its stages.",
            registry=registry,
        )
        version = Info("raysvc", "1; which version this is.", registry=registry)
        version.info({"version": VERSION})

    def accepted(self, job: Job[Any]) -> None:
        """A job whose result was held never waits."""
        if job.state is JobState.DONE and job.started_s is None:
            self.served.labels(job.request.kind).inc()

    def ended(self, job: Job[Any]) -> None:
        """Count a job, and what its statistics say."""
        kind = job.request.kind
        self.jobs.labels(kind, str(job.state)).inc()
        if job.started_s is None or job.finished_s is None:
            return
        self.wait_seconds.labels(kind).observe(max(job.started_s - job.created_s, 0.0))
        self.job_seconds.labels(kind).observe(max(job.finished_s - job.started_s, 0.0))
        if job.statistics is None or not isinstance(job.request, RenderRequest):
            return
        for stage in job.statistics.get("stages", ()):
            self.stage_seconds.labels(stage["name"]).observe(stage["seconds"])
        rays = job.statistics.get("rays", {})
        for name, count in rays.items():
            self.rays.labels(name).inc(count)
        seconds = job.statistics.get("total_seconds", 0.0)
        if rays and seconds > 0:
            self.rays_per_second.set(sum(rays.values()) / seconds)

    def read_from(self, service: RenderService) -> None:
        """Show also what a service knows itself, as it is whenever Prometheus asks."""
        self._registry.register(_Known(service))

    def text(self) -> bytes:
        """Everything, in Prometheus's text format 0.0.4."""
        return generate_latest(self._registry)


class _Known:
    """What a service counts and holds itself."""

    def __init__(self, service: RenderService) -> None:
        self._service = service

    def collect(self) -> Iterator[Metric]:
        """Ask the service."""
        service = self._service
        yield GaugeMetricFamily("raysvc_queue_jobs", "Jobs that wait.", service.waiting)
        yield GaugeMetricFamily(
            "raysvc_ready",
            "1 while work is taken and the kernels are compiled.",
            service.not_ready is None,
        )
        cache, folder = ("cache",), ("folder",)
        hits = CounterMetricFamily(
            "raysvc_cache_hits_total",
            "Things that were asked for and held in memory.",
            labels=cache,
        )
        misses = CounterMetricFamily(
            "raysvc_cache_misses_total", "Things that were asked for and not held.", labels=cache
        )
        evictions = CounterMetricFamily(
            "raysvc_cache_evictions_total",
            "Things that made room for others in memory.",
            labels=cache,
        )
        held = GaugeMetricFamily("raysvc_cache_bytes", "What is held in memory.", labels=cache)
        for name, counts in service.caches.items():
            hits.add_metric((name,), counts.hits)
            misses.add_metric((name,), counts.misses)
            evictions.add_metric((name,), counts.evictions)
            held.add_metric((name,), counts.held_bytes)
        yield from (hits, misses, evictions, held)
        evictions = CounterMetricFamily(
            "raysvc_disk_evictions_total",
            "Things that made room for others on the disk.",
            labels=folder,
        )
        held = GaugeMetricFamily("raysvc_disk_bytes", "What is held on the disk.", labels=folder)
        for name, kept in service.folders.items():
            evictions.add_metric((name,), kept.evictions)
            held.add_metric((name,), kept.held_bytes)
        yield from (evictions, held)
