"""What runs in a process that reads files.

It says READY once it has given up its rights, and DONE when the question that was in the file for
messages has been replaced by its answer. ASK, in the other direction, means that there is a
question; the end of that direction that there will be none.
"""

import gc
import os
import sys

from raysvc.limits import Limits
from raysvc.loading import named_file
from raysvc.parsing.confinement import allow_cpu, confine
from raysvc.parsing.message import read_message, write_message
from raysvc.parsing.options import ParserOptions
from raysvc.parsing.signs import DONE, READY, READY_UNFILTERED
from raysvc.parsing.tasks import OUT_OF_MEMORY, answer, error


def serve(file: int, questions: int, answers: int, options: ParserOptions, limits: Limits) -> None:
    """Answer questions until there are no more.

    Parameters
    ----------
    file, questions, answers
        descriptors: of the file for messages, and of the pipes for signs
    """
    # What libraries print, or read, is nobody's business.
    nothing = os.open(os.devnull, os.O_RDWR)
    for standard in (0, 1, 2):
        os.dup2(nothing, standard)
    os.close(nothing)
    named_file.prepare()
    filtered = confine(options.memory_bytes, options.memory_bytes)
    os.write(answers, READY if filtered else READY_UNFILTERED)
    while os.read(questions, 1):
        allow_cpu(options.cpu_seconds)
        _exchange(file, limits)
        os.write(answers, DONE)
        gc.collect()


def _exchange(file: int, limits: Limits) -> None:
    """Replace a question by its answer."""
    try:
        write_message(file, answer(read_message(file, sys.maxsize), limits))
    except (MemoryError, OSError):  # an answer may also be larger than a file may be
        write_message(file, error(OUT_OF_MEMORY, "", None))
