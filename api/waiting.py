"""Waiting for work: `Prefer: wait=N`, and clients that go away."""

import asyncio
import time
from collections.abc import Callable
from typing import Final, TypeVar

from fastapi import Request

from api.context import Context
from api.negotiation import wait_seconds
from raysvc.jobs import Job, JobState
from raysvc.jobs import Request as JobRequest
from raysvc.parallel import Control

Result = TypeVar("Result")

LISTENING_S: Final = 0.25
"""How often a waiting request looks whether its client is still there."""


async def answer_to_new(
    job: Job[JobRequest], location: str, request: Request, context: Context
) -> tuple[int, dict[str, str]]:
    """Status and headers of the answer to a new job: 200 if it finished while the client waited.

    A client waits as long as it asks for by `Prefer: wait=N`, and no longer than is granted.
    """
    headers = {"Location": location}
    request.state.job_id = job.id  # for the log
    wanted_s = wait_seconds(request.headers.getlist("prefer"))
    if wanted_s is None:
        return 202, headers
    granted_s = min(wanted_s, context.settings.wait_max_s)
    if not await wait_for(job, granted_s, request, context):
        return 202, headers
    return 200, headers | {"Preference-Applied": f"wait={granted_s:.0f}"}


async def wait_for(
    job: Job[JobRequest], seconds: float, request: Request, context: Context
) -> bool:
    """Wait until a job has finished.

    False when the time is over, the client has gone away, or the job is left to the next process.
    """
    finished = asyncio.wrap_future(job.finished)
    end = time.monotonic() + seconds
    while not finished.done():
        left = end - time.monotonic()
        if left <= 0 or await request.is_disconnected():
            return False
        if context.service.draining and job.state is JobState.QUEUED:
            return False
        await asyncio.wait({finished}, timeout=min(left, LISTENING_S))
    return True


async def for_client(
    work: Callable[[], Result], control: Control, request: Request, context: Context
) -> Result:
    """Return what `work` makes on one of the context's threads, and meanwhile listen.

    A client that goes away cancels `control`, by which the work stops. Raises QueueFull.
    """

    async def listen() -> None:
        while not await request.is_disconnected():
            await asyncio.sleep(LISTENING_S)
        control.cancel()

    listening = asyncio.create_task(listen())
    try:
        return await context.long(work)
    finally:
        listening.cancel()
