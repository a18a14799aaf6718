"""Requests to one service, repeated where that does no harm.

Repeated are, whatever they were, those that were never sent (no connection) and those that were
refused before anything was done (429). After a lost answer or a 502, 503, 504 it is what may be
done twice: GET, PUT, DELETE, and POST with an Idempotency-Key. `Retry-After` is heeded; otherwise
pauses double, with jitter so that clients that were refused together do not come back together
(Brooker, "Exponential Backoff And Jitter", 2015).
"""

import random
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import Any, Final

import httpx

from raysvc.client.problems import error_of, retry_after_s
from raysvc.errors import InvalidSetting, Unreachable
from raysvc.version import VERSION

REPEATABLE: Final = frozenset({"GET", "HEAD", "PUT", "DELETE"})
PASSING: Final = frozenset({502, 503, 504})
"""Statuses that say that the same request may succeed soon."""
FIRST_PAUSE_S: Final = 0.2
LONGEST_PAUSE_S: Final = 10.0

OpenFiles = Callable[[ExitStack], list[tuple[str, Any]]]
"""Opens the parts of a form, anew for each try; the stack closes them."""


class Connection:
    """One address, one key.

    Parameters
    ----------
    url
        such as `http://127.0.0.1:8000`; a path before `/v1` is kept
    key
        an API key, sent to that address alone
    timeout_s
        how long the service may be silent
    patience_s
        how long a request is repeated, from when it was first made
    transport
        what carries requests; by default the network
    """

    def __init__(
        self,
        url: str,
        key: str | None = None,
        *,
        timeout_s: float = 60.0,
        patience_s: float = 60.0,
        transport: httpx.BaseTransport | None = None,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        headers = {"User-Agent": f"raysvc/{VERSION}"}
        if key is not None:
            headers["Authorization"] = f"Bearer {key}"
        if not url.startswith(("http://", "https://")):
            raise InvalidSetting(f"must begin with http:// or https:// (got {url[:80]!r})", "url")
        try:
            self._http = httpx.Client(
                base_url=url, headers=headers, timeout=timeout_s, transport=transport
            )
        except (httpx.InvalidURL, UnicodeEncodeError) as error:
            raise InvalidSetting(f"is no address, or the key is none: {error}", "url") from None
        self._patience_s = patience_s
        self._sleep = sleep

    def close(self) -> None:
        """Let go of the network."""
        self._http.close()

    def send(
        self,
        method: str,
        path: str,
        *,
        files: OpenFiles | None = None,
        repeatable: bool | None = None,
        accepted: tuple[int, ...] = (),
        **content: Any,
    ) -> httpx.Response:
        """Make a request; `content` is what httpx takes (`json`, `params`, `headers`, `data`, ...).

        Returns an answer that is no error, or whose status is in `accepted`. Raises the exception
        that a problem tells of, and Unreachable.
        """
        may_repeat = method in REPEATABLE if repeatable is None else repeatable
        end = time.monotonic() + self._patience_s
        pause_s = FIRST_PAUSE_S
        while True:
            wait_s = random.uniform(0.5, 1.0) * pause_s
            failure: Exception
            try:
                with ExitStack() as stack:
                    parts = None if files is None else files(stack)
                    response = self._http.request(method, path, files=parts, **content)
            except httpx.TransportError as error:
                failure = Unreachable(f"{self._http.base_url}: {error or type(error).__name__}")
                never_sent = isinstance(error, httpx.ConnectError | httpx.ConnectTimeout)
                again = may_repeat or never_sent
            else:
                if not response.is_error or response.status_code in accepted:
                    return response
                failure = error_of(response)
                passing = response.status_code in PASSING
                again = response.status_code == 429 or (may_repeat and passing)
                wait_s = max(wait_s, retry_after_s(response.headers) or 0.0)
            if not again or time.monotonic() + wait_s > end:
                raise failure from None
            self._sleep(wait_s)
            pause_s = min(2 * pause_s, LONGEST_PAUSE_S)

    @contextmanager
    def lines(self, path: str) -> Iterator[Iterator[str]]:
        """The lines of an answer while they come; never repeated.

        Raises the exception that a problem tells of, and Unreachable, also when it is cut.
        """
        try:
            with self._http.stream("GET", path) as response:
                if response.is_error:
                    response.read()
                    raise error_of(response)
                yield response.iter_lines()
        except httpx.TransportError as error:
            raise Unreachable(f"{self._http.base_url}: {error or type(error).__name__}") from None
