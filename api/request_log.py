"""Every request that was answered: a line in the log, and in the metrics."""

import logging
import time
from typing import Any, Final

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from api.metrics import Metrics

logger = logging.getLogger("raysvc.http")

METHODS: Final = frozenset({"GET", "HEAD", "POST", "PUT", "DELETE", "OPTIONS", "PATCH"})
QUIET: Final = frozenset({"/healthz", "/readyz", "/metrics"})
"""Routes that are asked every few seconds; that they answer, also with "not yet", is for debug."""


class RequestLog:
    """Measures from a request's arrival until its answer is sent."""

    def __init__(self, app: ASGIApp, metrics: Metrics) -> None:
        self._app = app
        self._metrics = metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        status = 500  # what whoever stands around us answers when nobody did

        async def send_and_see(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
            await send(message)

        began = time.perf_counter()
        try:
            await self._app(scope, receive, send_and_see)
        finally:
            self._note(scope, status, time.perf_counter() - began)

    def _note(self, scope: Scope, status: int, seconds: float) -> None:
        route = _route_of(scope)
        method = scope["method"] if scope["method"] in METHODS else "OTHER"
        self._metrics.requests.labels(method, route, str(status)).inc()
        self._metrics.request_seconds.labels(method, route).observe(seconds)
        level = logging.DEBUG if route in QUIET and status in (200, 503) else logging.INFO
        fields: dict[str, Any] = {
            "method": scope["method"],
            # As it came, percent signs and all: nothing in it can break a line.
            "path": scope.get("raw_path", b"").decode("ascii", "replace"),
            "status": status,
            "seconds": round(seconds, 4),
        }
        state = scope.get("state", {})
        fields |= {name: state[name] for name in ("job_id", "key_id") if name in state}
        logger.log(
            level,
            "%s %s %d",
            fields["method"],
            fields["path"],
            status,
            extra={"fields": fields},
        )


def _route_of(scope: Scope) -> str:
    """The template of a route, such as `/v1/renders/{id}`: there are few of them."""
    path = getattr(scope.get("route"), "path", None)
    if isinstance(path, str):
        return path
    return "/docs/assets" if scope["path"].startswith("/docs/assets/") else "unmatched"
