"""What a parser's process and the service say to each other, a byte at a time."""

from typing import Final

ASK: Final = b"a"
"""To the process: there is a question."""
READY: Final = b"r"
"""From it: it has started, and given up its rights."""
READY_UNFILTERED: Final = b"u"
"""The same, but the kernel does not keep it from files and the network."""
DONE: Final = b"d"
"""From it: the question has been replaced by its answer."""
