"""One process that reads files, as the service sees it."""

import contextlib
import logging
import os
import select
import signal
import tempfile
from pathlib import Path
from typing import Final

from raysvc.parsing.launcher import STARTING_S, Launcher, LauncherDied
from raysvc.parsing.message import Message, read_message, write_message
from raysvc.parsing.options import ParserOptions
from raysvc.parsing.signs import ASK, DONE, READY, READY_UNFILTERED

logger = logging.getLogger(__name__)

GROWTH_BYTES: Final = 128 << 20
"""By how much a process may have grown and still be used again."""


class ProcessDied(Exception):
    """The process ended over a question; says how."""


class TookTooLong(ProcessDied):
    """It was ended, or the kernel ended it, because it used up its time."""


class NeverStarted(ProcessDied):
    """It ended before it was asked anything."""


class ParserProcess:
    """Gets ready in its own time. Used by one thread at a time. Raises LauncherDied."""

    def __init__(self, launcher: Launcher, options: ParserOptions) -> None:
        self._launcher, self._options = launcher, options
        with contextlib.ExitStack() as passed_on, contextlib.ExitStack() as ours:
            self._file = _anonymous_file()
            ours.callback(os.close, self._file)
            hears, self._says = os.pipe()
            passed_on.callback(os.close, hears)
            ours.callback(os.close, self._says)
            self._hears, says = os.pipe()
            passed_on.callback(os.close, says)
            ours.callback(os.close, self._hears)
            self.id = launcher.launch((self._file, hears, says))
            self._ours = ours.pop_all()  # until it is closed
        self._poll = select.poll()
        self._poll.register(self._hears, select.POLLIN)
        self._ready = False
        self._uploads = 0
        self._bytes_at_first = 0
        self._ended: str | None = None

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
            os.write(self._says, ASK)
        except BrokenPipeError:
            raise NeverStarted(self._how_it_ended()) from None
        said = self._hear(self._options.seconds)
        if said != DONE:
            how = self._how_it_ended()
            late = said is None or how == signal.SIGXCPU.name
            raise TookTooLong(how) if late else ProcessDied(how)
        try:
            return read_message(self._file, self._options.memory_bytes)
        finally:
            os.ftruncate(self._file, 0)

    def wait_until_ready(self) -> None:
        """Wait for the start. Raises NeverStarted."""
        if not self._ready:
            self._take_ready(STARTING_S)
            if not self._ready:
                raise NeverStarted(self._how_it_ended())

    def close(self) -> None:
        """End the process, and all that it may have started."""
        self._how_it_ended()
        self._ours.close()

    def _take_ready(self, seconds: float) -> None:
        said = self._hear(seconds)
        if said == READY_UNFILTERED:
            logger.warning(
                "this system cannot keep the readers of uploads from files and the network"
            )
        self._ready = said in (READY, READY_UNFILTERED)
        self._bytes_at_first = self._resident_bytes()

    def _hear(self, seconds: float) -> bytes | None:
        """What it says, b"" if it has died, None if it says nothing in so many seconds."""
        if not self._poll.poll(seconds * 1000):
            return None
        return os.read(self._hears, 1)

    def _how_it_ended(self) -> str:
        """Make sure that it has ended, and say how."""
        if self._ended is None:
            self._ended = self._end()
        return self._ended

    def _end(self) -> str:
        try:
            code = self._launcher.reap(self.id)
        except LauncherDied:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(self.id, signal.SIGKILL)
            return "its parent died"
        return signal.Signals(-code).name if code < 0 else f"exit code {code}"

    def _resident_bytes(self) -> int:
        try:
            pages = Path(f"/proc/{self.id}/statm").read_text(encoding="ascii").split()[1]
        except (OSError, IndexError):
            return 0
        return int(pages) * os.sysconf("SC_PAGE_SIZE")


def _anonymous_file() -> int:
    """A file without a name, in memory where the system can: nothing of it outlives its users."""
    if hasattr(os, "memfd_create"):
        return os.memfd_create("raysvc-message")
    with tempfile.TemporaryFile(prefix="raysvc-message-") as file:
        return os.dup(file.fileno())
