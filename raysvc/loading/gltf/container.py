"""The binary container (.glb): specification, section 4.4."""

import struct

from raysvc.errors import InvalidScene, Unsupported
from raysvc.loading.gltf.journal import Journal

_MAGIC = b"glTF"
_JSON, _BIN = 0x4E4F534A, 0x004E4942
_HEADER, _CHUNK_HEADER = 12, 8


def is_container(data: bytes) -> bool:
    """Whether the file begins as a .glb does."""
    return data[:4] == _MAGIC


def open_container(data: bytes, journal: Journal) -> tuple[bytes, bytes | None]:
    """Return the JSON text and the binary buffer, if there is one; every length is checked.

    Raises InvalidScene (field `glb...`), or Unsupported for a version other than 2.
    """
    if len(data) < _HEADER:
        raise InvalidScene(f"{len(data)} bytes are too few for a header", "glb")
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2:
        raise Unsupported(f"version {version} of the container; only 2 is read", "glb.version")
    if length > len(data):
        raise InvalidScene(f"{length:,} bytes declared, {len(data):,} there", "glb.length")
    if length < len(data):
        journal.note("bytes after the end are ignored", "glb.length")
    chunks = list(_chunks(data, length))
    if not chunks or chunks[0][0] != _JSON:
        raise InvalidScene("the first chunk is not JSON", "glb.chunks[0]")
    binary = None
    for number, (kind, begin, end) in enumerate(chunks[1:], start=1):
        if kind == _BIN and number == 1:
            binary = data[begin:end]
        else:
            journal.note(f"chunk of type 0x{kind:08x} is ignored", f"glb.chunks[{number}]")
    _, begin, end = chunks[0]
    return data[begin:end], binary


def _chunks(data: bytes, length: int) -> list[tuple[int, int, int]]:
    """Type, begin and end of every chunk."""
    chunks: list[tuple[int, int, int]] = []
    at = _HEADER
    while at + _CHUNK_HEADER <= length:
        size, kind = struct.unpack_from("<II", data, at)
        begin = at + _CHUNK_HEADER
        if size > length - begin:
            where = f"glb.chunks[{len(chunks)}].length"
            raise InvalidScene(f"{size:,} bytes declared, {length - begin:,} there", where)
        chunks.append((kind, begin, begin + size))
        if len(chunks) > 64:
            raise InvalidScene("more than 64 chunks", "glb.chunks")
        at = begin + size
    return chunks
