"""From RFC 9457 problems to the exceptions that the service raised."""

import re
from collections.abc import Mapping
from typing import Any, Final

import httpx

from raysvc.errors import (
    Busy,
    InvalidInput,
    NotAllowed,
    NotFinished,
    QueueFull,
    RaysvcError,
    Unreachable,
)

TYPE_PREFIX: Final = "urn:raysvc:problem:"
DEFAULT_RETRY_S: Final = 1.0
_SCOPE: Final = re.compile(r'scope="(\w+)"')


def problem_name(kind: type[RaysvcError]) -> str:
    """What a problem of a kind is called: `InvalidScene` is `invalid-scene`."""
    return re.sub(r"(?<!^)(?=[A-Z])", "-", kind.__name__).lower()


def error_kinds() -> dict[str, type[RaysvcError]]:
    """Every kind of error by the name of its problem."""
    kinds: list[type[RaysvcError]] = [RaysvcError]
    for kind in kinds:
        kinds += [
            each for each in kind.__subclasses__() if each.__module__ == RaysvcError.__module__
        ]
    return {problem_name(kind): kind for kind in kinds}


def error_from(problem: Mapping[str, Any], headers: Mapping[str, str] | None = None) -> RaysvcError:
    """The exception that a problem tells of; `headers` are those of its answer, if it had one.

    A problem that this version does not know is an InvalidInput if the service blames the client,
    and a RaysvcError otherwise.
    """
    headers = headers or {}
    field = problem.get("field")
    message = str(problem.get("detail") or problem.get("title") or "no reason was given")
    kind = error_kinds().get(str(problem.get("type", "")).removeprefix(TYPE_PREFIX))
    if kind is None:
        blamed = 400 <= int(problem.get("status") or 500) < 500
        kind = InvalidInput if blamed else RaysvcError
    if kind in (QueueFull, Busy):
        return kind(message, retry_after_s(headers) or DEFAULT_RETRY_S)
    if kind is NotFinished:
        return NotFinished(message, field, retryable=bool(problem.get("retryable")))
    if kind is NotAllowed:
        found = _SCOPE.search(headers.get("www-authenticate", ""))
        return NotAllowed(message, field, scope=found.group(1) if found else None)
    return kind(message, field)


def error_of(response: httpx.Response) -> RaysvcError:
    """The exception that a refused request raises."""
    try:
        problem = response.json()
    except ValueError:
        problem = None
    if isinstance(problem, dict) and "title" in problem:
        return error_from(problem, response.headers)
    return Unreachable(f"{response.url} answers {response.status_code} and is no raysvc")


def retry_after_s(headers: Mapping[str, str]) -> float | None:
    """Seconds of `Retry-After`, or None; dates are not understood, since raysvc sends none."""
    text = headers.get("retry-after", "")
    return float(text) if text.isascii() and text.isdecimal() and len(text) < 8 else None
