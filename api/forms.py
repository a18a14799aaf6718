"""Uploads: multipart forms with files, bounded while they are read."""

from dataclasses import dataclass
from typing import Final

from fastapi import Request
from python_multipart.multipart import parse_options_header
from starlette.datastructures import UploadFile
from starlette.formparsers import MultiPartException, MultiPartParser

from api.json_bodies import check_text
from api.problems import MalformedBody, UnsupportedMediaType
from raysvc.errors import InvalidInput, LimitExceeded
from raysvc.jobs import Upload

MAX_FIELDS: Final = 32
_TOO_MUCH: Final = ("Too many", "Part exceeded")
"""How Starlette says that a form is larger than it may be."""


@dataclass(frozen=True, slots=True)
class Form:
    """What a multipart body held: files by the name of their field, in order, and texts."""

    files: dict[str, list[UploadFile]]
    texts: dict[str, str]

    def refuse_unknown(self, files: set[str], texts: set[str]) -> None:
        """Raise InvalidInput for a field that nobody reads."""
        for given, known, what in (
            (self.files, files, "file field"),
            (self.texts, texts, "field"),
        ):
            for name in given:
                if name not in known:
                    raise InvalidInput(
                        f"unknown {what}; known are {', '.join(sorted(known))}", name
                    )

    def upload(self, field: str, main: str | None = None) -> Upload:
        """Read a field's files into memory; blocks, so call it from a thread."""
        contents: dict[str, bytes] = {}
        for part in self.files.get(field, []):
            name = part.filename or field
            if name in contents:
                raise InvalidInput(f"two files are called {name[:120]!r}", field)
            contents[name] = part.file.read()
        return Upload(contents, main)

    def close(self) -> None:
        """Delete the temporary files."""
        for parts in self.files.values():
            for part in parts:
                part.file.close()


def is_multipart(request: Request) -> bool:
    """Does the client send a form with files?"""
    return request.headers.get("content-type", "").lower().startswith("multipart/form-data")


async def read_form(request: Request, max_files: int, max_field_bytes: int) -> Form:
    """Read a multipart body; files larger than 1 MB go to temporary files.

    Raises MalformedBody, UnsupportedMediaType, LimitExceeded.
    """
    _refuse_other_charsets(request)
    parser = MultiPartParser(
        request.headers,
        request.stream(),
        max_files=max_files,
        max_fields=MAX_FIELDS,
        max_part_size=max_field_bytes,
    )
    try:
        items = (await parser.parse()).multi_items()
    except MultiPartException as error:
        if error.message.startswith(_TOO_MUCH):
            raise LimitExceeded(error.message, field="body") from None
        raise MalformedBody(error.message, field="body") from None
    form = Form({}, {})
    try:
        take(form, items)
    except InvalidInput:
        for _, value in items:
            if isinstance(value, UploadFile):
                value.file.close()
        raise
    return form


def take(form: Form, items: list[tuple[str, UploadFile | str]]) -> None:
    """Put the parts of a form in their places. Raises MalformedBody, InvalidInput."""
    for name, value in items:
        check_text(name, "body")
        if isinstance(value, UploadFile):
            check_text(value.filename or "", name)
            form.files.setdefault(name, []).append(value)
        elif name in form.texts:
            raise InvalidInput("is given twice", field=name)
        else:
            check_text(value, name)
            form.texts[name] = value


def _refuse_other_charsets(request: Request) -> None:
    """Raise UnsupportedMediaType unless names and texts are in UTF-8, as browsers send them.

    The parser would decode them as whatever Python has a codec for, some of which make no text.
    """
    _, options = parse_options_header(request.headers.get("content-type"))
    charset = options.get(b"charset", b"utf-8").decode("latin-1")
    if charset.lower() not in ("utf-8", "utf8"):
        raise UnsupportedMediaType(
            f"send names and texts in UTF-8, not {charset[:40]!r}", field="Content-Type"
        )
