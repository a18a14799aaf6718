"""Scenes by name, by path or from memory, in whichever format they are."""

import os
import re

from raysvc.builtin import BUILTIN_SCENES
from raysvc.errors import InvalidScene, LimitExceeded, NotFound, RaysvcError
from raysvc.limits import DEFAULT_LIMITS, Limits
from raysvc.loading.files import Files
from raysvc.loading.gltf import load_gltf
from raysvc.loading.mesh_file import load_mesh
from raysvc.scene import Scene

BUILTIN_PREFIX = "builtin:"
_FORMAT_OF_SUFFIX = {
    ".glb": "gltf",
    ".gltf": "gltf",
    ".obj": "obj",
    ".ply": "ply",
    ".stl": "stl",
    ".off": "off",
    ".3mf": "3mf",
}


def load_scene(source: str | os.PathLike[str] | Files, limits: Limits = DEFAULT_LIMITS) -> Scene:
    """Load a scene.

    Parameters
    ----------
    source
        `builtin:NAME`, the path of a file (or of a .zip of a file and its side files), or files
        in memory
    limits
        what is refused for its size

    Raises
    ------
    NotFound
        no built-in scene has that name
    InvalidScene, Unsupported, LimitExceeded
        the file is broken, needs what raysvc does not do, or is too large; nothing else is raised
    """
    if isinstance(source, str) and source.startswith(BUILTIN_PREFIX):
        name = source.removeprefix(BUILTIN_PREFIX)
        if name not in BUILTIN_SCENES:
            raise NotFound(f"no built-in scene {name!r}; there are {', '.join(BUILTIN_SCENES)}")
        return BUILTIN_SCENES[name]()
    files = source if isinstance(source, Files) else Files.from_path(source, limits)
    try:
        kind = _format_of(files)
        return load_gltf(files, limits) if kind == "gltf" else load_mesh(files, kind, limits)
    except RaysvcError:
        raise
    except MemoryError:
        raise LimitExceeded("does not fit into memory", files.main) from None
    except Exception as error:
        # The readers below are not ours alone, and a hostile file finds what they forgot to check.
        reason = f"{type(error).__name__}: {error}"[:200]
        raise InvalidScene(f"cannot be read ({reason})", files.main) from error


def _format_of(files: Files) -> str:
    """Format by suffix, else by what the file begins with."""
    suffix = os.path.splitext(files.main)[1].lower()
    if suffix in _FORMAT_OF_SUFFIX:
        return _FORMAT_OF_SUFFIX[suffix]
    data = files.read(files.main)
    start = data[:4096].lstrip()
    if start.startswith((b"glTF", b"{")):
        return "gltf"
    if re.match(rb"ply\s", start):
        return "ply"
    if re.match(rb"C?OFF\s", start):
        return "off"
    if re.match(rb"solid\s", start) or _is_binary_stl(data):
        return "stl"
    if re.search(rb"^v[ \t]", start, re.MULTILINE):
        return "obj"
    known = " ".join(_FORMAT_OF_SUFFIX)
    raise InvalidScene(f"is of no known format; known are {known} and .zip of them", files.main)


def _is_binary_stl(data: bytes) -> bool:
    """Whether the length is that which the count of triangles in the header asks for."""
    return len(data) >= 84 and len(data) == 84 + 50 * int.from_bytes(data[80:84], "little")
