"""Requests that the page of a stranger makes somebody's browser send.

A service that lets everybody in would be open to every page that is looked at on its machine:
forms can be posted to any address, and a name that an attacker owns can be made to lead to this
machine, whose answers his pages may then read ("DNS rebinding").
"""

from collections.abc import Collection
from urllib.parse import urlsplit

from fastapi import Request

from raysvc.errors import ForeignPage

LOOKING = ("GET", "HEAD")
"""Methods that any page may make a browser use: pages may link to what is only looked at."""


class OriginCheck:
    """Knows whose pages may call, and by what names the service is called.

    Parameters
    ----------
    origins
        such as `https://example.org`; `*` is all of them. Pages of the service's own may always.
    hosts
        names and addresses, without ports; with none, every name will do
    """

    def __init__(self, origins: Collection[str] = (), hosts: Collection[str] = ()) -> None:
        self._origins = frozenset(origins)
        self._hosts = frozenset(map(_bare, hosts))

    def __call__(self, request: Request) -> None:
        """Raise ForeignPage."""
        host = request.headers.get("host", "")
        if self._hosts and _bare(host) not in self._hosts:
            raise ForeignPage(
                f"the service is not called {host[:80]!r}; RAYSVC_HOSTS says what it is called",
                field="Host",
            )
        if request.method in LOOKING or not _is_foreign(request, host):
            return
        if not self._origins & {"*", request.headers.get("origin")}:
            raise ForeignPage("pages of this origin may not call the service", field="Origin")


def _is_foreign(request: Request, host: str) -> bool:
    """Whether a page of another origin has sent this.

    Browsers say so by Sec-Fetch-Site (W3C, Fetch Metadata), but not to an address of another
    machine without TLS; then Origin tells (RFC 6454, section 7). Other clients send neither.
    """
    site = request.headers.get("sec-fetch-site")
    if site is not None:
        return site in ("cross-site", "same-site")
    origin = request.headers.get("origin")
    if origin is None:
        return False
    # Not the scheme: what ends TLS in front of the service leaves the name, and no trace of TLS.
    port = {"http": ":80", "https": ":443"}.get(urlsplit(origin).scheme, "")
    return _without(urlsplit(origin).netloc, port) != _without(host, port)


def _without(host: str, port: str) -> str:
    return host.lower().removesuffix(port)


def _bare(host: str) -> str:
    """A name or address alone, of a Host header or of the settings."""
    host = host.strip().lower()
    if not host.startswith("["):
        host = host.partition(":")[0]
    elif "]" in host:
        host = host[: host.index("]") + 1]
    return host.removesuffix(".")
