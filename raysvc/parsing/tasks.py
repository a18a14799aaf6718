"""What a parser can be asked to do, in the words of messages.

A question's fields are `{"task": NAME, ...}` and its arrays are the bytes of files. An answer is
what the task makes, or `{"error": {"kind", "message", "field"}}`.
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, Final

import numpy as np

from raysvc import errors
from raysvc.limits import Limits
from raysvc.loading import load_environment, load_scene
from raysvc.loading.files import ARCHIVE_SUFFIX, Files
from raysvc.loading.picture_file import read_depth, read_picture
from raysvc.loading.shape_file import read_shape
from raysvc.parsing.message import Message
from raysvc.parsing.scene_message import (
    depth_message,
    environment_message,
    picture_message,
    scene_message,
    shape_message,
)
from raysvc.scene import Environment, Scene

ERRORS: Final[Mapping[str, type[errors.InvalidInput]]] = MappingProxyType(
    {
        kind.__name__: kind
        for kind in (
            errors.InvalidInput,
            errors.InvalidScene,
            errors.InvalidEnvironment,
            errors.InvalidSetting,
            errors.Unsupported,
            errors.LimitExceeded,
        )
    }
)
"""What an answer may raise."""
OUT_OF_MEMORY: Final = "MemoryError"
LONGEST_MESSAGE: Final = 1_000


def read_scene(files: Mapping[str, bytes], main: str | None, limits: Limits) -> Scene:
    """Read a scene: one file, several with side files, or an archive of them."""
    if not files:
        raise errors.InvalidScene("no file was sent", field="file")
    if len(files) == 1:
        ((name, data),) = files.items()
        if name.lower().endswith(ARCHIVE_SUFFIX):
            return load_scene(Files.from_zip(data, limits), limits)
    return load_scene(Files.from_memory(files, main, limits), limits)


def read_environment(files: Mapping[str, bytes], limits: Limits) -> Environment:
    """Read an environment: one file."""
    if len(files) != 1:
        raise errors.InvalidEnvironment(f"needs one file, got {len(files)}", field="file")
    return load_environment(Files.from_memory(files, next(iter(files)), limits), limits)


def answer(question: Message, limits: Limits) -> Message:
    """Do what a question asks; whatever goes wrong is an answer too."""
    try:
        return TASKS[question.fields["task"]](question, limits)
    except errors.InvalidInput as fault:
        kind = OUT_OF_MEMORY if _ran_out(fault) else type(fault).__name__
        return error(kind, fault.message, fault.field)
    except MemoryError:
        return error(OUT_OF_MEMORY, "", None)


def _scene(question: Message, limits: Limits) -> Message:
    return scene_message(read_scene(_files(question), question.fields["main"], limits))


def _environment(question: Message, limits: Limits) -> Message:
    return environment_message(read_environment(_files(question), limits))


def _picture(question: Message, limits: Limits) -> Message:
    ((field, data),) = _files(question).items()
    return picture_message(read_picture(data, limits, field))


def _depth(question: Message, limits: Limits) -> Message:
    ((field, data),) = _files(question).items()
    return depth_message(read_depth(data, limits, question.fields["depth_scale_m"], field))


def _shape(question: Message, limits: Limits) -> Message:
    (data,) = _files(question).values()
    return shape_message(read_shape(data, question.fields["vertices"]))


TASKS: Final[Mapping[str, Callable[[Message, Limits], Message]]] = MappingProxyType(
    {
        "scene": _scene,
        "shape": _shape,
        "environment": _environment,
        "picture": _picture,
        "depth": _depth,
    }
)


def question(task: str, files: Mapping[str, bytes | bytearray], **fields: Any) -> Message:
    """Ask for a task to be done with some files."""
    data = [np.frombuffer(content, np.uint8) for content in files.values()]
    return Message({"task": task, "names": list(files), **fields}, data)


def _files(question: Message) -> dict[str, bytes]:
    names = question.fields["names"]
    return {name: a.tobytes() for name, a in zip(names, question.arrays, strict=True)}


def error(kind: str, message: str, field: str | None) -> Message:
    """Answer that it cannot be done."""
    return Message({"error": {"kind": kind, "message": message[:LONGEST_MESSAGE], "field": field}})


def _ran_out(fault: BaseException) -> bool:
    """Did memory run out below, whatever it was then called?"""
    cause: BaseException | None = fault
    while cause is not None:
        if isinstance(cause, MemoryError):
            return True
        cause = cause.__cause__ or cause.__context__
    return False
