"""`Idempotency-Key`: a request that is sent again, since its answer was lost, does nothing again.

The same key with the same body brings the job of the first time, with another body a 422. Clients
with different API keys have nothing to do with each other's.
"""

import hashlib
import json
import re
from collections.abc import Mapping
from typing import Any, Final

from fastapi import Request

from raysvc.errors import InvalidInput
from raysvc.jobs import IdempotencyKey

HEADER: Final = "Idempotency-Key"
LONGEST_KEY: Final = 255

_KEY = re.compile(rf"[\x21-\x7e]{{1,{LONGEST_KEY}}}")


def key_of(request: Request, body: Mapping[str, Any]) -> IdempotencyKey | None:
    """Return the key that a request was sent with, or None. Raises InvalidInput for an odd one."""
    key = request.headers.get(HEADER)
    if key is None:
        return None
    if not _KEY.fullmatch(key):
        raise InvalidInput(f"must be 1 to {LONGEST_KEY} visible ASCII characters", field=HEADER)
    client = getattr(request.state, "key_id", None)
    name = key if client is None else f"{client} {key}"  # no key of a client holds a space
    asked = json.dumps([request.url.path, body], sort_keys=True)
    return IdempotencyKey(name, hashlib.sha256(asked.encode()).hexdigest())


KEY_PARAMETER: Final[dict[str, Any]] = {
    "name": HEADER,
    "in": "header",
    "required": False,
    "description": "Names the request: with the same key and body it is the same job again.",
    "schema": {"type": "string", "minLength": 1, "maxLength": LONGEST_KEY},
}
