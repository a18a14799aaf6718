"""From words on the command line to what the core takes. Everything wrong is an InvalidSetting."""

import json
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Final, TypeVar

import typer

from raysvc.errors import InvalidSetting
from raysvc.frame.probe import FIELD, Probe
from raysvc.frame.settings import checked

Format = TypeVar("Format", bound=str)

ProbeSize = Annotated[
    int | None, typer.Option("--probe-size", help="Pixels along a side of the probe's cube.")
]
ProbeWithout = Annotated[
    list[str] | None,
    typer.Option(
        "--probe-without", help="An object's number or a material's name; may be repeated."
    ),
]

PICTURE_SUFFIXES: Final = (".png", ".jpg", ".jpeg", ".webp", ".exr", ".npz")


def settings_mapping(assignments: Sequence[str]) -> dict[str, Any]:
    """Read KEY=VALUE words; a value is JSON where it can be, else a text."""
    values: dict[str, Any] = {}
    for assignment in assignments:
        key, equals, text = assignment.partition("=")
        if not equals or not key:
            raise InvalidSetting(f"write KEY=VALUE, not {assignment!r}", field="--set")
        if key in values:
            raise InvalidSetting("is set twice", field=f"settings.{key}")
        values[key] = _value(text)
    return values


def camera_mapping(path: Path | None, size: str | None) -> dict[str, Any]:
    """Read a camera from a JSON file, and its size from WxH."""
    camera: dict[str, Any] = {} if path is None else _object_in(path)
    if size is not None:
        width, height = size_of(size)
        camera |= {"width": width, "height": height}
    return camera


def probe_mapping(
    probe_at: str | None, probe_size: int | None, without: Sequence[str] | None
) -> dict[str, Any] | None:
    """Read a probe's place from X,Y,Z; what it is without is a number, else a name."""
    if probe_at is None:
        for option, value in (("--probe-size", probe_size), ("--probe-without", without)):
            if value is not None:
                raise InvalidSetting("needs --probe-at", field=option)
        return None
    probe: dict[str, Any] = {"probe_at": probe_at.split(",")}
    if probe_size is not None:
        probe["size"] = probe_size
    if without is not None:
        probe["without"] = [int(name) if name.isdecimal() else name for name in without]
    checked(Probe, probe, FIELD)
    return probe


def size_of(size: str) -> tuple[int, int]:
    """Read width and height from WxH."""
    found = re.fullmatch(r"(\d{1,9})x(\d{1,9})", size)
    if found is None:
        raise InvalidSetting(f"write WIDTHxHEIGHT, not {size!r}", field="--size")
    return int(found.group(1)), int(found.group(2))


def checked_output(path: Path) -> Path:
    """Refuse a picture file that could not be written, before time is spent on the picture."""
    if path.suffix.lower() not in PICTURE_SUFFIXES:
        raise InvalidSetting(f"must end in {' '.join(PICTURE_SUFFIXES)}", field="--output")
    return writable(path, "--output")


def writable(path: Path, field: str) -> Path:
    """Refuse a file in a folder that is not there."""
    if not path.parent.is_dir():
        raise InvalidSetting(f"there is no folder {path.parent}", field=field)
    return path


def output_format(path: Path, field: str, formats: Sequence[Format]) -> Format:
    """Return which of some formats a file's suffix names."""
    suffix = path.suffix.lower().lstrip(".")
    for format in formats:
        if format == suffix:
            return format
    raise InvalidSetting(f"must end in {' '.join('.' + f for f in formats)}", field=field)


def _object_in(path: Path) -> dict[str, Any]:
    try:
        value = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InvalidSetting(f"{path}: {error.strerror}", field="--camera") from None
    except (ValueError, RecursionError) as error:
        raise InvalidSetting(f"{path} is not JSON: {error}", field="--camera") from None
    if not isinstance(value, dict):
        raise InvalidSetting(f"{path} must hold a JSON object", field="--camera")
    return value


def _value(text: str) -> Any:
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return text
