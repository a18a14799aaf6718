"""Uploads: multipart forms with files, bounded while they are read."""

from dataclasses import dataclass
from typing import Final

from fastapi import Request
from starlette.datastructures import UploadFile
from starlette.formparsers import MultiPartException, MultiPartParser

from api.problems import MalformedBody
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

    Raises MalformedBody, LimitExceeded.
    """
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
    for name, value in items:
        if isinstance(value, UploadFile):
            form.files.setdefault(name, []).append(value)
        elif name in form.texts:
            form.close()
            raise InvalidInput("is given twice", field=name)
        else:
            form.texts[name] = value
    return form
