#!/usr/bin/env python3
"""Tasks for people who work on raysvc. Needs Python 3.11 or newer, and nothing else.

    python3 dev.py demo          start the service, render over HTTP, leave pictures in demo/
    python3 dev.py test [...]    checks, then the tests; what follows goes to pytest
    python3 dev.py check         style, types, import contracts
    python3 dev.py serve [...]   run the service; what follows goes to `raysvc serve`
    python3 dev.py bench [...]   measure; what follows goes to `raysvc bench`
    python3 dev.py docs          draw the pictures of docs/ again
    python3 dev.py lock          resolve the newest dependencies into requirements.lock

Every task makes .venv when it is missing or out of date, from requirements.lock.
"""

import sys

if sys.version_info < (3, 11):  # noqa: UP036 - said clearly to those who try
    sys.exit("raysvc needs Python 3.11 or newer; this is " + sys.version.split()[0])

import hashlib
import os
import platform
import subprocess
import tempfile
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parent
VENV = ROOT / ".venv"
LOCK = ROOT / "requirements.lock"
STAMP = VENV / "raysvc-fingerprint"
SCRIPTS = "Scripts" if os.name == "nt" else "bin"
PYTHON = VENV / SCRIPTS / ("python.exe" if os.name == "nt" else "python")

LOCK_HEADER = """\
# Exact versions for the tests and the image; users get the ranges of pyproject.toml.
# Written by `python3 dev.py lock`.
"""
MARKERS = {"embreex": "platform_machine != 'aarch64' or sys_platform == 'darwin'"}
"""For what has no wheel everywhere."""


def demo(arguments: list[str]) -> int:
    """Start the service, post a scene to it over HTTP, leave pictures and timings in demo/."""
    return _python("-m", "raysvc", "demo", *arguments)


def test(arguments: list[str]) -> int:
    """Run the checks, then the tests."""
    return check([]) or _python("-m", "pytest", *arguments)


def check(arguments: list[str]) -> int:
    """Run style, types and import contracts; all of them, even if one fails."""
    codes = [
        _python("-m", "ruff", "check", "."),
        _python("-m", "ruff", "format", "--check", "."),
        _python("-m", "mypy"),
        _run(str(PYTHON.with_name("lint-imports")), "--cache-dir", str(VENV / "import_linter")),
    ]
    return max(codes)


def serve(arguments: list[str]) -> int:
    """Run the service."""
    return _python("-m", "raysvc", "serve", *arguments)


def bench(arguments: list[str]) -> int:
    """Measure acceleration structures, or what else `raysvc bench` knows."""
    return _python("-m", "raysvc", "bench", *(arguments or ["structures"]))


def docs(arguments: list[str]) -> int:
    """Draw the pictures of docs/ again."""
    return _python("-m", "docs.make_pictures") or _python("-m", "docs.make_lens_pictures")


def lock(arguments: list[str]) -> int:
    """Install what pyproject.toml allows into a fresh environment, and write down what came."""
    with tempfile.TemporaryDirectory(prefix="raysvc-lock-") as folder:
        venv.create(folder, with_pip=True)
        pip = [str(Path(folder) / SCRIPTS / "python"), "-m", "pip"]
        subprocess.run([*pip, "install", f"{ROOT}[dev]", "setuptools>=77"], check=True)
        frozen = subprocess.run(
            [*pip, "freeze", "--all", "--exclude", "pip", "--exclude", "raysvc"],
            check=True,
            capture_output=True,
            text=True,
        ).stdout
    lines = []
    for line in frozen.splitlines():
        marker = MARKERS.get(line.partition("==")[0])
        lines.append(f"{line}; {marker}" if marker else line)
    LOCK.write_text(LOCK_HEADER + "\n".join(lines) + "\n", encoding="utf-8")
    return 0


TASKS = {
    "demo": demo,
    "test": test,
    "check": check,
    "serve": serve,
    "bench": bench,
    "docs": docs,
    "lock": lock,
}


def main() -> int:
    """Run the task that the first word names."""
    if len(sys.argv) < 2 or sys.argv[1] not in TASKS:
        print(__doc__)
        return 0 if sys.argv[1:] in (["--help"], ["-h"]) else 2
    task = sys.argv[1]
    if task != "lock":
        _prepare()
    try:
        return TASKS[task](sys.argv[2:])
    except KeyboardInterrupt:
        return 130


def _prepare() -> None:
    """Make .venv, or leave it alone if it was made from the same things."""
    fingerprint = _fingerprint()
    if STAMP.is_file() and STAMP.read_text() == fingerprint:
        return
    print(f"raysvc: preparing {VENV} (once)", flush=True)
    venv.create(VENV, clear=True, with_pip=True)
    pip = ["-m", "pip", "--disable-pip-version-check", "install"]
    for step in (
        [*pip, "-r", str(LOCK)],
        [*pip, "--no-deps", "--no-build-isolation", "-e", str(ROOT)],
    ):
        if _python(*step) != 0:
            sys.exit("raysvc: the dependencies could not be installed; see above")
    STAMP.write_text(fingerprint)


def _fingerprint() -> str:
    """Name what .venv depends on: dependencies, interpreter, place."""
    digest = hashlib.sha256(f"{platform.python_version()} {sys.executable} {ROOT}".encode())
    for path in (LOCK, ROOT / "pyproject.toml"):
        digest.update(path.read_bytes())
    return digest.hexdigest()


def _python(*arguments: str) -> int:
    return _run(str(PYTHON), *arguments)


def _run(*command: str) -> int:
    return subprocess.run(command, cwd=ROOT, check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
