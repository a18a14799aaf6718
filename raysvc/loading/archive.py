"""Unpacking a .zip in memory, distrusting everything that it says about itself."""

import io
import lzma
import stat
import struct
import zipfile
import zlib

from raysvc.errors import InvalidScene, LimitExceeded, Unsupported
from raysvc.limits import Limits

_CENTRAL_ENTRY = b"PK\x01\x02"
_ENCRYPTED = 0x1
_METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
_IGNORED = ("__MACOSX/",)
_BROKEN = (
    zipfile.BadZipFile,
    zlib.error,
    lzma.LZMAError,
    struct.error,
    OSError,
    EOFError,
    ValueError,
    RuntimeError,
    OverflowError,
    IndexError,
)


def unpack(data: bytes, limits: Limits) -> dict[str, bytes]:
    """Return the files of an archive by name.

    Parameters
    ----------
    data
        the whole .zip
    limits
        on the number of files, on declared and actual sizes and on their ratio to `data`

    Raises
    ------
    InvalidScene
        broken, encrypted, holds another archive or a symbolic link, or repeats a name
    Unsupported
        compressed with something other than deflate
    LimitExceeded
        too many files or too large, found before anything is unpacked
    """
    # Every entry has this signature, so it bounds what the directory can make zipfile allocate.
    if data.count(_CENTRAL_ENTRY) > limits.max_files:
        raise LimitExceeded(f"holds more than {limits.max_files} files", "archive")
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            entries = [entry for entry in archive.infolist() if not _skipped(entry)]
            _check_sizes(entries, len(data), limits)
            files: dict[str, bytes] = {}
            for entry in entries:
                _check_entry(entry)
                if entry.filename in files:
                    raise InvalidScene("the archive holds this name twice", _field(entry))
                files[entry.filename] = archive.read(entry)
                if len(files[entry.filename]) != entry.file_size:
                    raise InvalidScene("is not as long as the archive says", _field(entry))
            return files
    except _BROKEN as error:
        raise InvalidScene(f"broken archive: {str(error)[:200]}", "archive") from None


def _skipped(entry: zipfile.ZipInfo) -> bool:
    return entry.is_dir() or entry.filename.startswith(_IGNORED)


def _check_sizes(entries: list[zipfile.ZipInfo], packed: int, limits: Limits) -> None:
    if len(entries) > limits.max_files:
        raise LimitExceeded(
            f"holds {len(entries)} files; the limit is {limits.max_files}", "archive"
        )
    for entry in entries:
        if entry.file_size > limits.max_file_bytes:
            raise LimitExceeded(f"unpacks to {entry.file_size:,} bytes", _field(entry))
    total = sum(entry.file_size for entry in entries)
    if total > limits.max_scene_bytes:
        raise LimitExceeded(
            f"unpacks to {total:,} bytes; the limit is {limits.max_scene_bytes:,}", "archive"
        )
    if total > limits.max_archive_ratio * packed:
        raise LimitExceeded(
            f"unpacks to more than {limits.max_archive_ratio:g} times its size", "archive"
        )


def _check_entry(entry: zipfile.ZipInfo) -> None:
    if entry.flag_bits & _ENCRYPTED:
        raise InvalidScene("is encrypted", _field(entry))
    if stat.S_ISLNK(entry.external_attr >> 16):
        raise InvalidScene("is a symbolic link", _field(entry))
    if entry.filename.lower().endswith(".zip"):
        raise InvalidScene("an archive within an archive is not opened", _field(entry))
    if entry.compress_type not in _METHODS:
        raise Unsupported("is not compressed with deflate", _field(entry))


def _field(entry: zipfile.ZipInfo) -> str:
    return f"archive/{ascii(entry.filename[:120])[1:-1]}"
