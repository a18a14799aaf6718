"""The only place that says how Numba compiles, and where compiled kernels are kept.

A kernel is a serial loop that releases the GIL; threads are ours (`raysvc.parallel`). Numba's own
cache notices a change of the kernel's file but not of a file it calls into, so the cache folder is
named after a hash of all of raysvc's sources: an edit or an upgrade never runs stale code.
"""

import contextlib
import hashlib
import os
import stat
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final, ParamSpec, TypeVar

import numba

P = ParamSpec("P")
R = TypeVar("R")


def source_hash() -> str:
    """SHA-256 of raysvc's Python sources, names and contents, as 16 hex digits."""
    root = Path(__file__).parent
    digest = hashlib.sha256()
    for path in sorted(root.rglob("*.py")):
        digest.update(path.relative_to(root).as_posix().encode() + b"\0")
        digest.update(path.read_bytes() + b"\0")
    return digest.hexdigest()[:16]


def kernel_cache_dir() -> Path:
    """Folder for compiled kernels: RAYSVC_CACHE, else the user's cache, else a temporary one."""
    for home in _homes():
        folder = home / "kernels" / source_hash()
        try:
            folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        except OSError:
            continue
        if os.access(folder, os.W_OK):
            return folder
    return Path(tempfile.mkdtemp(prefix="raysvc-kernels-"))


def _homes() -> Iterator[Path]:
    """Folders that may hold kernels, the best first; the last is made when it is asked for."""
    chosen = os.environ.get("RAYSVC_CACHE")
    if chosen:
        yield Path(chosen)
        return
    with contextlib.suppress(RuntimeError):  # a user without a home
        yield Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "raysvc"
    if hasattr(os, "getuid"):
        shared = Path(tempfile.gettempdir()) / f"raysvc-{os.getuid()}"
        if _is_ours(shared):
            yield shared


def _is_ours(folder: Path) -> bool:
    """Make a folder, and say whether nobody else can put code for us to run there."""
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        status = folder.lstat()
    except OSError:
        return False
    private = stat.S_ISDIR(status.st_mode) and not status.st_mode & 0o022
    return private and status.st_uid == os.getuid()


if not os.environ.get("NUMBA_CACHE_DIR"):
    # Numba makes its settings when it is imported, so they have no types.
    numba.config.CACHE_DIR = str(kernel_cache_dir())  # type: ignore[attr-defined]


def kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile for one thread, without the GIL, cached; division by zero gives inf or NaN."""
    compiled: Callable[P, R] = numba.njit(cache=True, nogil=True, error_model="numpy")(function)
    return compiled


INLINED: Final[dict[str, Any]] = {
    "cache": True,
    "nogil": True,
    "error_model": "numpy",
    "forceinline": True,
}
UNCOUNTED: Final[dict[str, Any]] = {"_nrt": False}
"""Without Numba's run time, which counts references; its type stubs leave that option out."""


def inlined(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a function that kernels call, always inlined; it cannot make or sort arrays.

    Left to itself LLVM keeps large ones as calls, and a call copies every array's header that its
    arguments hold: a material's evaluation took 1.2 us so, and takes 0.2 us inlined.

    What makes no arrays owns none, so that nothing is gained by counting references to those that
    it reads. The counts are atomic, shared by all threads, and took half the time of a material
    with five textures.
    """
    compiled: Callable[P, R] = numba.njit(**INLINED, **UNCOUNTED)(function)
    return compiled


def inlined_allocating(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a function that kernels call, always inlined, and that makes or sorts arrays."""
    compiled: Callable[P, R] = numba.njit(**INLINED)(function)
    return compiled
