"""Which files a process may still read, and nothing else with any (Landlock, Linux >= 5.13).

It needs what Python and its libraries are made of, as they load parts when they are first needed.
It needs none of the service's data, nor what /proc tells of other processes, their memory included;
and on newer kernels no signal of it reaches any other.
"""

import contextlib
import ctypes
import os
import struct
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Final

_CREATE, _ADD_RULE, _RESTRICT = 444, 445, 446  # system calls, the same on all machines
_ASK_VERSION, _PATH_BENEATH = 1, 1  # linux/landlock.h, as what follows
_READ_FILE, _READ_FOLDER = 1 << 2, 1 << 3
_FILE_RIGHTS: Final = {1: (1 << 13) - 1, 2: 1 << 13, 3: 1 << 14, 5: 1 << 15}
"""What can be taken away, by the version that made it known: run, write, read, make, remove, ...;
move to elsewhere; truncate; talk to devices."""
_NETWORK: Final = (4, 0b11)
"""Version and rights: to listen by TCP, to connect."""
_SCOPES: Final = (6, 0b11)
"""Version and bits: abstract sockets and signals stay within."""
_SYSTEM: Final = (
    *("/usr", "/lib", "/lib64", "/etc/ld.so.cache", "/etc/localtime", "/etc/mime.types"),
    *("/proc/cpuinfo", "/proc/meminfo", "/proc/stat", "/sys/devices/system/cpu"),
    *("/dev/null", "/dev/urandom"),
)
_NO_NEW_PRIVILEGES: Final = 38
_SOURCES: Final = Path(__file__).parents[2]


def python_folders() -> list[Path]:
    """Where what this Python has imported, and may yet import, comes from."""
    # In a source tree all kinds of things lie beside the package, such as data.
    installed = [entry for entry in sys.path if entry and Path(entry) != _SOURCES]
    libraries = os.environ.get("LD_LIBRARY_PATH", "").split(os.pathsep)
    folders = [sys.prefix, sys.base_prefix, sys.exec_prefix, *installed, *filter(None, libraries)]
    return [_SOURCES / "raysvc", *(Path(folder) for folder in (*folders, *_SYSTEM))]


def read_only(folders: Iterable[Path]) -> bool:
    """Let this thread, and those it starts, open nothing but files below these, and only to read.

    What is open stays as it is. Says whether the kernel can do so; False changes nothing.
    """
    if not sys.platform.startswith("linux"):
        return False
    libc = ctypes.CDLL(None, use_errno=True)
    version = libc.syscall(_CREATE, None, ctypes.c_size_t(0), _ASK_VERSION)
    if version < 1:
        return False
    rights = sum(bits for since, bits in _FILE_RIGHTS.items() if version >= since)
    taken = struct.pack("@Q", rights)
    for since, bits in (_NETWORK, _SCOPES):
        if version >= since:
            taken += struct.pack("@Q", bits)
    rules = libc.syscall(_CREATE, taken, ctypes.c_size_t(len(taken)), 0)
    if rules < 0:
        return False
    try:
        for folder in folders:
            with contextlib.suppress(OSError):  # not every system has all of them
                _add(libc, rules, folder)
        libc.prctl(_NO_NEW_PRIVILEGES, 1, 0, 0, 0)
        return bool(libc.syscall(_RESTRICT, rules, 0) == 0)
    finally:
        os.close(rules)


def _add(libc: ctypes.CDLL, rules: int, path: Path) -> None:
    allowed = _READ_FILE | (_READ_FOLDER if path.is_dir() else 0)
    place = os.open(path, os.O_PATH | os.O_CLOEXEC)
    try:
        libc.syscall(_ADD_RULE, rules, _PATH_BENEATH, struct.pack("=Qi", allowed, place), 0)
    finally:
        os.close(place)
