"""A scene's file, and those that it refers to: what has to be sent for the service to see it all.

Only references are looked for; whether a scene is good, the service says. As where raysvc itself
loads a scene, nothing that lies outside of the file's folder is read, let alone sent.
"""

import json
import re
import struct
import urllib.parse
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

from raysvc.errors import InvalidScene
from raysvc.limits import DEFAULT_LIMITS
from raysvc.loading.files import ARCHIVE_SUFFIX, SCENE_SUFFIXES, Files, read_regular

_GLB_HEADER: Final = struct.Struct("<4sII II")
_LIBRARY: Final = re.compile(rb"^[ \t]*mtllib[ \t]+(.+?)[ \t]*\r?$", re.MULTILINE)
_MAP: Final = re.compile(
    r"^[ \t]*(?:map_\w+|bump|disp|decal|refl|norm)[ \t]+(.+?)[ \t]*\r?$",
    re.MULTILINE | re.IGNORECASE,
)


def scene_files(path: Path) -> dict[str, Path]:
    """Files to send by their names, the scene's own first. Raises InvalidScene."""
    if path.suffix.lower() == ARCHIVE_SUFFIX:
        read_regular(path, DEFAULT_LIMITS.max_file_bytes, path.name)
        return {path.name: path}
    files = Files.from_path(path)
    found = {path.name: path}
    for name in _references(path, files):
        if name in files:
            found.setdefault(name.replace("\\", "/"), path.parent / name.replace("\\", "/"))
    return found


def main_among(names: list[str]) -> str | None:
    """The first name, where the service could not tell by itself that it is the scene."""
    if names[0].lower().endswith(ARCHIVE_SUFFIX):
        return None
    scenes = [name for name in names if name.lower().endswith(SCENE_SUFFIXES)]
    return None if scenes == names[:1] else names[0]


def _references(path: Path, files: Files) -> Iterator[str]:
    suffix = path.suffix.lower()
    if suffix == ".obj":
        yield from _of_obj(files)
    elif suffix == ".glb":
        yield from _of_gltf(_json_of_glb(path), files)
    elif suffix == ".gltf":
        yield from _of_gltf(files.read(files.main), files)


def _of_gltf(text: bytes, files: Files) -> Iterator[str]:
    try:
        document: Any = json.loads(text)
    except (ValueError, RecursionError):
        return
    for part in ("buffers", "images"):
        entries = document.get(part) if isinstance(document, dict) else None
        for entry in entries if isinstance(entries, list) else ():
            uri = entry.get("uri") if isinstance(entry, dict) else None
            if isinstance(uri, str) and not uri[:5].lower() == "data:":
                # Some exporters do not escape; the reader looks for both as well.
                yield uri if uri in files else urllib.parse.unquote(uri)


def _json_of_glb(path: Path) -> bytes:
    with path.open("rb") as file:
        header = file.read(_GLB_HEADER.size)
        if len(header) < _GLB_HEADER.size:
            return b""
        magic, _, whole, length, _ = _GLB_HEADER.unpack(header)
        return file.read(min(length, whole)) if magic == b"glTF" else b""


def _of_obj(files: Files) -> Iterator[str]:
    for library in _LIBRARY.findall(files.read(files.main)):
        name = library.decode("utf-8", "replace")
        if name not in files:
            continue
        yield name
        try:
            text = files.read(name, "mtllib").decode("utf-8", "replace")
        except InvalidScene:
            continue
        for statement in _MAP.findall(text):
            # Options come first, and a name may hold spaces: the longest ending that is a file.
            words = statement.split(" ")
            endings = (" ".join(words[start:]) for start in range(len(words)))
            yield next((name for name in endings if name in files), statement)
