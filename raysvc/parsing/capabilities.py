"""What the superuser may do and others not (capabilities(7), Linux)."""

import ctypes
import platform
import struct
import sys
from typing import Final

_NUMBERS: Final = {"x86_64": 126, "aarch64": 91}
"""Of the system call capset."""
_VERSION: Final = 0x20080522  # linux/capability.h
_READ_ANYTHING: Final = 1 << 2  # CAP_DAC_READ_SEARCH


def give_up_capabilities() -> None:
    """Be like anybody else who owns the same files, in this thread and those that it starts.

    Limits cannot be raised again then, nor other users' files written, nor other processes looked
    into. What stays, where it was there, is to read any file: Python's own may belong to somebody.
    """
    number = _NUMBERS.get(platform.machine())
    if not sys.platform.startswith("linux") or number is None:
        return
    libc = ctypes.CDLL(None, use_errno=True)
    header = struct.pack("=Ii", _VERSION, 0)
    for kept in (_READ_ANYTHING, 0):  # what was not there cannot be kept
        # Effective, permitted and inheritable, twice 32 bits of each.
        if libc.syscall(number, header, struct.pack("=6I", kept, kept, 0, 0, 0, 0)) == 0:
            return
