"""On what something was measured: enough to repeat it, nothing that names a host."""

import importlib.metadata
import platform
from pathlib import Path
from typing import Any

from raysvc.parallel import available_threads

PACKAGES = ("numpy", "numba", "llvmlite", "embreex")


def machine() -> dict[str, Any]:
    """Processor, threads that this process may use, system, versions of what computes."""
    return {
        "processor": _processor(),
        "architecture": platform.machine(),
        "threads": available_threads(),
        "system": platform.system(),
        "python": platform.python_version(),
        "packages": {name: _version(name) for name in PACKAGES},
    }


def _processor() -> str:
    """The processor's name; Linux tells it in a file and not through `platform`."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        lines = []
    named = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(named, platform.processor() or "unknown")


def _version(package: str) -> str | None:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return None
