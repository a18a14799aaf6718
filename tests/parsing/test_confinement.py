"""What a confined process cannot do, tried in one."""

import errno
import os
import platform
import subprocess
import sys
from pathlib import Path

import pytest

LINUX = sys.platform.startswith("linux") and platform.machine() in ("x86_64", "aarch64")
pytestmark = pytest.mark.skipif(not LINUX, reason="rlimits and seccomp of Linux")


def outcome(
    folder: Path,
    tried: str,
    memory_bytes: int = 64 << 20,
    file_bytes: int = 1 << 20,
    before: str = "",
) -> str:
    """What becomes of some code: `done`, the exception's name, or the signal's number."""
    return outcomes(folder, [tried], memory_bytes, file_bytes, before)[-1]


def outcomes(
    folder: Path,
    tries: list[str],
    memory_bytes: int = 64 << 20,
    file_bytes: int = 1 << 20,
    before: str = "",
) -> list[str]:
    """What becomes of each of some pieces of code, one after the other in one process."""
    (folder / "there").write_text("as it was")
    attempts = "".join(
        f"""
try:
    {tried}
    print("done")
except BaseException as error:
    print(type(error).__name__)
"""
        for tried in tries
    )
    code = f"""
import ctypes, fcntl, os, resource, signal, socket, sys, threading
from raysvc.parsing.confinement import allow_cpu, confine
from raysvc.parsing import readable_folders
kept = os.memfd_create("kept")
there = os.open("there", os.O_RDONLY)
libc = ctypes.CDLL(None, use_errno=True)
def call(number, *arguments):
    if libc.syscall(number, *arguments) < 0:
        raise OSError(ctypes.get_errno(), "")
{before}
print(confine({memory_bytes}, {file_bytes}), flush=True)
{attempts}
"""
    found = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, cwd=folder, check=False
    )
    filtered, *said = found.stdout.splitlines()
    assert filtered == "True", found.stderr
    return said or [str(found.returncode)]


@pytest.mark.parametrize(
    ("tried", "expected"),
    [
        ("pass", "done"),
        ("bytearray(16 << 20)", "done"),
        ("bytearray(128 << 20)", "MemoryError"),
        ("os.write(kept, b'x' * 100_000)", "done"),
        ("while os.write(kept, bytes(500_000)): pass", "OSError"),
        ("open(os.__file__).read()", "done"),
        ("thread = threading.Thread(target=print); thread.start(); thread.join()", "done"),
        ("socket.socket()", "PermissionError"),
        ("socket.socketpair()", "PermissionError"),
        ("os.execv(sys.executable, [sys.executable])", "PermissionError"),
        ("os.kill(os.getppid(), 0)", "PermissionError"),
        ("[os.open('/dev/null', 0) for _ in range(200)]", "OSError"),
        ("allow_cpu(0.5)\n    while True: pass", "-24"),
    ],
)
def test_what_a_confined_process_can_do(tmp_path: Path, tried: str, expected: str) -> None:
    assert outcome(tmp_path, tried).splitlines()[-1] == expected


def test_rights_are_gone_for_good(tmp_path: Path) -> None:
    raised = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 30, 1 << 30))"
    assert outcome(tmp_path, raised) == "ValueError"  # also for the superuser
    tried = "confine(1 << 40, 1 << 30); socket.socket()"
    assert outcome(tmp_path, tried) == "PermissionError"


ONLY_CALLS = "import raysvc.parsing.confinement as c; c.read_only = lambda folders: False"
"""As on a kernel without Landlock."""


CHANGES = [
    "open('there', 'w')",
    "open('there', 'r+')",
    "open('there', 'a')",
    "open('new', 'x')",
    "os.open('there', os.O_RDONLY | os.O_TRUNC)",
    "os.open('.', os.O_TMPFILE | os.O_RDWR)",
    "os.rename('there', 'elsewhere')",
    "os.replace('there', 'elsewhere')",
    "os.unlink('there')",
    "os.link('there', 'elsewhere')",
    "os.symlink('there', 'elsewhere')",
    "os.truncate('there', 0)",
    "os.chmod('there', 0o777)",
    "os.fchmod(there, 0o777)",
    "os.chown('there', os.getuid(), os.getgid())",
    "os.utime('there')",
    "os.setxattr('there', 'user.x', b'x')",
    "os.mkdir('folder')",
    "os.rmdir('.')",
    "os.mkfifo('pipe')",
    "os.memfd_create('more')",
    "fcntl.flock(there, fcntl.LOCK_EX)",
    "fcntl.lockf(there, fcntl.LOCK_SH)",
    "open(f'/proc/{os.getppid()}/oom_score_adj', 'w')",
]


@pytest.mark.parametrize("before", ["", ONLY_CALLS], ids=["all", "filter alone"])
def test_files_are_left_as_they_are(tmp_path: Path, before: str) -> None:
    found = dict(zip(CHANGES, outcomes(tmp_path, CHANGES, before=before), strict=True))
    assert found == dict.fromkeys(CHANGES, "PermissionError")
    assert [path.name for path in tmp_path.iterdir()] == ["there"]
    assert (tmp_path / "there").read_text() == "as it was"


ATTACKS = [
    "signal.pidfd_send_signal(there, 0)",
    "call(129, os.getppid(), 9, bytes(128))",  # rt_sigqueueinfo
    "call(297, os.getppid(), os.getppid(), 9, bytes(128))",  # rt_tgsigqueueinfo
    "fcntl.fcntl(there, fcntl.F_SETOWN, os.getppid())",
    "fcntl.fcntl(there, 10, 9)",  # F_SETSIG
    "fcntl.ioctl(there, 0x8901, bytes(4))",  # FIOSETOWN
    "resource.prlimit(os.getppid(), resource.RLIMIT_NOFILE, (1, 1))",
    "os.sched_setaffinity(os.getppid(), {0})",
    "os.setpriority(os.PRIO_PROCESS, os.getppid(), 19)",
    "os.fork()",
    "call(56, 17, 0, 0, 0, 0)",  # clone with SIGCHLD
    "call(57)",  # fork
    "call(85, b'new', 0o600)",  # creat
    "call(2, b'there', os.O_WRONLY)",  # open
    "call(257 | 0x40000000, -100, b'there', os.O_WRONLY)",  # openat of x32
]


@pytest.mark.skipif(platform.machine() != "x86_64", reason="numbers of calls")
@pytest.mark.parametrize("before", ["", ONLY_CALLS], ids=["all", "filter alone"])
def test_other_processes_are_left_alone(tmp_path: Path, before: str) -> None:
    found = dict(zip(ATTACKS, outcomes(tmp_path, ATTACKS, before=before), strict=True))
    assert found == dict.fromkeys(ATTACKS, "PermissionError")


@pytest.mark.skipif(platform.machine() != "x86_64", reason="numbers of calls")
def test_calls_that_cannot_be_looked_into_are_as_if_they_were_not(tmp_path: Path) -> None:
    # openat2 and clone3; libraries fall back on the older calls.
    tries = [f"call({number}, -100, b'there', bytes(24), 24)" for number in (437, 435)]
    absent = [f"try: {tried}\n    except OSError as e: print(e.errno)" for tried in tries]
    assert outcomes(tmp_path, absent) == [str(errno.ENOSYS), "done"] * 2


def test_no_data_is_read_where_the_kernel_knows_landlock(tmp_path: Path) -> None:
    code = "from raysvc.parsing.readable_folders import read_only; print(read_only([]))"
    asked = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    if asked.stdout.strip() != "True":
        pytest.skip("no Landlock here")
    other = f"/proc/{os.getpid()}"
    closed = ("there", ".", "/etc/passwd", f"{other}/environ", f"{other}/mem", f"{other}/maps")
    tries = [f"os.open({path!r}, os.O_RDONLY)" for path in closed]
    assert outcomes(tmp_path, tries) == ["PermissionError"] * len(closed)
    allowed = ["os.read(there, 2)", "import wave, colorsys", "open(f'/proc/self/fd/{kept}', 'rb')"]
    assert outcomes(tmp_path, allowed) == ["done"] * 3
