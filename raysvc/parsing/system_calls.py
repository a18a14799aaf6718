"""Which system calls a process gives up (seccomp, Linux), before it reads what strangers sent.

What is not named here stays allowed: memory, threads, reading files, and writing to those that are
open. Whoever takes over such a process can so neither open a file for writing nor change or remove
one, nor reach another process or the network.
"""

import ctypes
import platform
import struct
import sys
from typing import Final, NamedTuple

DENIED: Final = {
    # The network.
    "socket": (41, 198),
    "socketpair": (53, 199),
    "connect": (42, 203),
    "bind": (49, 200),
    "listen": (50, 201),
    "accept": (43, 202),
    "accept4": (288, 242),
    "sendto": (44, 206),
    "sendmsg": (46, 211),
    # Other programs, and a life of its own.
    "execve": (59, 221),
    "execveat": (322, 281),
    "fork": (57, None),
    "vfork": (58, None),
    "setsid": (112, 157),
    "setpgid": (109, 154),
    # Other processes: signals, their memory, their files, their share of the machine.
    "kill": (62, 129),
    "tkill": (200, 130),
    "tgkill": (234, 131),
    "rt_sigqueueinfo": (129, 138),
    "rt_tgsigqueueinfo": (297, 240),
    "pidfd_open": (434, 434),
    "pidfd_getfd": (438, 438),
    "pidfd_send_signal": (424, 424),
    "ptrace": (101, 117),
    "process_vm_readv": (310, 270),
    "process_vm_writev": (311, 271),
    "process_madvise": (440, 440),
    "process_mrelease": (448, 448),
    "move_pages": (279, 239),
    "migrate_pages": (256, 238),
    "setpriority": (141, 140),
    "ioprio_set": (251, 30),
    "sched_setaffinity": (203, 122),
    "sched_setscheduler": (144, 119),
    "sched_setparam": (142, 118),
    "sched_setattr": (314, 274),
    # Files: to make, rename, remove, cut, lock, and to change what is known of them.
    "creat": (85, None),
    "rename": (82, None),
    "renameat": (264, 38),
    "renameat2": (316, 276),
    "unlink": (87, None),
    "unlinkat": (263, 35),
    "rmdir": (84, None),
    "link": (86, None),
    "linkat": (265, 37),
    "symlink": (88, None),
    "symlinkat": (266, 36),
    "mkdir": (83, None),
    "mkdirat": (258, 34),
    "mknod": (133, None),
    "mknodat": (259, 33),
    "truncate": (76, 45),
    "chmod": (90, None),
    "fchmod": (91, 52),
    "fchmodat": (268, 53),
    "fchmodat2": (452, 452),
    "chown": (92, None),
    "lchown": (94, None),
    "fchown": (93, 55),
    "fchownat": (260, 54),
    "utime": (132, None),
    "utimes": (235, None),
    "futimesat": (261, None),
    "utimensat": (280, 88),
    "setxattr": (188, 5),
    "lsetxattr": (189, 6),
    "fsetxattr": (190, 7),
    "setxattrat": (463, 463),
    "removexattr": (197, 14),
    "lremovexattr": (198, 15),
    "fremovexattr": (199, 16),
    "removexattrat": (466, 466),
    "file_setattr": (469, 469),
    "flock": (73, 32),
    "open_by_handle_at": (304, 265),
    # Memory that no limit counts, or that outlives the process.
    "memfd_create": (319, 279),
    "memfd_secret": (447, 447),
    "shmget": (29, 194),
    "msgget": (68, 186),
    "semget": (64, 190),
    "mq_open": (240, 180),
    "mq_unlink": (241, 181),
    # The machine, and ways around all of this.
    "io_uring_setup": (425, 425),
    "bpf": (321, 280),
    "userfaultfd": (323, 282),
    "perf_event_open": (298, 241),
    "keyctl": (250, 219),
    "add_key": (248, 217),
    "request_key": (249, 218),
    "chroot": (161, 51),
    "pivot_root": (155, 41),
    "mount": (165, 40),
    "umount2": (166, 39),
    "move_mount": (429, 429),
    "open_tree": (428, 428),
    "fsopen": (430, 430),
    "mount_setattr": (442, 442),
    "unshare": (272, 97),
    "setns": (308, 268),
}
"""System calls that no reader of a file needs, with their numbers on each of _MACHINES
(asm/unistd_64.h, asm-generic/unistd.h); None where there is no such call."""

ABSENT: Final = {"clone3": (435, 435), "openat2": (437, 437)}
"""Calls whose arguments lie in memory, where a filter cannot look: answered as if the kernel did
not know them, upon which libraries take the older ones (CHECKED)."""


class Check(NamedTuple):
    """When a call is allowed: if the bits of an argument that are in `mask` are in `values`."""

    numbers: tuple[int | None, int | None]
    argument: int
    mask: int
    values: tuple[int, ...]


_WRITING: Final = 0o1 | 0o2 | 0o100 | 0o1000  # O_WRONLY, O_RDWR, O_CREAT, O_TRUNC
_THREAD: Final = 0x10000  # CLONE_THREAD (linux/sched.h)
_ALL: Final = 0xFFFFFFFF
_FCNTL: Final = (0, 1, 2, 3, 1030, 1034)  # DUPFD, GETFD, SETFD, GETFL, DUPFD_CLOEXEC, GET_SEALS
_IOCTL: Final = (0x5401, 0x5413, 0x541B, 0x5450, 0x5451)  # TCGETS, TIOCGWINSZ, FIONREAD, FIO(N)CLEX

CHECKED: Final = {
    "open": Check((2, None), 1, _WRITING, (0,)),
    "openat": Check((257, 56), 2, _WRITING, (0,)),
    "clone": Check((56, 220), 0, _THREAD, (_THREAD,)),
    # Of other processes; 0 is the one that asks.
    "prlimit64": Check((302, 261), 0, _ALL, (0,)),
    # By others of their commands files are locked, and signals sent (F_SETOWN, F_SETSIG).
    "fcntl": Check((72, 25), 1, _ALL, _FCNTL),
    "ioctl": Check((16, 29), 1, _ALL, _IOCTL),
}
"""Calls that are allowed for some values of an argument."""

_MACHINES: Final = {"x86_64": (0, 0xC000003E), "aarch64": (1, 0xC00000B7)}
"""By name: its column in the tables, and what the kernel calls it (linux/audit.h)."""

Instruction = tuple[int, int, int, int]
"""Operation, instructions to skip if a test holds, or if it does not, and an operand."""

_NO_NEW_PRIVILEGES, _SET_SECCOMP, _FILTER = 38, 22, 2  # linux/prctl.h, linux/seccomp.h
_LOAD, _EQUAL, _AT_LEAST, _AND, _RETURN = 0x20, 0x15, 0x35, 0x54, 0x06  # linux/bpf_common.h
_ALLOW, _DENY, _LACK, _KILL = 0x7FFF0000, 0x00050001, 0x00050026, 0x80000000  # EPERM, ENOSYS
_NUMBER_AT, _ARCHITECTURE_AT, _ARGUMENTS_AT = 0, 4, 16  # in struct seccomp_data
_X32: Final = 0x40000000
"""Calls from here on are x86-64's second set of the same."""


def give_up_calls() -> bool:
    """Refuse the above in this thread and those it starts, for good; False where that cannot be."""
    known = _MACHINES.get(platform.machine())
    if not sys.platform.startswith("linux") or known is None:
        return False
    program = _program(*known)
    code = b"".join(struct.pack("=HBBI", *instruction) for instruction in program)
    memory = ctypes.create_string_buffer(code)
    filter = struct.pack("@HP", len(program), ctypes.addressof(memory))
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.prctl(_NO_NEW_PRIVILEGES, 1, 0, 0, 0) != 0:
        return False
    return bool(libc.prctl(_SET_SECCOMP, _FILTER, filter, 0, 0) == 0)


def _program(column: int, architecture: int) -> list[Instruction]:
    program = [
        (_LOAD, 0, 0, _ARCHITECTURE_AT),
        (_EQUAL, 1, 0, architecture),
        (_RETURN, 0, 0, _KILL),
        (_LOAD, 0, 0, _NUMBER_AT),
        (_AT_LEAST, 0, 1, _X32),
        (_RETURN, 0, 0, _DENY),
    ]
    for calls, answer in ((DENIED, _DENY), (ABSENT, _LACK)):
        for numbers in calls.values():
            program += _if_called(numbers[column], [(_RETURN, 0, 0, answer)])
    for check in CHECKED.values():
        # The low half of an argument, which is all that these calls look at.
        looked = [
            (_LOAD, 0, 0, _ARGUMENTS_AT + 8 * check.argument),
            (_AND, 0, 0, check.mask),
            *((_EQUAL, len(check.values) - i, 0, v) for i, v in enumerate(check.values)),
            (_RETURN, 0, 0, _DENY),
            (_RETURN, 0, 0, _ALLOW),
        ]
        program += _if_called(check.numbers[column], looked)
    return [*program, (_RETURN, 0, 0, _ALLOW)]


def _if_called(number: int | None, then: list[Instruction]) -> list[Instruction]:
    """Instructions for one call; they end in an answer, so that others never see its argument."""
    return [] if number is None else [(_EQUAL, 0, len(then), number), *then]
