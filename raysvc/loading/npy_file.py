"""NumPy's .npy: its header checked before memory is asked for, and nothing unpickled."""

import io

import numpy as np
from numpy.typing import NDArray

LONGEST_HEADER = 10_000
"""Characters of an .npy header; NumPy itself reads no longer ones."""
WIDEST_NUMBER = 8
"""Bytes; float64."""


def npy_array(data: bytes | bytearray, shape: tuple[int, ...] | None = None) -> NDArray[np.generic]:
    """View an .npy file of real numbers in memory, of a given shape if there is one.

    Raises ValueError saying what is wrong with it.
    """
    file = io.BytesIO(data[: LONGEST_HEADER + 128])
    try:
        version = np.lib.format.read_magic(file)
        if version == (1, 0):
            header = np.lib.format.read_array_header_1_0(file, LONGEST_HEADER)
        elif version == (2, 0):
            header = np.lib.format.read_array_header_2_0(file, LONGEST_HEADER)
        else:
            raise ValueError(f"version {version} of the format")
        found, by_columns, dtype = header
    except Exception as error:
        # The header is a Python literal, and its parser is not ours.
        raise ValueError(f"is not an .npy file: {str(error)[:200]}") from None
    if dtype.kind not in "fiu" or dtype.itemsize > WIDEST_NUMBER:
        raise ValueError(f"needs real numbers of at most 64 bits, has {dtype}")
    if shape is not None and found != shape:
        raise ValueError(f"needs the shape {shape}, has {found}")
    count = 1
    for size in found:
        count *= size
    start, expected = file.tell(), count * dtype.itemsize
    if len(data) - start != expected:
        raise ValueError(f"has {len(data) - start:,} bytes of numbers, not {expected:,}")
    numbers = np.frombuffer(data, dtype, offset=start)
    return numbers.reshape(found, order="F" if by_columns else "C")
