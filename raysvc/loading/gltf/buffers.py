"""Buffers and buffer views: where bytes are, every range checked (specification, section 3.6.1)."""

import base64
import binascii
import urllib.parse

from raysvc.errors import InvalidScene
from raysvc.loading.gltf.document import Document, item

_DATA = "data:"


class Buffers:
    """The bytes of a document's buffers, each read once, when it is first asked for."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self._whole: dict[int, bytes] = {}

    def view(self, index: int, path: str) -> memoryview:
        """Return the bytes of bufferViews[index]; `path` is who asks."""
        views = self._document.gltf.bufferViews
        view = item(views, index, "bufferViews", path)
        here = f"bufferViews[{index}]"
        data = self._buffer(view.buffer, f"{here}.buffer")
        if view.byteOffset < 0 or view.byteLength < 0:
            part = "byteOffset" if view.byteOffset < 0 else "byteLength"
            raise InvalidScene("is negative", f"{here}.{part}")
        end = view.byteOffset + view.byteLength
        if end > len(data):
            raise InvalidScene(
                f"ends at byte {end:,} of a buffer of {len(data):,}", f"{here}.byteLength"
            )
        return memoryview(data)[view.byteOffset : end]

    def stride(self, index: int) -> int | None:
        """Return the bytes from one element to the next, or None where they are packed."""
        stride: int | None = self._document.gltf.bufferViews[index].byteStride
        if stride == 0:
            here = f"bufferViews[{index}].byteStride"
            self._document.journal.note("0 is read as tightly packed", here)
            return None
        return stride

    def _buffer(self, index: int, path: str) -> memoryview | bytes:
        buffer = item(self._document.gltf.buffers, index, "buffers", path)
        here = f"buffers[{index}]"
        if index not in self._whole:
            self._whole[index] = self._read(index, buffer.uri, here)
        data = self._whole[index]
        if buffer.byteLength < 0 or buffer.byteLength > len(data):
            raise InvalidScene(
                f"{buffer.byteLength:,} bytes declared, {len(data):,} there", f"{here}.byteLength"
            )
        return memoryview(data)[: buffer.byteLength]

    def _read(self, index: int, uri: str | None, here: str) -> bytes:
        if uri is not None:
            return read_uri(uri, self._document, f"{here}.uri")
        if index != 0 or self._document.binary is None:
            raise InvalidScene("is missing, and there is no binary chunk", f"{here}.uri")
        return self._document.binary


def read_uri(uri: str, document: Document, path: str) -> bytes:
    """Return what a data URI holds, or the file that a percent-encoded relative URI names."""
    if uri[: len(_DATA)].lower() == _DATA:
        return _read_data_uri(uri, path)
    return document.files.read(_file_name(uri, document), path)


def _file_name(uri: str, document: Document) -> str:
    name = urllib.parse.unquote(uri, errors="surrogateescape")
    # Some exporters forget to encode; a file that is really called so is what they mean.
    return uri if uri != name and uri in document.files else name


def _read_data_uri(uri: str, path: str) -> bytes:
    kind, comma, body = uri[len(_DATA) :].partition(",")
    if not comma:
        raise InvalidScene("is a data URI without data", path)
    if not kind.lower().endswith(";base64"):
        return urllib.parse.unquote_to_bytes(body)
    try:
        body = urllib.parse.unquote(body).strip() if "%" in body else body.strip()
        padding = "=" * (-len(body) % 4)
        return base64.b64decode((body + padding).encode("ascii"), validate=True)
    except (binascii.Error, ValueError) as error:
        raise InvalidScene(f"is not base64: {str(error)[:100]}", path) from None
