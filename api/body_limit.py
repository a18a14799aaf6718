"""No body is read beyond its limit, whether its length was announced or not.

Starlette has such a middleware too, but it answers in plain text.
"""

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from raysvc.errors import LimitExceeded


class BodyLimit:
    """Raises LimitExceeded into whoever reads more than `max_bytes` of a request's body."""

    def __init__(self, app: ASGIApp, max_bytes: int) -> None:
        self._app = app
        self._max_bytes = max_bytes

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, counting."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        announced = Headers(scope=scope).get("content-length", "")
        total = int(announced) if announced.isdecimal() else 0
        counted = 0

        async def receive_within_limit() -> Message:
            nonlocal counted
            self._check(total)
            message = await receive()
            counted += len(message.get("body", b""))
            self._check(counted)
            return message

        await self._app(scope, receive_within_limit, send)

    def _check(self, size: int) -> None:
        if size > self._max_bytes:
            raise LimitExceeded(f"the body is larger than {self._max_bytes:,} bytes", field="body")
