"""Questions and answers between the service and its parsers: fields as JSON, arrays as they lie in
memory. Nothing in one is ever run, unpickled or believed.

    magic   8 bytes
    length  8 bytes, little-endian: of the header
    header  JSON: {"fields": {...}, "arrays": [[dtype, [sizes]], ...]}
    arrays  each at a multiple of 64 bytes, C-contiguous, little-endian
"""

import json
import math
import os
from collections.abc import Iterator, Sequence
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

MAGIC: Final = b"raysvcP1"
ALIGNMENT: Final = 64
MAX_HEADER_BYTES: Final = 64 << 20
MAX_ARRAYS: Final = 1 << 17
MAX_DIMENSIONS: Final = 4
LARGEST_ARRAY: Final = 1 << 40
"""Elements."""
DTYPES: Final = ("|u1", "<i4", "<f4", "<f8")
PIECE_BYTES: Final = 1 << 30
"""Read or written at a time; Linux moves at most 2 GiB."""


class Message(NamedTuple):
    """What is said, and the arrays that go with it, which the fields name by their numbers."""

    fields: dict[str, Any]
    arrays: Sequence[NDArray[Any]] = ()


class BadMessage(Exception):
    """What was written is not a message: the writer was broken, or broken into."""


def write_message(file: int, message: Message) -> None:
    """Replace what an open file (a descriptor) holds by a message."""
    arrays = [np.ascontiguousarray(array) for array in message.arrays]
    described = [[array.dtype.newbyteorder("<").str, array.shape] for array in arrays]
    if any(dtype not in DTYPES for dtype, _ in described):
        raise TypeError("a message takes uint8, int32, float32 and float64")
    header = json.dumps({"fields": message.fields, "arrays": described}).encode("ascii")
    os.ftruncate(file, 0)
    _write(file, MAGIC + len(header).to_bytes(8, "little") + header, 0)
    for array, begin in zip(arrays, _places(len(header), [a.nbytes for a in arrays]), strict=True):
        if array.nbytes:
            _write(file, array.data.cast("B"), begin)


def read_message(file: int, max_bytes: int) -> Message:
    """Copy a message out of an open file, whose writer may still be at it.

    Everything is checked on the copy: that sizes are those that were announced, dtypes known, and
    the whole at most `max_bytes`. Raises BadMessage.
    """
    size = os.fstat(file).st_size
    if size > max_bytes:
        raise BadMessage(f"{size:,} bytes")
    start = _read(file, 16, 0)
    length = int.from_bytes(start[8:], "little")
    if start[:8] != MAGIC or length > min(MAX_HEADER_BYTES, size):
        raise BadMessage("has no header")
    try:
        header = json.loads(_read(file, length, 16).decode("ascii"))
        fields, described = header["fields"], header["arrays"]
        if not isinstance(fields, dict) or len(described) > MAX_ARRAYS:
            raise ValueError("has another shape")
        shapes = [(np.dtype(dtype), _shape(sizes)) for dtype, sizes in map(_pair, described)]
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise BadMessage(f"has a broken header: {str(error)[:100]}") from None
    sizes = [dtype.itemsize * math.prod(shape) for dtype, shape in shapes]
    if sum(sizes) > size:
        raise BadMessage("holds less than it says")
    arrays = []
    for (dtype, shape), begin in zip(shapes, _places(length, sizes), strict=True):
        array = np.empty(shape, dtype)
        if array.nbytes:
            _read_into(file, array.data.cast("B"), begin)
        arrays.append(array)
    return Message(fields, arrays)


def _pair(description: Any) -> tuple[str, Any]:
    dtype, sizes = description
    if dtype not in DTYPES:
        raise ValueError("has an unknown dtype")
    return dtype, sizes


def _shape(sizes: Any) -> tuple[int, ...]:
    if not isinstance(sizes, list) or len(sizes) > MAX_DIMENSIONS:
        raise ValueError("has an array of too many dimensions")
    fits = all(type(size) is int and size >= 0 for size in sizes)
    # NumPy refuses a large side even beside one of length 0.
    if not fits or math.prod(max(size, 1) for size in sizes) > LARGEST_ARRAY:
        raise ValueError("has an array of impossible size")
    return tuple(sizes)


def _places(header: int, sizes: Sequence[int]) -> Iterator[int]:
    """Where arrays of so many bytes begin."""
    place = 16 + header
    for size in sizes:
        place = -(-place // ALIGNMENT) * ALIGNMENT
        yield place
        place += size


def _write(file: int, data: bytes | memoryview, place: int) -> None:
    view = memoryview(data)
    while view:
        written = os.pwrite(file, view[:PIECE_BYTES], place)
        view, place = view[written:], place + written


def _read(file: int, size: int, place: int) -> bytes:
    data = bytearray(size)
    _read_into(file, memoryview(data), place)
    return bytes(data)


def _read_into(file: int, view: memoryview, place: int) -> None:
    while view:
        count = os.preadv(file, [view[:PIECE_BYTES]], place)
        if not count:
            raise BadMessage("ends early")
        view, place = view[count:], place + count
