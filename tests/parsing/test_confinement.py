"""What a confined process cannot do, tried in one."""

import platform
import subprocess
import sys
from pathlib import Path

import pytest

LINUX = sys.platform.startswith("linux") and platform.machine() in ("x86_64", "aarch64")
pytestmark = pytest.mark.skipif(not LINUX, reason="rlimits and seccomp of Linux")


def outcome(
    folder: Path, tried: str, memory_bytes: int = 64 << 20, file_bytes: int = 1 << 20
) -> str:
    """What becomes of some code: `done`, the exception's name, or the signal's number."""
    code = f"""
import ctypes, os, socket, sys, tempfile, threading
from raysvc.parsing.confinement import allow_cpu, confine
print(confine({memory_bytes}, {file_bytes}), end=" ", flush=True)
try:
    {tried}
    print("done")
except BaseException as error:
    print(type(error).__name__)
"""
    found = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, cwd=folder, check=False
    )
    filtered, _, said = found.stdout.strip().partition(" ")
    assert filtered == "True", found.stderr
    return said or str(found.returncode)


@pytest.mark.parametrize(
    ("tried", "expected"),
    [
        ("pass", "done"),
        ("bytearray(16 << 20)", "done"),
        ("bytearray(128 << 20)", "MemoryError"),
        ("tempfile.TemporaryFile().write(b'x' * 100_000)", "done"),
        ("f = open('large', 'wb', 0)\n    while f.write(bytes(500_000)): pass", "OSError"),
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
    # The superuser may raise limits; nobody else can.
    assert outcome(tmp_path, raised) in ("ValueError", "done")
    tried = "confine(1 << 40, 1 << 30); socket.socket()"
    assert outcome(tmp_path, tried) == "PermissionError"
