"""Bodies that are one file, bounded while they are read."""

from collections.abc import Sequence

from fastapi import Request

from api.problems import UnsupportedMediaType
from raysvc.errors import LimitExceeded


async def read_binary(request: Request, max_bytes: int, media_types: Sequence[str]) -> bytearray:
    """Read a request's body; a client need not say what it is (as `curl -T` does not).

    Raises UnsupportedMediaType for another than one of the media types, the first of which is
    recommended, and LimitExceeded.
    """
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if kind and kind not in media_types:
        raise UnsupportedMediaType(f"send {media_types[0]}", field="Content-Type")
    announced = request.headers.get("content-length", "")
    if announced.isdecimal() and int(announced) > max_bytes:
        raise _too_large(max_bytes)
    body = bytearray()
    async for chunk in request.stream():
        body += chunk
        if len(body) > max_bytes:
            raise _too_large(max_bytes)
    return body


def _too_large(max_bytes: int) -> LimitExceeded:
    return LimitExceeded(f"the body is larger than {max_bytes:,} bytes", field="body")
