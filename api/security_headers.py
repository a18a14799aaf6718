"""What browsers are told about every answer: guess no types, load nothing, frame nothing.

A chart (SVG) that somebody opens may style itself. Routes that show pages say themselves
what those may load.
"""

import base64
import hashlib
import re
from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

POLICY: Final = "Content-Security-Policy"
HEADERS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "X-Content-Type-Options": "nosniff",
        "X-Frame-Options": "DENY",
        "Referrer-Policy": "no-referrer",
        POLICY: "default-src 'none'; style-src 'unsafe-inline'; img-src data:; "
        "frame-ancestors 'none'",
    }
)
_INLINE: Final = re.compile(rb"<script>(.*?)</script>", re.DOTALL)


def policy_of_page(page: bytes) -> str:
    """What a page may load: its own origin's files, and the scripts that are written in it."""
    digests = [hashlib.sha256(script).digest() for script in _INLINE.findall(page)]
    scripts = " ".join(["'self'", *(f"'sha256-{base64.b64encode(d).decode()}'" for d in digests)])
    return (
        f"default-src 'self'; script-src {scripts}; style-src 'self' 'unsafe-inline'; "
        "img-src 'self' data: blob:; frame-ancestors 'none'"
    )


class SecurityHeaders:
    """Adds the headers to every answer that does not say otherwise."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on."""

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in HEADERS.items():
                    headers.setdefault(name, value)
            await send(message)

        await self._app(scope, receive, send_with_headers)
