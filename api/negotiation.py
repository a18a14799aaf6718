"""Accept, Prefer and If-None-Match: what a client would like, as HTTP says it."""

import re
from collections.abc import Mapping
from typing import Final

from api.problems import NotAcceptable

MEDIA_TYPES: Final = {
    "png": "image/png",
    "png16": "image/png",
    "jpg": "image/jpeg",
    "webp": "image/webp",
    "exr": "image/x-exr",
    "npz": "application/x-npz",
}
"""By the name of a format; where a client likes several equally, the first of them wins."""

ALIASES: Final = {"image/exr": "image/x-exr", "image/jpg": "image/jpeg"}

_WAIT = re.compile(r"(?:^|[,;])\s*wait\s*=\s*\"?(\d{1,9})\"?\s*(?=[,;]|$)", re.IGNORECASE)


def format_for(accept: str | None, media_types: Mapping[str, str] = MEDIA_TYPES) -> str:
    """Choose a format by an Accept header (RFC 9110, section 12.5.1). Raises NotAcceptable.

    Where the client does not mind, it is the first of `media_types`.
    """
    if not accept or not accept.strip():
        return next(iter(media_types))
    wanted = [_media_range(part) for part in accept.split(",") if part.strip()]
    best, best_quality = None, 0.0
    for format, media_type in media_types.items():
        quality = _quality(media_type, wanted)
        if quality > best_quality:
            best, best_quality = format, quality
    if best is None:
        known = ", ".join(dict.fromkeys(media_types.values()))
        raise NotAcceptable(f"there is {known}", field="Accept")
    return best


def wait_seconds(prefer: list[str]) -> float | None:
    """Return N of `Prefer: wait=N` (RFC 7240, section 4.3); what is not understood is ignored."""
    found = _WAIT.search(",".join(prefer))
    return float(found.group(1)) if found else None


def matches(if_none_match: str | None, etag: str) -> bool:
    """Does the client hold this version already (RFC 9110, section 13.1.2: weak comparison)?"""
    if if_none_match is None:
        return False
    tags = [tag.strip().removeprefix("W/") for tag in if_none_match.split(",")]
    return "*" in tags or etag in tags


def _media_range(text: str) -> tuple[str, float]:
    name, *parameters = (part.strip().lower() for part in text.split(";"))
    quality = 1.0
    for parameter in parameters:
        key, _, value = parameter.partition("=")
        if key.strip() == "q":
            quality = float(value) if re.fullmatch(r"[01](\.\d{0,3})?", value.strip()) else 0.0
    return ALIASES.get(name, name), quality


def _quality(media_type: str, wanted: list[tuple[str, float]]) -> float:
    """The quality that the most specific matching range gives to a media type."""
    for pattern in (media_type, media_type.partition("/")[0] + "/*", "*/*"):
        found = [quality for name, quality in wanted if name == pattern]
        if found:
            return max(found)
    return 0.0
