"""The process that reads files, started by `ParserProcess` as `main` with FILE OPTIONS LIMITS.

FILE is the descriptor of an open file through which messages go both ways; OPTIONS and LIMITS are
JSON. It says READY on standard output once it has given up its rights, and DONE when the question
that was in the file has been replaced by its answer. A byte on standard input means that there is
a question, its end that there will be none.
"""

import gc
import json
import os
import shutil
import sys
import tempfile

from raysvc.limits import Limits
from raysvc.parsing.confinement import allow_cpu, confine
from raysvc.parsing.message import read_message, write_message
from raysvc.parsing.options import ParserOptions
from raysvc.parsing.rehearsal import rehearse
from raysvc.parsing.signs import DONE, READY, READY_UNFILTERED
from raysvc.parsing.tasks import OUT_OF_MEMORY, answer, error


def serve(file: int, options: ParserOptions, limits: Limits) -> None:
    """Answer questions until there are no more."""
    questions, answers = os.dup(0), os.dup(1)
    # What libraries print, or read, is nobody's business.
    nothing = os.open(os.devnull, os.O_RDWR)
    for standard in (0, 1, 2):
        os.dup2(nothing, standard)
    os.close(nothing)
    rehearse(limits)
    gc.freeze()  # what is there now stays, and need not be looked through again
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


def main() -> None:
    """Do as the command line says."""
    file, options, limits = sys.argv[1:]
    try:
        serve(int(file), ParserOptions(**json.loads(options)), Limits(**json.loads(limits)))
    finally:
        # Whoever started this removes the folder too, unless it was killed itself.
        shutil.rmtree(tempfile.gettempdir(), ignore_errors=True)
