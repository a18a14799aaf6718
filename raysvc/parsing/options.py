"""What a parser may use."""

import os
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ParserOptions:
    """Bounds of the processes that read uploads."""

    processes: int = 2 if os.name == "posix" else 0
    """How many there are; with 0 the caller's own process reads, which nothing then guards."""
    seconds: float = 20.0
    """Time for one upload, by the clock: more than of the processor, which others use as well."""
    cpu_seconds: float = 7.0
    """Processor time for one upload."""
    memory_bytes: int = 1536 << 20
    """Address space for one upload, over what a process has when it has started; also the largest
    file that it may write, and the largest answer."""
    uploads: int = 16
    """A process ends after so many; with 1 no upload shares one with another."""


DEFAULT_OPTIONS = ParserOptions()
