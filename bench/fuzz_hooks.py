"""How `bench.fuzz_http` steers schemathesis: half of the requests name things that there are.

Otherwise nearly every request would end at a name that nobody knows.
"""

import os
import re
import zlib
from typing import Any

import schemathesis

SMALL = {"width": 32, "height": 18}


@schemathesis.hook
def map_path_parameters(context: Any, path_parameters: Any) -> Any:
    """Put the id of something that there is where an id goes."""
    kind = re.match(r"/v1/(\w+)/", context.operation.path)
    if kind is not None and path_parameters and "id" in path_parameters and _half(path_parameters):
        there = os.environ[f"RAYSVC_FUZZ_{kind[1].upper()}"]
        return {**path_parameters, "id": there}
    return path_parameters


@schemathesis.hook
def map_body(context: Any, body: Any) -> Any:
    """Put a scene that there is, and a small picture, into the body of a render or comparison."""
    if not isinstance(body, dict) or "scene" not in body or not _half(body):
        return body
    camera = body.get("camera")
    small = {**camera, **SMALL} if isinstance(camera, dict) else SMALL
    return {**body, "scene": "builtin:cornell", "camera": small}


@schemathesis.serializer("application/x-npy")
def npy(context: Any, value: Any) -> bytes:
    """Send what is to be a NumPy file as it is: its example is a text, and nothing of the sort."""
    return value if isinstance(value, bytes) else str(value).encode()


def _half(thing: Any) -> bool:
    return zlib.crc32(repr(thing).encode()) % 2 == 0
