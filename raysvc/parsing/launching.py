"""The process that forks those which read files: one thread, everything imported.

It is asked by `Launcher`, through a socket whose descriptor is its first argument; the others are
ParserOptions and Limits as JSON. It ends with the socket.
"""

import contextlib
import gc
import json
import os
import signal
import socket
import sys
import traceback
from typing import Final, NoReturn

from raysvc.limits import Limits
from raysvc.parsing.child import serve
from raysvc.parsing.options import ParserOptions
from raysvc.parsing.rehearsal import rehearse

LONGEST_COMMAND: Final = 10_000
FILES: Final = 3


def main() -> NoReturn:
    """Do as the command line says."""
    number, options_text, limits_text = sys.argv[1:]
    options = ParserOptions(**json.loads(options_text))
    limits = Limits(**json.loads(limits_text))
    rehearse(limits)
    # What is there now stays: nobody need look through it again, nor copy it by doing so.
    gc.collect()
    gc.freeze()
    commands = socket.socket(fileno=int(number))
    try:
        while _obeyed(commands, options, limits):
            pass
    except ConnectionError:  # whoever was at the other end was killed
        pass
    except BaseException:
        traceback.print_exc()
        os._exit(1)
    os._exit(0)  # without what libraries do, and say, in the end


def _obeyed(commands: socket.socket, options: ParserOptions, limits: Limits) -> bool:
    """Do as the next command says; False if there will be none."""
    data, files, _, _ = socket.recv_fds(commands, LONGEST_COMMAND, FILES)
    if not data:
        return False
    command = json.loads(data)
    if "reap" in command:
        reply = _reaped(command["reap"])
    else:
        reply = _launched(commands, files, options, limits)
    commands.sendall(json.dumps(reply).encode())
    return True


def _launched(
    commands: socket.socket, files: list[int], options: ParserOptions, limits: Limits
) -> int:
    """Fork; returns the number of the new process, in which it does not return."""
    id = os.fork()
    if id == 0:
        commands.close()
        _read_files(files, options, limits)
    for file in files:
        os.close(file)
    return id


def _read_files(files: list[int], options: ParserOptions, limits: Limits) -> NoReturn:
    """Be a process that reads files, to the end."""
    code = 1
    try:
        os.setsid()
        file, questions, answers = files
        serve(file, questions, answers, options, limits)
        code = 0
    except BaseException:
        traceback.print_exc()
    finally:
        os._exit(code)


def _reaped(id: int) -> int:
    """Make sure that a child and its session have ended, and return how it did, perhaps earlier."""
    for kill in (os.killpg, os.kill):
        with contextlib.suppress(ProcessLookupError):
            kill(id, signal.SIGKILL)
    return os.waitstatus_to_exitcode(os.waitpid(id, 0)[1])
