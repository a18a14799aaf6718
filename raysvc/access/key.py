"""What an API key looks like, and what is kept of it.

    raysvc_<12 hex digits: its id>_<64 hex digits: its secret>

The id is public: it finds the key in the store, and is what people revoke it by. The secret is 256
random bits, and only the SHA-256 of the whole key is kept. Passwords need a slow, salted hash since
people choose them from few; nobody guesses one of 2^256 keys, however fast a guess is hashed, and
no two keys are alike. So a request costs microseconds, and a stolen store opens nothing.
"""

import hashlib
import hmac
import re
import secrets
from dataclasses import dataclass
from typing import Final

from raysvc.access.scopes import Scope

PREFIX: Final = "raysvc"
ID_BYTES: Final = 6
SECRET_BYTES: Final = 32
_FORM: Final = re.compile(
    rf"{PREFIX}_([0-9a-f]{{{2 * ID_BYTES}}})_[0-9a-f]{{{2 * SECRET_BYTES}}}", re.ASCII
)


@dataclass(frozen=True, slots=True)
class ApiKey:
    """What is kept of a key."""

    id: str
    name: str
    """What people call it."""
    scope: Scope
    digest: bytes
    """SHA-256 of the key as it was handed out."""
    created_s: float
    revoked_s: float | None = None


def new_secret() -> tuple[str, str]:
    """Make a key; returns its id and all of it."""
    id = secrets.token_hex(ID_BYTES)
    return id, f"{PREFIX}_{id}_{secrets.token_hex(SECRET_BYTES)}"


def id_in(key: str) -> str | None:
    """The id that a key shows, or None for what is no key."""
    found = _FORM.fullmatch(key)
    return found.group(1) if found else None


def digest_of(key: str) -> bytes:
    """What is kept of a key."""
    return hashlib.sha256(key.encode()).digest()


def is_key_of(key: str, digest: bytes) -> bool:
    """Compare in a time that does not depend on where the two differ."""
    return hmac.compare_digest(digest_of(key), digest)
