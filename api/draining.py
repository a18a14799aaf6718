"""Draining from the moment at which the process is told to end, not once all requests have ended.

The server waits for open requests before it ends an application's lifespan; some of those wait for
jobs that will not run any more.
"""

import asyncio
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any, Final

SIGNALS: Final = (signal.SIGTERM, signal.SIGINT)


@contextmanager
def drained_by_signals(drain: Callable[[], None]) -> Iterator[None]:
    """Within, SIGTERM and SIGINT call `drain` on the running loop and then do what they did before.

    Does nothing outside the main thread, or where nobody handles the signals.
    """
    before: dict[signal.Signals, Any] = {}
    if threading.current_thread() is threading.main_thread():
        loop = asyncio.get_running_loop()
        before = {number: signal.getsignal(number) for number in SIGNALS}

        def handle(number: int, frame: FrameType | None) -> None:
            loop.call_soon_threadsafe(drain)
            before[signal.Signals(number)](number, frame)

        before = {number: handler for number, handler in before.items() if callable(handler)}
        for number in before:
            signal.signal(number, handle)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
