"""Hearing how far a job is, and waiting for its end.

Where the service offers events (Server-Sent Events), each is a change that is told at once; where
it does not, or they are cut, the resource is asked for again and again.
"""

import json
import time
from collections.abc import Callable, Iterator
from typing import Any, Final

from raysvc.client.connection import Connection
from raysvc.client.resources import Job
from raysvc.errors import DeadlineExceeded, RaysvcError

OnProgress = Callable[[str, float], None]
"""Told the stage and how much of it is done, 0..1."""

FIRST_LOOK_S: Final = 0.02
SLOWEST_LOOK_S: Final = 0.5
"""Between two looks at a job that takes long."""


def follow(
    connection: Connection,
    path: str,
    job: Job,
    on_progress: OnProgress | None = None,
    timeout_s: float | None = None,
) -> Job:
    """Wait until a job has ended, however; returns it as it is then.

    `path` is that of its resource. Raises DeadlineExceeded after `timeout_s`; the job goes on.
    """
    end = None if timeout_s is None else time.monotonic() + timeout_s
    pause_s = FIRST_LOOK_S
    heard = "events" in job.resource["links"]
    while not job.ended:
        if end is not None and time.monotonic() > end:
            raise DeadlineExceeded(f"the job is still {job.state} after {timeout_s:g} s")
        if heard:
            heard = _listen(connection, f"{path}/events", on_progress, end)
        else:
            time.sleep(pause_s)
            pause_s = min(1.5 * pause_s, SLOWEST_LOOK_S)
        job = Job.of(connection.send("GET", path).json())
        _tell(on_progress, job.resource)
    return job


def events_in(lines: Iterator[str]) -> Iterator[dict[str, Any]]:
    """The objects that a stream of events carries (HTML standard, section 9.2).

    An event that is not whole when the stream ends is none.
    """
    data: list[str] = []
    for line in lines:
        field, _, value = line.partition(":")
        if field == "data":
            data.append(value.removeprefix(" "))
        elif not line and data:
            told = json.loads("\n".join(data))
            data = []
            if isinstance(told, dict):
                yield told


def _listen(
    connection: Connection, path: str, on_progress: OnProgress | None, end: float | None
) -> bool:
    """Tell what events say until they end; False if there had better be no more listening."""
    told = False
    try:
        with connection.lines(path) as lines:
            for resource in events_in(lines):
                told = True
                _tell(on_progress, resource)
                if end is not None and time.monotonic() > end:
                    break
    except (RaysvcError, ValueError):
        return False
    return told


def _tell(on_progress: OnProgress | None, resource: dict[str, Any] | Any) -> None:
    if on_progress is not None and "state" in resource:
        on_progress(resource.get("stage") or resource["state"], resource.get("progress") or 0.0)
