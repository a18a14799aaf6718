"""A file of named arrays with a head of JSON, laid out to be mapped into memory.

    b"raysvc-arrays-1\\n", 8 bytes: length of the head, the head, and from the next multiple of
    64 on the arrays as they are in memory, each at a multiple of 64
    head: {"about": {...}, "arrays": [{"name", "dtype", "shape", "at"}], "size"}

`at` counts from the first array, and `size` is where the last one ends. It is not compressed: what
is rendered again in a second is not worth a second of squeezing.
"""

import json
import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any, BinaryIO, Final

import numpy as np
from numpy.typing import NDArray

MAGIC: Final = b"raysvc-arrays-1\n"
ALIGNMENT: Final = 64
LONGEST_HEAD: Final = 64 << 20

Arrays = Mapping[str, NDArray[Any]]


def write_arrays(file: BinaryIO, about: Mapping[str, Any], arrays: Arrays) -> None:
    """Write everything to an empty file, from its beginning."""
    entries, at = [], 0
    for name, array in arrays.items():
        entries.append(
            {"name": name, "dtype": array.dtype.str, "shape": list(array.shape), "at": at}
        )
        at = _aligned(at + array.nbytes)
    head = json.dumps({"about": about, "arrays": entries, "size": at}, allow_nan=False).encode()
    prefix = MAGIC + struct.pack("<Q", len(head)) + head
    file.write(prefix.ljust(_aligned(len(prefix)), b"\0"))
    for array in arrays.values():
        file.write(np.ascontiguousarray(array).data)
        file.write(bytes(_aligned(array.nbytes) - array.nbytes))


def read_arrays(path: Path) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """Return what was written; the arrays cannot be written to and stay on the disk until they
    are read.

    Raises OSError, and ValueError for a file that is not whole.
    """
    with path.open("rb") as file:
        start = file.read(len(MAGIC) + 8)
        if len(start) != len(MAGIC) + 8 or not start.startswith(MAGIC):
            raise ValueError("not a file of arrays")
        (length,) = struct.unpack("<Q", start[len(MAGIC) :])
        head = json.loads(file.read(min(length, LONGEST_HEAD)))
        first = _aligned(len(start) + length)
        if file.seek(0, 2) != first + head["size"]:
            raise ValueError("a file of arrays that was cut off")
    if not head["size"]:
        return head["about"], {
            e["name"]: np.empty(e["shape"], np.dtype(e["dtype"])) for e in head["arrays"]
        }
    stored = np.memmap(path, np.uint8, "r")
    arrays = {}
    for entry in head["arrays"]:
        dtype = np.dtype(entry["dtype"])
        begin = first + entry["at"]
        end = begin + dtype.itemsize * int(np.prod(entry["shape"], dtype=np.int64))
        arrays[entry["name"]] = (
            stored[begin:end].view(np.ndarray).view(dtype).reshape(entry["shape"])
        )
    return head["about"], arrays


def _aligned(size: int) -> int:
    return -(-size // ALIGNMENT) * ALIGNMENT
