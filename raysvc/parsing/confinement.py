"""What a process that reads hostile files gives up before it reads the first of them.

Limits of the kernel on memory, processor time and the size of files hold for whatever code runs in
the process. So do, on Linux, the filter of system calls (`system_calls`) and the rules about files
(`readable_folders`): no network, no other program, no harm to another process, no file that is
opened for writing, changed or removed, and no look at the service's data.
"""

import contextlib
import os
import sys
from typing import Final

from raysvc.parsing.capabilities import give_up_capabilities
from raysvc.parsing.readable_folders import python_folders, read_only
from raysvc.parsing.system_calls import give_up_calls

if sys.platform != "win32":
    import resource

OPEN_FILES: Final = 64


def confine(memory_bytes: int, file_bytes: int) -> bool:
    """Give up rights for good; says whether the kernel also filters what the process calls.

    Where it does, files can only be read from then on, and where it knows Landlock only those of
    Python and the system; what is open for writing stays so. Call it while there is one thread.

    Parameters
    ----------
    memory_bytes
        address space that may be asked for over what is in use now
    file_bytes
        largest size that a file may be made, of those that are open
    """
    if sys.platform == "win32":
        return False
    in_use = _address_space_bytes()
    for limit, value in (
        (resource.RLIMIT_CORE, 0),
        (resource.RLIMIT_NOFILE, OPEN_FILES),
        (resource.RLIMIT_FSIZE, file_bytes),
        (resource.RLIMIT_AS, in_use + memory_bytes),
    ):
        _, most = resource.getrlimit(limit)
        if most != resource.RLIM_INFINITY:
            value = min(value, most)
        with contextlib.suppress(ValueError, OSError):  # macOS knows RLIMIT_AS, and refuses it
            resource.setrlimit(limit, (value, value))
    read_only(python_folders())
    give_up_capabilities()
    return give_up_calls()


def allow_cpu(seconds: float) -> None:
    """Let the process use so much more processor time, after which the kernel ends it."""
    if sys.platform != "win32":
        used = resource.getrusage(resource.RUSAGE_SELF)
        end = int(used.ru_utime + used.ru_stime + seconds) + 1
        _, most = resource.getrlimit(resource.RLIMIT_CPU)
        resource.setrlimit(resource.RLIMIT_CPU, (end, most))


def _address_space_bytes() -> int:
    try:
        with open("/proc/self/statm", encoding="ascii") as file:
            return int(file.read().split()[0]) * os.sysconf("SC_PAGE_SIZE")
    except (OSError, ValueError):
        return 1 << 30
