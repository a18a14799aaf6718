"""The files of one scene: an upload, what an archive holds, or a file on disk and its side files.

Nothing outside is ever read: no URL, no path that leaves the folder, no device.
"""

import os
import posixpath
import re
import stat
from collections.abc import Mapping
from pathlib import Path
from typing import Protocol

from raysvc.errors import InvalidScene, LimitExceeded
from raysvc.limits import DEFAULT_LIMITS, Limits
from raysvc.loading.archive import unpack

SCENE_SUFFIXES = (".glb", ".gltf", ".obj", ".ply", ".stl", ".off", ".3mf")
ARCHIVE_SUFFIX = ".zip"

_SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.\-]*:")
_SHOWN_CHARACTERS = 120


class _Store(Protocol):
    """Where bytes come from; names are normalised and relative to the store's root."""

    def read(self, name: str, field: str) -> bytes: ...

    def has(self, name: str) -> bool: ...

    def names(self) -> tuple[str, ...]: ...


class Files:
    """The files of one scene, read-only, named by POSIX paths relative to the main file's folder.

    `main` is the name of the file to load. Reading raises InvalidScene for what is missing, leaves
    the folder (or archive, or upload) or is a URL, and LimitExceeded for what is too large.
    """

    def __init__(self, store: _Store, main: str) -> None:
        """Use a class method instead; `main` is relative to the store's root."""
        self._store = store
        self._folder, self.main = posixpath.split(main)

    @classmethod
    def from_path(cls, path: str | os.PathLike[str], limits: Limits = DEFAULT_LIMITS) -> "Files":
        """Open a scene file on disk, or a .zip of one; side files are read when asked for."""
        path = Path(path)
        if path.suffix.lower() == ARCHIVE_SUFFIX:
            return cls.from_zip(read_regular(path, limits.max_file_bytes, path.name), limits)
        _check_regular(path, path.name)
        return cls(_FolderStore(path, limits), path.name)

    @classmethod
    def from_memory(
        cls,
        files: Mapping[str, bytes],
        main: str | None = None,
        limits: Limits = DEFAULT_LIMITS,
    ) -> "Files":
        """Take files that are in memory; `main` may be left out where only one can be it."""
        if len(files) > limits.max_files:
            raise LimitExceeded(f"{len(files)} files; the limit is {limits.max_files}", "files")
        named: dict[str, bytes] = {}
        for name, data in files.items():
            clean = normalise(name, field=_shown(name))
            if clean in named:
                raise InvalidScene("two files have this name", field=_shown(name))
            _check_size(len(data), limits.max_file_bytes, _shown(name))
            named[clean] = data
        _check_size(sum(map(len, named.values())), limits.max_scene_bytes, "files")
        if main is None:
            main = _only_scene(tuple(named))
        main = normalise(main, field="main")
        if main not in named:
            raise InvalidScene(f"there is no file {_shown(main)}", field="main")
        return cls(_MemoryStore(named), main)

    @classmethod
    def from_zip(cls, data: bytes, limits: Limits = DEFAULT_LIMITS) -> "Files":
        """Unpack an archive in memory; the only scene file in it is the main one."""
        return cls.from_memory(unpack(data, limits), None, limits)

    def read(self, name: str, field: str = "uri") -> bytes:
        """Return a file's bytes; `field` is what an error names, such as `buffers[0].uri`."""
        return self._store.read(normalise(name, self._folder, field), field)

    def __contains__(self, name: object) -> bool:
        try:
            return isinstance(name, str) and self._store.has(normalise(name, self._folder))
        except InvalidScene:
            return False

    def names(self) -> tuple[str, ...]:
        """Return all names, sorted; for a file on disk only `main`: its folder is not searched."""
        start = self._folder or "."
        return tuple(sorted(posixpath.relpath(name, start) for name in self._store.names()))


def normalise(name: str, folder: str = "", field: str = "uri") -> str:
    """Return `folder/name` without `.` and `..`; refuse URLs and what leaves the root."""
    path = name.replace("\\", "/")
    if _SCHEME.match(path) or path.startswith("//"):
        raise InvalidScene(f"{_shown(name)} is a URL; only files sent along are read", field)
    clean = posixpath.normpath(posixpath.join(folder, path)) if path else "."
    if clean == ".":
        raise InvalidScene(f"{_shown(name)} does not name a file", field)
    if "\0" in clean or clean.startswith("/") or clean == ".." or clean.startswith("../"):
        raise InvalidScene(f"{_shown(name)} leaves the folder of the scene", field)
    return clean


class _MemoryStore:
    def __init__(self, files: dict[str, bytes]) -> None:
        self._files = files
        # Browsers drop the folders of uploaded files; then `textures/a.png` is found as `a.png`.
        self._flat = not any("/" in name for name in files)

    def _key(self, name: str) -> str:
        return posixpath.basename(name) if self._flat else name

    def read(self, name: str, field: str) -> bytes:
        try:
            return self._files[self._key(name)]
        except KeyError:
            raise InvalidScene(f"the file {_shown(name)} is missing", field) from None

    def has(self, name: str) -> bool:
        return self._key(name) in self._files

    def names(self) -> tuple[str, ...]:
        return tuple(self._files)


class _FolderStore:
    """A file on disk with what lies beside and below it, after symbolic links are followed."""

    def __init__(self, main: Path, limits: Limits) -> None:
        self._main, self._limits = main, limits
        self._root = main.parent.resolve()
        self._sizes: dict[str, int] = {}

    def _path(self, name: str, field: str) -> Path:
        if name == self._main.name:
            return self._main
        try:
            path = (self._root / name).resolve()
        except (OSError, RuntimeError):
            raise InvalidScene(f"the file {_shown(name)} cannot be read", field) from None
        if not path.is_relative_to(self._root):
            raise InvalidScene(f"{_shown(name)} leaves the folder of the scene", field)
        return path

    def read(self, name: str, field: str) -> bytes:
        data = read_regular(self._path(name, field), self._limits.max_file_bytes, field)
        self._sizes[name] = len(data)
        if len(self._sizes) > self._limits.max_files:
            raise LimitExceeded(f"more than {self._limits.max_files} files", field)
        _check_size(sum(self._sizes.values()), self._limits.max_scene_bytes, field)
        return data

    def has(self, name: str) -> bool:
        try:
            return self._path(name, "uri").is_file()
        except OSError:
            return False

    def names(self) -> tuple[str, ...]:
        return (self._main.name,)


def read_regular(path: Path, limit: int, field: str) -> bytes:
    """Read a regular file of at most `limit` bytes; opening a pipe or a device does not hang."""
    _check_regular(path, field)
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    try:
        with open(os.open(path, flags), "rb") as file:
            status = os.fstat(file.fileno())
            if not stat.S_ISREG(status.st_mode):
                raise InvalidScene(f"{_shown(path.name)} is not a regular file", field)
            _check_size(status.st_size, limit, field)
            data = file.read(limit + 1)
    except OSError as error:
        raise InvalidScene(f"{_shown(path.name)}: {error.strerror}", field) from None
    _check_size(len(data), limit, field)
    return data


def _check_regular(path: Path, field: str) -> None:
    try:
        mode = path.stat().st_mode
    except (OSError, ValueError):
        raise InvalidScene(f"the file {_shown(path.name)} is missing", field) from None
    if not stat.S_ISREG(mode):
        raise InvalidScene(f"{_shown(path.name)} is not a regular file", field)


def _check_size(size: int, limit: int, field: str) -> None:
    if size > limit:
        raise LimitExceeded(f"{size:,} bytes; the limit is {limit:,}", field)


def _only_scene(names: tuple[str, ...]) -> str:
    scenes = [name for name in names if name.lower().endswith(SCENE_SUFFIXES)]
    if len(scenes) == 1:
        return scenes[0]
    if scenes:
        shown = ", ".join(map(_shown, sorted(scenes)[:5]))
        raise InvalidScene(f"say which of these is the scene: {shown}", field="main")
    expected = " ".join(SCENE_SUFFIXES)
    raise InvalidScene(f"no file with a scene's suffix ({expected})", field="main")


def _shown(name: str) -> str:
    """A name that is safe to put into a message."""
    cut = name if len(name) <= _SHOWN_CHARACTERS else name[: _SHOWN_CHARACTERS - 3] + "..."
    return ascii(cut) if not cut.isprintable() else cut
