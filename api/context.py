"""What every route may use."""

from collections.abc import Callable
from dataclasses import dataclass
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

    async def heavy(self, work: Callable[[], Result]) -> Result:
        """Run on one of the few threads, so that the event loop and its other threads stay free."""
        return await anyio.to_thread.run_sync(work, limiter=self.limiter)


def _context(request: Request) -> Context:
    context: Context = request.app.state.context
    return context


ContextDep = Annotated[Context, Depends(_context)]
