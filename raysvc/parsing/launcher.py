"""Starting processes that read files, quickly and without stopping the service.

A process takes a second to import what it needs, and to fork the service would copy its threads'
locks and hold up all of them. So one process with one thread imports everything (`launching`), and
forks the others when it is asked to: they start in milliseconds, and share their memory.
"""

import array
import dataclasses
import json
import os
import signal
import socket
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any, Final

from raysvc.limits import Limits
from raysvc.parsing.options import ParserOptions

STARTING_S: Final = 60.0
"""Time for imports, on a machine that is busy."""
NICENESS: Final = 3
"""Answering requests comes first."""
LONGEST_REPLY: Final = 1_000

_MAIN: Final = "raysvc.parsing.launching"
_START: Final = f"import os; os.nice({NICENESS}); from {_MAIN} import main; main()"
_SOURCES: Final = Path(__file__).parents[2]
_ONE_THREAD: Final = dict.fromkeys(
    ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1"
)
"""A process with threads cannot be forked safely, and one is enough for a file."""
_PASSED_ON: Final = (
    *("PATH", "LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH", "HOME", "TMPDIR", "LANG", "LANGUAGE", "TZ"),
    *("XDG_CACHE_HOME", "RAYSVC_CACHE", "NUMBA_CACHE_DIR"),
)
"""Where programs, libraries and compiled kernels are, and the language. What else the service was
told, such as passwords for other things, is nobody's business who reads files of strangers."""


class LauncherDied(Exception):
    """The launching process ended, or never started; another can be started."""


class Launcher:
    """The process that forks others, as the service sees it. Safe to use from many threads."""

    def __init__(self, options: ParserOptions, limits: Limits) -> None:
        paths = (str(_SOURCES), os.environ.get("PYTHONPATH", ""))
        self._socket, theirs = socket.socketpair()
        self._socket.settimeout(STARTING_S)
        self._lock = threading.Lock()
        with theirs:
            self._process = subprocess.Popen(
                [
                    *(sys.executable, "-P", "-c", _START, str(theirs.fileno())),
                    json.dumps(dataclasses.asdict(options)),
                    json.dumps(dataclasses.asdict(limits)),
                ],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                env={**_passed_on(), "PYTHONPATH": os.pathsep.join(filter(None, paths))},
                pass_fds=(theirs.fileno(),),
                start_new_session=True,
            )

    @property
    def id(self) -> int:
        """The kernel's number of the process."""
        return self._process.pid

    def launch(self, files: tuple[int, int, int]) -> int:
        """Fork a process that reads files, and return its number.

        Parameters
        ----------
        files
            descriptors: where messages go both ways, where it hears, and where it speaks

        Raises
        ------
        LauncherDied
        """
        return int(self._exchange({"launch": True}, files))

    def reap(self, id: int) -> int:
        """Kill a process that was launched here, and return how it ended: its exit code, or minus
        the number of the signal that ended it, perhaps earlier. Raises LauncherDied."""
        return int(self._exchange({"reap": id}))

    def close(self) -> None:
        """End the process; what it has launched ends when it is no longer spoken to."""
        self._socket.close()
        self._process.kill()
        self._process.wait()

    def _exchange(self, command: dict[str, Any], files: tuple[int, ...] = ()) -> Any:
        with self._lock:
            try:
                data = json.dumps(command).encode()
                if files:
                    rights = array.array("i", files)
                    ancillary = [(socket.SOL_SOCKET, socket.SCM_RIGHTS, rights)]
                    self._socket.sendmsg([data], ancillary)
                else:
                    self._socket.sendall(data)
                reply = self._socket.recv(LONGEST_REPLY)
            except OSError as error:
                raise LauncherDied(self._how_it_ended() or str(error)) from None
        if not reply:
            raise LauncherDied(self._how_it_ended() or "it hung up")
        return json.loads(reply)

    def _how_it_ended(self) -> str | None:
        try:
            code = self._process.wait(1.0)
        except subprocess.TimeoutExpired:
            return None
        return signal.Signals(-code).name if code < 0 else f"exit code {code}"


def _passed_on() -> dict[str, str]:
    """The environment of what reads files."""
    told = os.environ.items()
    kept = {name: value for name, value in told if name in _PASSED_ON or name.startswith("LC_")}
    return kept | _ONE_THREAD
