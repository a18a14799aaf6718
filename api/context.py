"""What every route may use."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Annotated, TypeVar

import anyio
import anyio.to_thread
from fastapi import Depends, Request

from api.metrics import Metrics
from api.settings import ApiSettings
from raysvc.jobs import RenderService

Result = TypeVar("Result")


@dataclass(frozen=True, slots=True)
class Context:
    """The service, how it was set up, and the few threads that decode and encode."""

    settings: ApiSettings
    service: RenderService
    limiter: anyio.CapacityLimiter
    metrics: Metrics

    readers: anyio.CapacityLimiter = field(kw_only=True)
    """Threads for uploads: one that is slow to read keeps others waiting, and nobody else."""

    async def reading(self, work: Callable[[], Result]) -> Result:
        """Run what reads an upload on one of the few threads for that."""
        return await anyio.to_thread.run_sync(work, limiter=self.readers)

    async def heavy(self, work: Callable[[], Result]) -> Result:
        """Run on one of the few threads, so that the event loop and its other threads stay free."""
        return await anyio.to_thread.run_sync(work, limiter=self.limiter)


def _context(request: Request) -> Context:
    context: Context = request.app.state.context
    return context


ContextDep = Annotated[Context, Depends(_context)]
