"""`raysvc serve` as a process of its own, for the commands that need a service."""

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Final, NamedTuple

from raysvc.errors import RaysvcError

ANNOUNCEMENT: Final = "raysvc is at "
"""What it says once it listens; its address follows."""
LOG: Final = "log.txt"
LOOK_EVERY_S: Final = 0.01
SHOWN_OF_LOG: Final = 2_000
"""Characters that are shown of what it said before it ended."""


class RunningService(NamedTuple):
    """One that listens."""

    url: str
    process: subprocess.Popen[bytes]
    log: Path
    """What it has said, and says."""

    def wait_until(self, answered: Callable[[], bool], seconds: float) -> None:
        """Wait for an answer. Raises RaysvcError if the process ends, or time does."""
        end = time.monotonic() + seconds
        while self.process.poll() is None:
            if answered():
                return
            if time.monotonic() > end:
                raise RaysvcError(f"the service was not ready within {seconds:.0f} s")
            time.sleep(LOOK_EVERY_S)
        raise _not_started(self.log)


@contextmanager
def running_service(
    data_dir: Path, settings: Mapping[str, str] | None = None, *, drain: bool = True
) -> Iterator[RunningService]:
    """Start a service on a free port of this machine, and end it.

    Parameters
    ----------
    data_dir
        its folder, and for its log
    settings
        environment variables, over those that there are
    drain
        let it end what it has begun; otherwise it is killed

    Raises
    ------
    RaysvcError
        it ended before it listened; says why
    """
    data_dir.mkdir(parents=True, exist_ok=True)
    command = [sys.executable, "-m", "raysvc", "serve", "--port", "0", "--data-dir", str(data_dir)]
    log = data_dir / LOG
    # To a file, which never fills up, as a pipe does that nobody reads.
    with (
        log.open("wb") as said,
        subprocess.Popen(
            command, env={**os.environ, **(settings or {})}, stdout=said, stderr=said
        ) as process,
    ):
        try:
            yield RunningService(_address(process, log), process, log)
        finally:
            if drain:
                process.terminate()
            else:
                process.kill()


def _address(process: subprocess.Popen[bytes], log: Path) -> str:
    while True:
        ended = process.poll() is not None
        for line in log.read_text(errors="replace").splitlines(keepends=True):
            if line.startswith(ANNOUNCEMENT) and line.endswith("\n"):
                return line.removeprefix(ANNOUNCEMENT).strip()
        if ended:
            raise _not_started(log)
        time.sleep(LOOK_EVERY_S)


def _not_started(log: Path) -> RaysvcError:
    said = log.read_text(errors="replace").strip()[-SHOWN_OF_LOG:]
    return RaysvcError(f"the service did not start: {said}")
