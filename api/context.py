"""What every route may use."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Annotated, Final, TypeVar

import anyio
import anyio.to_thread
from fastapi import Depends, Request

from api.metrics import Metrics
from api.settings import ApiSettings
from raysvc.errors import QueueFull
from raysvc.jobs import ComparisonRequest, Job, RenderRequest, RenderService

Result = TypeVar("Result")
Asked = TypeVar("Asked", RenderRequest, ComparisonRequest)

LONG_RETRY_S: Final = 5.0
"""When to come back where all threads for long work are taken."""


@dataclass(frozen=True, slots=True)
class Context:
    """The service, how it was set up, and the few threads that decode and encode."""

    settings: ApiSettings
    service: RenderService
    limiter: anyio.CapacityLimiter
    metrics: Metrics

    readers: anyio.CapacityLimiter = field(kw_only=True)
    """Threads for uploads: one that is slow to read keeps others waiting, and nobody else."""
    long_workers: anyio.CapacityLimiter = field(kw_only=True)
    """Who filters or refocuses, for as long as a job may run: one more is sent away."""

    async def reading(self, work: Callable[[], Result]) -> Result:
        """Run what reads an upload on one of the few threads for that."""
        return await anyio.to_thread.run_sync(work, limiter=self.readers)

    async def looked_up(self, id: str, kind: type[Asked]) -> tuple[Job[Asked], int | None]:
        """A job, and how many run before it. Raises NotFound.

        On a thread: the ledger is on the disk, and others may be writing to it.
        """

        def look() -> tuple[Job[Asked], int | None]:
            job = self.service.job(id, kind)
            return job, self.service.position(job)

        return await anyio.to_thread.run_sync(look)

    async def heavy(self, work: Callable[[], Result]) -> Result:
        """Run on one of the few threads, so that the event loop and its other threads stay free."""
        return await anyio.to_thread.run_sync(work, limiter=self.limiter)

    async def long(self, work: Callable[[], Result]) -> Result:
        """Run what may take as long as a job, on a thread of its own. Raises QueueFull."""
        worker = object()
        try:
            self.long_workers.acquire_on_behalf_of_nowait(worker)
        except anyio.WouldBlock:
            many = f"{self.long_workers.total_tokens:g}"
            raise QueueFull(f"{many} requests of this kind are at work", LONG_RETRY_S) from None
        try:
            return await anyio.to_thread.run_sync(work, limiter=anyio.CapacityLimiter(1))
        finally:
            self.long_workers.release_on_behalf_of(worker)


def _context(request: Request) -> Context:
    context: Context = request.app.state.context
    return context


ContextDep = Annotated[Context, Depends(_context)]
