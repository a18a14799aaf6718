"""Threads, progress and stopping.

Work is cut into chunks whose size never depends on the number of threads, and a chunk writes only
its own slots: that is why a picture is the same with any number of threads.
"""

import copy
import os
import threading
import time
from collections.abc import Callable
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from typing import TypeVar

from raysvc.errors import Cancelled, DeadlineExceeded


class Control:
    """What a caller holds on to while work runs: stop it, bound it, hear how far it is.

    Parameters
    ----------
    threads
        worker threads; None takes all processors that this process may use
    deadline_s
        seconds from now after which the work ends with DeadlineExceeded; None never
    on_progress
        called with (stage, fraction in 0..1) from whichever thread has finished a chunk; must be
        quick
    """

    def __init__(
        self,
        threads: int | None = None,
        deadline_s: float | None = None,
        on_progress: Callable[[str, float], None] | None = None,
    ) -> None:
        self.threads = threads or available_threads()
        self._deadline = None if deadline_s is None else time.monotonic() + deadline_s
        self._on_progress = on_progress
        self._cancelled = threading.Event()

    def limited(self, threads: int | None, deadline_s: float | None) -> "Control":
        """Return this control with fewer or more threads, and no later deadline than it has."""
        other = copy.copy(self)
        other.threads = threads or self.threads
        if deadline_s is not None:
            deadline = time.monotonic() + deadline_s
            other._deadline = deadline if self._deadline is None else min(deadline, self._deadline)
        return other

    def quiet(self) -> "Control":
        """Return this control without its progress, for work that is one step of something."""
        other = copy.copy(self)
        other._on_progress = None
        return other

    def cancel(self) -> None:
        """Ask the work to stop at its next check."""
        self._cancelled.set()

    def check(self) -> None:
        """Raise Cancelled or DeadlineExceeded if the work should not go on."""
        if self._cancelled.is_set():
            raise Cancelled("the work was cancelled")
        if self._deadline is not None and time.monotonic() > self._deadline:
            raise DeadlineExceeded(
                "the work did not finish within its deadline", field="deadline_s"
            )

    def progress(self, stage: str, fraction: float) -> None:
        """Report how much of a stage is done."""
        if self._on_progress is not None:
            self._on_progress(stage, fraction)


def available_threads() -> int:
    """Processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def for_chunks(
    count: int,
    chunk: int,
    work: Callable[[int, int], None],
    control: Control,
    stage: str = "",
    part: tuple[float, float] = (0.0, 1.0),
) -> None:
    """Call `work(begin, end)` for consecutive ranges of at most `chunk` items that cover 0..count.

    Chunks run on `control.threads` threads in any order; the first exception stops the rest and is
    raised. They are the `part` of their stage, from one fraction of it to another.
    """
    starts = range(0, count, chunk)
    done = 0
    lock = threading.Lock()

    def run(begin: int) -> None:
        nonlocal done
        control.check()
        work(begin, min(begin + chunk, count))
        if stage:
            with lock:
                done += 1
                fraction = part[0] + (part[1] - part[0]) * done / len(starts)
            control.progress(stage, fraction)

    if control.threads == 1 or len(starts) <= 1:
        for begin in starts:
            run(begin)
        return
    with ThreadPoolExecutor(control.threads, thread_name_prefix="raysvc") as pool:
        futures = [pool.submit(run, begin) for begin in starts]
        _, pending = wait(futures, return_when=FIRST_EXCEPTION)
        for future in pending:
            future.cancel()
    for future in futures:
        if not future.cancelled():
            future.result()


def for_waves(
    lanes: int, steps: int, work: Callable[[int, int], None], control: Control, stage: str = ""
) -> None:
    """Call `work(lane, step)` after both (lane - 1, step) and (lane, step - 1) have ended.

    A lane's steps run on one thread, one after the other; a lane follows the one before it as
    closely as it can, as the right half of a picture's rows follows the left one. The first
    exception stops the rest and is raised.
    """
    ended = [threading.Semaphore(0) for _ in range(lanes)]
    broken = threading.Event()

    # Lanes begin in their order, so that one that waits never waits for one that has no thread.
    def run(lane: int, _: int) -> None:
        try:
            for step in range(steps):
                if lane:
                    ended[lane - 1].acquire()
                if broken.is_set():
                    break
                control.check()
                work(lane, step)
                ended[lane].release()
        except BaseException:
            broken.set()
            raise
        finally:
            ended[lane].release(steps)

    for_chunks(lanes, 1, run, control, stage)


Result = TypeVar("Result")


def map_chunks(
    count: int,
    chunk: int,
    work: Callable[[int, int], Result],
    control: Control,
    stage: str = "",
) -> list[Result]:
    """Return `work(begin, end)` for consecutive ranges, in their order; see `for_chunks`."""
    results: dict[int, Result] = {}

    def keep(begin: int, end: int) -> None:
        results[begin] = work(begin, end)

    for_chunks(count, chunk, keep, control, stage)
    return [results[begin] for begin in sorted(results)]
