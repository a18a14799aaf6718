"""JSON that any client can read."""

import json
from typing import Any

from starlette.responses import JSONResponse


class SafeJSONResponse(JSONResponse):
    """ASCII JSON: names out of scene files may hold what UTF-8 cannot say (lone surrogates)."""

    def render(self, content: Any) -> bytes:
        """Encode; refuses NaN and infinity."""
        return json.dumps(content, allow_nan=False, separators=(",", ":")).encode("ascii")
