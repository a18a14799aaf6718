"""Who may use which route: one literal table, and the check that reads it.

Where the service has keys, a route that is not public wants one in `Authorization: Bearer KEY`
(RFC 6750) whose scope reaches as far. Where it has none, everybody may do everything, but for the
pages of strangers (`api.origins`).
"""

import re
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Final

import anyio.to_thread
from fastapi import Request

from api.origins import OriginCheck
from raysvc.access import KeyStore, Scope
from raysvc.errors import NotAllowed, NotAuthenticated

SCOPES: Final[Mapping[tuple[str, str], Scope | None]] = MappingProxyType(
    {
        ("GET", "/v1/scenes"): Scope.READ,
        ("POST", "/v1/scenes"): Scope.RENDER,
        ("GET", "/v1/scenes/{id}"): Scope.READ,
        ("DELETE", "/v1/scenes/{id}"): Scope.ADMIN,
        ("GET", "/v1/scenes/{id}/positions"): Scope.READ,
        ("PUT", "/v1/scenes/{id}/positions"): Scope.RENDER,
        ("GET", "/v1/environments"): Scope.READ,
        ("POST", "/v1/environments"): Scope.RENDER,
        ("GET", "/v1/environments/{id}"): Scope.READ,
        ("DELETE", "/v1/environments/{id}"): Scope.ADMIN,
        ("POST", "/v1/environments/{id}/filtered"): Scope.RENDER,
        ("POST", "/v1/renders"): Scope.RENDER,
        ("GET", "/v1/renders/{id}"): Scope.READ,
        ("GET", "/v1/renders/{id}/image"): Scope.READ,
        ("GET", "/v1/renders/{id}/events"): Scope.READ,
        ("DELETE", "/v1/renders/{id}"): Scope.RENDER,
        ("POST", "/v1/render"): Scope.RENDER,
        ("POST", "/v1/lens"): Scope.RENDER,
        ("POST", "/v1/comparisons"): Scope.RENDER,
        ("GET", "/v1/comparisons/{id}"): Scope.READ,
        ("GET", "/v1/comparisons/{id}/events"): Scope.READ,
        ("GET", "/v1/comparisons/{id}/table.{format}"): Scope.READ,
        ("GET", "/v1/comparisons/{id}/chart.{format}"): Scope.READ,
        ("GET", "/v1/comparisons/{id}/heat_map.{format}"): Scope.READ,
        ("DELETE", "/v1/comparisons/{id}"): Scope.RENDER,
        ("GET", "/v1/structures"): Scope.READ,
        ("GET", "/metrics"): Scope.READ,
        # For those who watch over the process, and for people who look around first.
        ("GET", "/healthz"): None,
        ("GET", "/readyz"): None,
        ("GET", "/"): None,
        ("GET", "/docs"): None,
    }
)
"""The scope that a route needs, or None where it is public. A route that is not here needs `admin`;
what is no route of ours is public: `/openapi.json`, and the scripts of the documentation
(`/docs/assets`), which say nothing of what the service holds."""

SCHEME: Final = "key"
"""What the OpenAPI document calls the scheme."""
SECURITY_SCHEME: Final[dict[str, Any]] = {
    "type": "http",
    "scheme": "bearer",
    "description": "A key that `raysvc keys add` made; not needed where the service has none.",
}

_BEARER: Final = re.compile(r"Bearer +(\S+)", re.IGNORECASE)


class Guard:
    """Refuses requests that the keys of a service do not allow; a dependency of every route."""

    def __init__(self, keys: KeyStore, check_origin: OriginCheck) -> None:
        self._keys = keys
        self._check_origin = check_origin

    async def __call__(self, request: Request) -> None:
        """Raise ForeignPage, NotAuthenticated or NotAllowed."""
        self._check_origin(request)
        needed = SCOPES.get((request.method, request.scope["route"].path), Scope.ADMIN)
        if needed is None:
            return
        if not self._keys.is_fresh:
            # Whoever changes the keys may hold the file for a while; others are not to wait too.
            await anyio.to_thread.run_sync(self._keys.refresh)
        if not self._keys.guarded:
            return
        given = request.headers.get("authorization")
        if given is None:
            raise NotAuthenticated("this service wants a key", field="Authorization")
        found = _BEARER.fullmatch(given.strip())
        key = self._keys.check(found.group(1)) if found else None
        if key is None:
            raise NotAuthenticated("the key is unknown or was revoked", field="Authorization")
        if not key.scope.includes(needed):
            raise NotAllowed(
                f"the key {key.id} is for {key.scope}; this needs {needed}",
                field="Authorization",
                scope=needed,
            )
        request.state.key_id = key.id


def challenge(error: NotAuthenticated | NotAllowed, key_given: bool) -> str:
    """WWW-Authenticate of a refusal (RFC 6750, section 3)."""
    if isinstance(error, NotAllowed) and error.scope is not None:
        return f'Bearer realm="raysvc", error="insufficient_scope", scope="{error.scope}"'
    return 'Bearer realm="raysvc"' + (', error="invalid_token"' if key_given else "")


def describe_security(schema: dict[str, Any]) -> None:
    """Say in an OpenAPI document which operations want a key, and of what scope."""
    schema["components"].setdefault("securitySchemes", {})[SCHEME] = SECURITY_SCHEME
    for path, operations in schema["paths"].items():
        for method, operation in operations.items():
            scope = SCOPES.get((method.upper(), path), Scope.ADMIN)
            # An empty requirement beside it: where the service has no keys, none is needed.
            operation["security"] = [] if scope is None else [{SCHEME: []}, {}]
            if scope is not None:
                operation["x-scope"] = str(scope)
