"""Reading uploads in processes of their own."""

import logging
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, Final, TypeVar

from raysvc.errors import (
    InvalidEnvironment,
    InvalidInput,
    InvalidScene,
    LimitExceeded,
    RaysvcError,
)
from raysvc.limits import DEFAULT_LIMITS, Limits
from raysvc.loading.picture_file import StoredPicture, read_depth, read_picture
from raysvc.loading.shape_file import NPY_MAGIC, ZIP_MAGIC, Shape, read_shape
from raysvc.parsing.launcher import Launcher, LauncherDied
from raysvc.parsing.message import BadMessage, Message
from raysvc.parsing.options import DEFAULT_OPTIONS, ParserOptions
from raysvc.parsing.parser_process import NeverStarted, ParserProcess, ProcessDied, TookTooLong
from raysvc.parsing.scene_message import (
    depth_from,
    environment_from,
    picture_from,
    scene_from,
    shape_from,
)
from raysvc.parsing.tasks import ERRORS, OUT_OF_MEMORY, question, read_environment, read_scene
from raysvc.scene import Environment, Scene
from raysvc.types import Floats

logger = logging.getLogger(__name__)

Heard = TypeVar("Heard")

ATTEMPTS: Final = 3
"""How often a process is started anew that ended before it was asked anything."""


class Parser:
    """A few processes that read files, each one at a time. Safe to use from many threads.

    Whatever a file does to its reader (crash it, fill its memory, keep it busy) becomes an error
    that is the caller's, and the next file has a new reader. Processes start when they are first
    needed, or with `start`; `close` ends them.
    """

    def __init__(
        self, options: ParserOptions = DEFAULT_OPTIONS, limits: Limits = DEFAULT_LIMITS
    ) -> None:
        self._options = options
        self._limits = limits
        self._launcher: Launcher | None = None
        self._idle: list[ParserProcess] = []
        self._count = 0
        """Of all processes, also those that read now."""
        self._closed = False
        self._changed = threading.Condition()

    def start(self) -> None:
        """Start all processes, in the background, so that the first upload need not wait."""
        if self._options.processes:
            with self._changed:
                self._launcher = self._launcher or Launcher(self._options, self._limits)
            threading.Thread(target=self._fill, name="raysvc-parser", daemon=True).start()

    def close(self) -> None:
        """End the processes that are idle now, and the others when they have done."""
        with self._changed:
            self._closed = True
            idle, self._idle = self._idle, []
            self._changed.notify_all()
        for process in idle:
            self._end(process)
        with self._changed:
            if not self._count:
                self._close_launcher()

    def scene(self, files: Mapping[str, bytes], main: str | None = None) -> Scene:
        """Read a scene: one file, several with side files, or a .zip of them.

        Raises InvalidScene, Unsupported, LimitExceeded.
        """
        if not self._options.processes:
            return read_scene(files, main, self._limits)
        return self._read(
            question("scene", files, main=main), scene_from, InvalidScene, _shown(files, main)
        )

    def shape(self, data: bytes | bytearray, vertices: int) -> Shape:
        """Read where the vertices of a scene are: .npy, .npz, or bare float32.

        Bare numbers need no reading, and are taken as they are. Raises InvalidScene, LimitExceeded.
        """
        if not self._options.processes or not data.startswith((NPY_MAGIC, ZIP_MAGIC)):
            return read_shape(data, vertices)
        asked = question("shape", {"positions": data}, vertices=vertices)
        return self._read(asked, lambda said: shape_from(said, vertices), InvalidScene, "positions")

    def environment(self, files: Mapping[str, bytes]) -> Environment:
        """Read an environment: one file. Raises InvalidEnvironment, Unsupported, LimitExceeded."""
        if not self._options.processes:
            return read_environment(files, self._limits)
        return self._read(
            question("environment", files),
            environment_from,
            InvalidEnvironment,
            _shown(files, None),
        )

    def picture(self, data: bytes, field: str = "picture") -> StoredPicture:
        """Read a picture. Raises InvalidInput, LimitExceeded."""
        if not self._options.processes:
            return read_picture(data, self._limits, field)
        return self._read(question("picture", {field: data}), picture_from, InvalidInput, field)

    def depth(self, data: bytes, depth_scale_m: float | None, field: str = "depth") -> Floats:
        """Read a picture's depth, (H, W) float32 metres. Raises InvalidInput, LimitExceeded."""
        if not self._options.processes:
            return read_depth(data, self._limits, depth_scale_m, field)
        asked = question("depth", {field: data}, depth_scale_m=depth_scale_m)
        return self._read(asked, depth_from, InvalidInput, field)

    def _read(
        self,
        asked: Message,
        hear: Callable[[Message], Heard],
        fault: type[InvalidInput],
        field: str,
    ) -> Heard:
        """Ask a process, and check what it says; `fault` is what a file is that breaks it."""
        options = self._options
        try:
            said = self._ask(asked)
            _raise_error(said, options)
            return hear(said)
        except TookTooLong:
            raise LimitExceeded(
                f"takes longer to read than {options.seconds:g} seconds (RAYSVC_PARSE_S), or "
                f"{options.cpu_seconds:g} of a processor (RAYSVC_PARSE_CPU_S)",
                field,
            ) from None
        except ProcessDied as death:
            raise fault(f"breaks what reads it ({death})", field) from None
        except BadMessage as error:
            raise fault(f"breaks what reads it (its answer {error})", field) from None

    def _ask(self, asked: Message) -> Message:
        for _ in range(ATTEMPTS):
            try:
                with self._process() as process:
                    return process.ask(asked)
            except NeverStarted as death:
                how = str(death)
        raise RaysvcError(f"the process that reads files does not start ({how})")

    @contextmanager
    def _process(self) -> Iterator[ParserProcess]:
        """Take a process for a while; one that broke, or is spent, is replaced."""
        process = self._take()
        broken = True
        try:
            yield process
            broken = process.is_spent
        finally:
            if broken or self._closed:
                self._end(process)
                self._fill()
            else:
                self._give_back(process)

    def _take(self) -> ParserProcess:
        with self._changed:
            while not self._idle:
                if self._closed:
                    raise RaysvcError("the service is shutting down")
                if self._count < self._options.processes:
                    self._count += 1
                    break
                self._changed.wait()
            else:
                # The one that was in use last, so that they are not all spent at the same time.
                last_first = reversed(self._idle)
                chosen = next((one for one in last_first if one.is_ready), self._idle[0])
                self._idle.remove(chosen)
                return chosen
        return self._launched()

    def _give_back(self, process: ParserProcess, last: bool = True) -> None:
        """Let others use a process, or end it once there are no others."""
        with self._changed:
            if not self._closed:
                self._idle.insert(len(self._idle) if last else 0, process)
                self._changed.notify()
                return
        self._end(process)

    def _fill(self) -> None:
        """Launch what is missing."""
        while True:
            with self._changed:
                if self._closed or self._count >= self._options.processes:
                    return
                self._count += 1
            try:
                process = self._launched()
            except (RaysvcError, OSError) as error:
                logger.error("%s", error)  # whoever needs one tries again, and hears it
                return
            self._give_back(process, last=False)

    def _launched(self) -> ParserProcess:
        """Launch a process that has been counted already; forgets it if that fails."""
        try:
            return self._process_of_a_launcher()
        except BaseException:
            with self._changed:
                self._count -= 1
                self._changed.notify()
            raise

    def _process_of_a_launcher(self) -> ParserProcess:
        how = ""
        for _ in range(ATTEMPTS):
            with self._changed:
                launcher = self._launcher = self._launcher or Launcher(self._options, self._limits)
            try:
                return ParserProcess(launcher, self._options)
            except LauncherDied as death:
                how = str(death)
            with self._changed:
                if self._launcher is launcher:
                    self._close_launcher()
        raise RaysvcError(f"the process that starts readers of files does not start ({how})")

    def _end(self, process: ParserProcess) -> None:
        process.close()
        with self._changed:
            self._count -= 1
            self._changed.notify()
            if self._closed and not self._count:
                self._close_launcher()

    def _close_launcher(self) -> None:
        if self._launcher is not None:
            self._launcher.close()
            self._launcher = None


def _raise_error(said: Message, options: ParserOptions) -> None:
    """Raise the error that an answer tells of, if it does."""
    if "error" not in said.fields:
        return
    error: Any = said.fields["error"]
    if not isinstance(error, dict):
        raise BadMessage("has an error without a name")
    kind, message, field = (error.get(key) for key in ("kind", "message", "field"))
    if field is not None and not isinstance(field, str):
        raise BadMessage("has an error about nothing")
    if kind == OUT_OF_MEMORY:
        raise LimitExceeded(
            f"needs more memory to be read than {options.memory_bytes >> 20:,} MiB "
            "(RAYSVC_PARSE_MEMORY_BYTES)",
            field or "file",
        )
    if not isinstance(kind, str) or kind not in ERRORS or not isinstance(message, str):
        raise BadMessage("has an unknown error")
    raise ERRORS[kind](message[:1000], field)


def _shown(files: Mapping[str, bytes], main: str | None) -> str:
    """What an error names where nothing is known of the inside of files."""
    if main is not None:
        return main[:120]
    return next(iter(files))[:120] if len(files) == 1 else "file"
