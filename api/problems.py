"""What went wrong, as RFC 9457 problem details: one table, one shape.

{"type": "urn:raysvc:problem:invalid-scene", "title": "...", "status": 422, "detail": "...",
 "instance": "/v1/scenes", "field": "meshes[0].primitives[0].indices", "retryable": false,
 "request_id": "..."}
"""

import logging
import math
from collections.abc import Mapping
from dataclasses import dataclass
from http import HTTPStatus
from types import MappingProxyType
from typing import Any, Final

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from starlette.exceptions import HTTPException

from api.access import challenge
from api.context import Context
from api.request_ids import HEADER as REQUEST_ID
from api.responses import SafeJSONResponse
from api.security_headers import HEADERS
from raysvc import errors
from raysvc.jobs import room_needed

logger = logging.getLogger(__name__)

MEDIA_TYPE: Final = "application/problem+json"
TYPE_PREFIX: Final = "urn:raysvc:problem:"
LONGEST_DETAIL: Final = 500
RESTART_S: Final = 10
"""When to try again what may have gone wrong for as long as a restart or a tidying takes."""


class NotAcceptable(errors.RaysvcError):
    """No form of the answer is one that the client accepts."""


class MalformedBody(errors.InvalidInput):
    """The body is not JSON or not a form."""


class UnsupportedMediaType(errors.InvalidInput):
    """The body is of a kind that this resource does not take."""


@dataclass(frozen=True, slots=True)
class Problem:
    """How a kind of error is answered."""

    status: HTTPStatus
    type: str
    title: str


PROBLEMS: Final[Mapping[type[errors.RaysvcError], Problem]] = MappingProxyType(
    {
        MalformedBody: Problem(HTTPStatus.BAD_REQUEST, "malformed-body", "The body is malformed"),
        UnsupportedMediaType: Problem(
            HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "media-type", "The body is of the wrong kind"
        ),
        NotAcceptable: Problem(
            HTTPStatus.NOT_ACCEPTABLE, "not-acceptable", "No such form of the picture"
        ),
        errors.InvalidScene: Problem(
            HTTPStatus.UNPROCESSABLE_ENTITY, "invalid-scene", "The scene cannot be used"
        ),
        errors.InvalidEnvironment: Problem(
            HTTPStatus.UNPROCESSABLE_ENTITY, "invalid-environment", "The environment cannot be used"
        ),
        errors.InvalidSetting: Problem(
            HTTPStatus.UNPROCESSABLE_ENTITY, "invalid-setting", "A setting is wrong"
        ),
        errors.Unsupported: Problem(
            HTTPStatus.UNPROCESSABLE_ENTITY,
            "unsupported",
            "The scene requires something unsupported",
        ),
        errors.LimitExceeded: Problem(
            HTTPStatus.REQUEST_ENTITY_TOO_LARGE, "limit-exceeded", "Larger than the limit"
        ),
        errors.InvalidInput: Problem(
            HTTPStatus.UNPROCESSABLE_ENTITY, "invalid-input", "The request is wrong"
        ),
        errors.NotFound: Problem(HTTPStatus.NOT_FOUND, "not-found", "There is no such thing"),
        errors.NotFinished: Problem(HTTPStatus.CONFLICT, "not-finished", "There is no result yet"),
        errors.Gone: Problem(HTTPStatus.GONE, "gone", "The result is no longer kept"),
        errors.Unavailable: Problem(
            HTTPStatus.UNPROCESSABLE_ENTITY, "unavailable", "Not available on this machine"
        ),
        errors.NotAuthenticated: Problem(
            HTTPStatus.UNAUTHORIZED, "not-authenticated", "A key is needed"
        ),
        errors.NotAllowed: Problem(
            HTTPStatus.FORBIDDEN, "not-allowed", "The key does not reach that far"
        ),
        errors.ForeignPage: Problem(
            HTTPStatus.FORBIDDEN, "foreign-page", "Pages of this origin may not call the service"
        ),
        errors.QueueFull: Problem(HTTPStatus.TOO_MANY_REQUESTS, "queue-full", "The queue is full"),
        errors.Busy: Problem(HTTPStatus.TOO_MANY_REQUESTS, "busy", "Its turn did not come in time"),
        errors.InUse: Problem(HTTPStatus.CONFLICT, "in-use", "Jobs are going to need it"),
        errors.IdempotencyKeyReused: Problem(
            HTTPStatus.UNPROCESSABLE_ENTITY,
            "idempotency-key-reused",
            "The idempotency key stands for another request",
        ),
        errors.Draining: Problem(
            HTTPStatus.SERVICE_UNAVAILABLE, "draining", "The service is shutting down"
        ),
        errors.StorageFull: Problem(
            HTTPStatus.INSUFFICIENT_STORAGE, "storage-full", "The disk is full"
        ),
        errors.Crashed: Problem(
            HTTPStatus.INTERNAL_SERVER_ERROR, "crashed", "The job ended the process"
        ),
        errors.Cancelled: Problem(HTTPStatus.CONFLICT, "cancelled", "The job was cancelled"),
        errors.DeadlineExceeded: Problem(
            HTTPStatus.UNPROCESSABLE_ENTITY, "deadline-exceeded", "The job took too long"
        ),
        errors.RaysvcError: Problem(
            HTTPStatus.INTERNAL_SERVER_ERROR, "internal", "Something went wrong in the service"
        ),
    }
)
"""Looked up along an exception's classes, nearest first."""


def problem_of(error: errors.RaysvcError) -> Problem:
    """Return the table's entry for an error, or for the nearest of its ancestors."""
    return next(PROBLEMS[kind] for kind in type(error).__mro__ if kind in PROBLEMS)


def error_body(error: errors.RaysvcError) -> dict[str, Any]:
    """Describe an error without an occasion: the part of a problem that a failed job keeps."""
    problem = problem_of(error)
    return {
        "type": TYPE_PREFIX + problem.type,
        "title": problem.title,
        "status": int(problem.status),
        "detail": error.message[:LONGEST_DETAIL],
        "field": error.field,
        "retryable": error.retryable,
    }


def install(app: FastAPI) -> None:
    """Answer every error of the application as a problem."""
    app.add_exception_handler(errors.RaysvcError, _raysvc_error)
    app.add_exception_handler(OSError, _system_error)
    app.add_exception_handler(HTTPException, _http_exception)
    app.add_exception_handler(RequestValidationError, _validation_error)
    app.add_exception_handler(Exception, _unexpected)


def _answer(
    request: Request, body: dict[str, Any], headers: Mapping[str, str] | None = None
) -> SafeJSONResponse:
    context: Context | None = getattr(request.app.state, "context", None)
    if context is not None:
        context.metrics.rejections.labels(body["type"].removeprefix(TYPE_PREFIX)).inc()
    raw_path: bytes = request.scope.get("raw_path") or request.url.path.encode()
    body["instance"] = raw_path.decode("ascii", "replace")
    body["request_id"] = getattr(request.state, "request_id", None)
    # An unexpected error is answered outside of all middleware, which adds these otherwise.
    added = dict(HEADERS)
    if body["request_id"] is not None:
        added[REQUEST_ID] = body["request_id"]
    return SafeJSONResponse(body, body["status"], {**added, **(headers or {})}, MEDIA_TYPE)


async def _raysvc_error(request: Request, error: Exception) -> SafeJSONResponse:
    assert isinstance(error, errors.RaysvcError)
    headers = {}
    if isinstance(error, errors.QueueFull | errors.Busy):
        headers["Retry-After"] = str(math.ceil(error.retry_after_s))
    elif isinstance(error, errors.Draining | errors.StorageFull):
        headers["Retry-After"] = str(RESTART_S)
    elif isinstance(error, errors.NotAuthenticated | errors.NotAllowed):
        headers["WWW-Authenticate"] = challenge(error, "authorization" in request.headers)
    return _answer(request, error_body(error), headers)


async def _system_error(request: Request, error: Exception) -> SafeJSONResponse:
    assert isinstance(error, OSError)
    try:
        with room_needed("the request"):
            raise error
    except errors.StorageFull as full:
        return await _raysvc_error(request, full)
    except OSError:
        return await _unexpected(request, error)


async def _http_exception(request: Request, error: Exception) -> SafeJSONResponse:
    assert isinstance(error, HTTPException)
    status = HTTPStatus(error.status_code)
    body = {
        "type": TYPE_PREFIX + status.phrase.lower().replace(" ", "-"),
        "title": status.phrase,
        "status": int(status),
        "detail": str(error.detail)[:LONGEST_DETAIL],
        "field": None,
        "retryable": False,
    }
    return _answer(request, body, error.headers)


async def _validation_error(request: Request, error: Exception) -> SafeJSONResponse:
    assert isinstance(error, RequestValidationError)
    fault = error.errors()[0]
    # The first part says where the value was: query, path or header.
    field = ".".join(str(part) for part in fault["loc"][1:]) or None
    return _answer(request, error_body(errors.InvalidInput(str(fault["msg"]), field)))


async def _unexpected(request: Request, error: Exception) -> SafeJSONResponse:
    logger.error("%s %s failed", request.method, request.url.path, exc_info=error)
    return _answer(
        request, error_body(errors.RaysvcError("an internal error; the service's log says more"))
    )
