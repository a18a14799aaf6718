"""How far a job is, as Server-Sent Events.

Each event is the whole of what there is to say then, so that a client that was away misses nothing:
it sends the `Last-Event-ID` it has seen, as browsers do by themselves, and hears what is new. One
that has seen the end is answered 204, at which browsers stop asking.

    id: 1000042
    event: running
    data: {"id": "...", "state": "running", "stage": "light", "progress": 0.5, ...}
"""

import asyncio
import json
import time
from collections.abc import AsyncIterator, Callable
from typing import Any, Final

from fastapi import Request, Response
from starlette.responses import StreamingResponse

from api.context import Context
from api.schemas import job_fields
from raysvc.jobs import Job
from raysvc.jobs import Request as JobRequest

PACE_S: Final = 0.1
"""The shortest time between two events, and the longest until a change is heard of."""
SILENCE_S: Final = 15.0
"""After which a comment says that the connection is alive."""
RETRY_MS: Final = 1000
"""After which a client comes back when a connection was cut."""
MEDIA_TYPE: Final = "text/event-stream"
LAST_SEEN: Final = "Last-Event-ID"

EVENTS_RESPONSES: Final[dict[int | str, dict[str, Any]]] = {
    200: {"content": {MEDIA_TYPE: {}}, "description": "An event for each change, until the end"},
    204: {"description": "The client has seen the end"},
}
EVENTS_PARAMETERS: Final[dict[str, Any]] = {
    "parameters": [
        {
            "name": LAST_SEEN,
            "in": "header",
            "required": False,
            "description": "The `id` of the last event that was seen.",
            "schema": {"type": "string", "maxLength": 64},
        }
    ]
}


def events_response(
    job: Job[JobRequest], links: dict[str, str], request: Request, context: Context
) -> Response:
    """Answer with a job's events; `links` lead to its result, once it is there."""
    given = request.headers.get(LAST_SEEN, "")
    seen = int(given) if given.isascii() and given.isdecimal() and len(given) < 20 else None
    if job.finished.done() and seen == job.revision:
        return Response(status_code=204)

    def resource() -> dict[str, Any]:
        return job_fields(job, context.service.position(job), links)

    return StreamingResponse(
        _events(job, resource, seen, lambda: context.service.draining),
        media_type=MEDIA_TYPE,
        headers={"Cache-Control": "no-store", "X-Accel-Buffering": "no"},
    )


async def _events(
    job: Job[JobRequest],
    resource: Callable[[], dict[str, Any]],
    seen: int | None,
    draining: Callable[[], bool],
) -> AsyncIterator[bytes]:
    """Say what changes until the job has ended, or the service is about to."""
    finished = asyncio.wrap_future(job.finished)
    yield f"retry: {RETRY_MS}\n\n".encode()
    said = (seen, None)
    spoken_s = time.monotonic()
    while True:
        ended = finished.done()
        revision, known = job.revision, resource()
        if (revision, known["position"]) != said and not (said == (revision, None)):
            said, spoken_s = (revision, known["position"]), time.monotonic()
            data = json.dumps(known, allow_nan=False, separators=(",", ":"))
            yield f"id: {revision}\nevent: {known['state']}\ndata: {data}\n\n".encode()
        elif time.monotonic() - spoken_s > SILENCE_S:
            spoken_s = time.monotonic()
            yield b": still here\n\n"
        if ended or draining():
            return
        await asyncio.wait({finished}, timeout=PACE_S)
