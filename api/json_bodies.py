"""Strict JSON: no NaN, no infinity, no key twice, no lone surrogate, bounded in size and depth."""

import json
import math
from collections.abc import Mapping
from typing import Any, Final

from fastapi import Request

from api.problems import MalformedBody, UnsupportedMediaType
from raysvc.errors import LimitExceeded

MAX_DEPTH: Final = 32
LONGEST_NUMBER: Final = 1_000


async def read_json_object(request: Request, max_bytes: int) -> dict[str, Any]:
    """Read a request's body. Raises MalformedBody, UnsupportedMediaType, LimitExceeded."""
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if kind != "application/json" and not (kind.startswith("application/") and "+json" in kind):
        raise UnsupportedMediaType("send application/json", field="Content-Type")
    body = bytearray()
    async for chunk in request.stream():
        body += chunk
        if len(body) > max_bytes:
            raise LimitExceeded(f"the body is larger than {max_bytes:,} bytes", field="body")
    return parse_object(bytes(body), "body")


def parse_object(text: bytes | str, name: str) -> dict[str, Any]:
    """Parse a JSON object; `name` is what an error calls the whole of it."""
    try:
        value = json.loads(text, object_pairs_hook=_object, parse_int=_integer)
    except MalformedBody as error:
        raise MalformedBody(error.message, field=name) from None
    except RecursionError:
        raise MalformedBody("is nested too deeply", field=name) from None
    except UnicodeDecodeError:
        raise MalformedBody("is not UTF-8", field=name) from None
    except ValueError as error:
        raise MalformedBody(f"is not JSON: {error}", field=name) from None
    if not isinstance(value, dict):
        raise MalformedBody("must be a JSON object", field=name)
    _check(value, name)
    return value


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    values: dict[str, Any] = {}
    for key, value in pairs:
        if key in values:
            raise MalformedBody(f"has the key {key[:80]!r} twice")
        values[key] = value
    return values


def _integer(digits: str) -> int:
    if len(digits) > LONGEST_NUMBER:
        raise MalformedBody("has a number of absurd length")
    return int(digits)


def _check(root: Mapping[str, Any], name: str) -> None:
    """Walk everything, without recursion, and name the first fault by its path."""
    open_values: list[tuple[Any, str, int]] = [(root, "" if name == "body" else name, 1)]
    while open_values:
        value, path, depth = open_values.pop()
        if depth > MAX_DEPTH:
            raise MalformedBody(f"is nested deeper than {MAX_DEPTH}", field=name)
        if isinstance(value, dict):
            for key, item in value.items():
                check_text(key, name)
                open_values.append((item, f"{path}.{key}" if path else key, depth + 1))
        elif isinstance(value, list):
            open_values += [(item, f"{path}.{i}", depth + 1) for i, item in enumerate(value)]
        elif isinstance(value, float) and not math.isfinite(value):
            raise MalformedBody("must be a finite number", field=path)
        elif isinstance(value, str):
            check_text(value, path)


def check_text(text: str, field: str) -> None:
    """Raise MalformedBody for what is no text, and could not be written as UTF-8."""
    if any("\ud800" <= character <= "\udfff" for character in text):
        raise MalformedBody("has half of a surrogate pair", field=field)
