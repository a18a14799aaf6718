"""The only place that says how Numba compiles, and where compiled kernels are kept.

A kernel is a serial loop that releases the GIL; threads are ours (`raysvc.parallel`). Numba's own
cache notices a change of the kernel's file but not of a file it calls into, so the cache folder is
named after a hash of all of raysvc's sources: an edit or an upgrade never runs stale code.
"""

import hashlib
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import ParamSpec, TypeVar

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
    chosen = os.environ.get("RAYSVC_CACHE")
    homes = (
        [Path(chosen)]
        if chosen
        else [
            Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "raysvc",
            Path(tempfile.gettempdir())
            / f"raysvc-{os.getuid() if hasattr(os, 'getuid') else 'user'}",
        ]
    )
    for home in homes:
        folder = home / "kernels" / source_hash()
        try:
            folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        except OSError:
            continue
        if os.access(folder, os.W_OK):
            return folder
    return Path(tempfile.mkdtemp(prefix="raysvc-kernels-"))


if not os.environ.get("NUMBA_CACHE_DIR"):
    # Numba makes its settings when it is imported, so they have no types.
    numba.config.CACHE_DIR = str(kernel_cache_dir())  # type: ignore[attr-defined]


def kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile for one thread, without the GIL, cached; division by zero gives inf or NaN."""
    compiled: Callable[P, R] = numba.njit(cache=True, nogil=True, error_model="numpy")(function)
    return compiled


def inlined(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a scalar function that kernels call, always inlined.

    Left to itself LLVM keeps large ones as calls, and a call copies every array's header that its
    arguments hold: a material's evaluation took 1.2 us so, and takes 0.2 us inlined.
    """
    compiled: Callable[P, R] = numba.njit(
        cache=True, nogil=True, error_model="numpy", forceinline=True
    )(function)
    return compiled
