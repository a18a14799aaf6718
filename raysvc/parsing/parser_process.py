"""One process that reads files, as the service sees it."""

import contextlib
import dataclasses
import json
import logging
import os
import select
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Final

from raysvc.limits import Limits
from raysvc.parsing.message import Message, read_message, write_message
from raysvc.parsing.options import ParserOptions
from raysvc.parsing.signs import ASK, DONE, READY, READY_UNFILTERED

logger = logging.getLogger(__name__)

STARTING_S: Final = 60.0
"""Time to start: imports, on a machine that is busy."""
GROWTH_BYTES: Final = 128 << 20
"""By how much a process may have grown and still be used again."""

_OUT_OF_TIME: Final = ("SIGXCPU",)
_CHILD: Final = "raysvc.parsing.child"
NICENESS: Final = 3
"""Answering requests comes first, also while a process starts."""
_START: Final = f"import os; os.nice({NICENESS}); from {_CHILD} import main; main()"
_SOURCES: Final = Path(__file__).parents[2]
_ONE_THREAD: Final = dict.fromkeys(
    ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1"
)
"""Threads that wait in a library take address space, and one is enough for a file."""


class ProcessDied(Exception):
    """The process ended over a question; says how."""


class TookTooLong(ProcessDied):
    """It was ended, or the kernel ended it, because it used up its time."""


class NeverStarted(ProcessDied):
    """It ended before it was asked anything."""


class ParserProcess:
    """Starts at once, and gets ready in its own time. Used by one thread at a time."""

    def __init__(self, options: ParserOptions, limits: Limits) -> None:
        self._options = options
        self._file = _anonymous_file()
        self._folder = tempfile.mkdtemp(prefix="raysvc-parser-")
        paths = (str(_SOURCES), os.environ.get("PYTHONPATH", ""))
        self._process = subprocess.Popen(
            [
                *(sys.executable, "-P", "-c", _START, str(self._file)),
                json.dumps(dataclasses.asdict(options)),
                json.dumps(dataclasses.asdict(limits)),
            ],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={
                **os.environ,
                **_ONE_THREAD,
                "TMPDIR": self._folder,
                "PYTHONPATH": os.pathsep.join(filter(None, paths)),
            },
            pass_fds=(self._file,),
            start_new_session=True,
        )
        assert self._process.stdin is not None and self._process.stdout is not None
        self._stdin, self._stdout = self._process.stdin, self._process.stdout
        self._poll = select.poll()
        self._poll.register(self._stdout, select.POLLIN)
        self._ready = False
        self._uploads = 0
        self._bytes_at_first = 0

    @property
    def id(self) -> int:
        """The kernel's number of the process."""
        return self._process.pid

    @property
    def is_ready(self) -> bool:
        """Would a question be looked at immediately? Does not wait."""
        if not self._ready and self._poll.poll(0):
            self._take_ready(0.0)
        return self._ready

    @property
    def is_spent(self) -> bool:
        """Has it read as many uploads, or kept as much memory, as one process may?"""
        grown = self._resident_bytes() - self._bytes_at_first
        return self._uploads >= self._options.uploads or grown > GROWTH_BYTES

    def ask(self, question: Message) -> Message:
        """Ask, wait and copy the answer out; it is not checked but for its form.

        Raises BadMessage, or ProcessDied, after which the process is of no more use.
        """
        self.wait_until_ready()
        self._uploads += 1
        write_message(self._file, question)
        try:
            os.write(self._stdin.fileno(), ASK)
        except BrokenPipeError:
            raise NeverStarted(self._how_it_ended()) from None
        said = self._hear(self._options.seconds)
        if said != DONE:
            how = self._how_it_ended()
            late = said is None or how in _OUT_OF_TIME
            raise TookTooLong(how) if late else ProcessDied(how)
        try:
            return read_message(self._file, self._options.memory_bytes)
        finally:
            os.ftruncate(self._file, 0)

    def wait_until_ready(self) -> None:
        """Wait for the imports. Raises NeverStarted."""
        if not self._ready:
            self._take_ready(STARTING_S)
            if not self._ready:
                raise NeverStarted(self._how_it_ended())

    def close(self) -> None:
        """End the process, and all that it may have started, and remove what it left."""
        if self._file < 0:
            return
        self._kill()
        for pipe in (self._stdin, self._stdout):
            pipe.close()
        os.close(self._file)
        self._file = -1
        shutil.rmtree(self._folder, ignore_errors=True)

    def _take_ready(self, seconds: float) -> None:
        said = self._hear(seconds)
        if said == READY_UNFILTERED:
            logger.warning("this system cannot keep the readers of uploads from the network")
        self._ready = said in (READY, READY_UNFILTERED)
        self._bytes_at_first = self._resident_bytes()

    def _hear(self, seconds: float) -> bytes | None:
        """What it says, b"" if it has died, None if it says nothing in so many seconds."""
        if not self._poll.poll(seconds * 1000):
            return None
        return os.read(self._stdout.fileno(), 1)

    def _how_it_ended(self) -> str:
        """Make sure that it has ended, and say how."""
        code = self._kill()
        if code < 0:
            return signal.Signals(-code).name
        return f"exit code {code}"

    def _kill(self) -> int:
        """End the process and its session; returns how it ended, perhaps earlier."""
        try:
            # It may have been ending by itself when it fell silent.
            self._process.wait(0.02)
        except subprocess.TimeoutExpired:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(self._process.pid, signal.SIGKILL)
        return self._process.wait()

    def _resident_bytes(self) -> int:
        try:
            pages = Path(f"/proc/{self._process.pid}/statm").read_text(encoding="ascii").split()[1]
        except (OSError, IndexError):
            return 0
        return int(pages) * os.sysconf("SC_PAGE_SIZE")


def _anonymous_file() -> int:
    """A file without a name, in memory where the system can: nothing of it outlives its users."""
    if hasattr(os, "memfd_create"):
        return os.memfd_create("raysvc-message")
    with tempfile.TemporaryFile(prefix="raysvc-message-") as file:
        return os.dup(file.fileno())
