"""`raysvc serve` as a process of its own."""

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx


@contextmanager
def service(data_dir: Path, **environment: str) -> Iterator[subprocess.Popen[str]]:
    """Start it on a free port; it is killed in the end."""
    command = [sys.executable, "-m", "raysvc", "serve", "--port", "0", "--data-dir", str(data_dir)]
    with subprocess.Popen(
        command,
        env={**os.environ, **environment},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            yield process
        finally:
            process.kill()


def address(process: subprocess.Popen[str]) -> str:
    """Where it says that it is."""
    assert process.stdout is not None
    return process.stdout.readline().rpartition(" ")[2].strip()


def wait_until(client: httpx.Client, path: str) -> None:
    """Wait until a route answers with success."""
    for _ in range(600):
        try:
            if client.get(path).is_success:
                return
        except httpx.ConnectError:
            pass
        time.sleep(0.1)
    raise AssertionError(f"{path} is not answered")
