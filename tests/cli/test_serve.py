"""The service as a process: its address, its settings, its end."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
import pytest


@contextmanager
def service(data_dir: Path, **environment: str) -> Iterator[subprocess.Popen[str]]:
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
    assert process.stdout is not None
    return process.stdout.readline().rpartition(" ")[2].strip()


def wait_until_alive(client: httpx.Client) -> None:
    for _ in range(300):
        try:
            if client.get("/healthz").is_success:
                return
        except httpx.ConnectError:
            time.sleep(0.1)
    raise AssertionError("the service does not listen")


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="there are no such signals")
def test_on_sigterm_the_service_ends_within_its_grace(tmp_path: Path) -> None:
    with (
        service(tmp_path, RAYSVC_GRACE_S="1") as process,
        httpx.Client(base_url=address(process), timeout=60) as client,
    ):
        wait_until_alive(client)
        body = {"scene": "builtin:shiny", "settings": {"aa": "full", "aa_samples": 64}}
        assert client.post("/v1/renders", json=body).status_code == 202
        process.send_signal(signal.SIGTERM)
        began = time.monotonic()
        assert process.wait(30) in (0, -signal.SIGTERM)
        assert time.monotonic() - began < 20
        assert process.stderr is not None
        assert "Traceback" not in process.stderr.read()


@pytest.mark.slow
def test_a_wrong_variable_is_named_in_one_line(tmp_path: Path) -> None:
    with service(tmp_path, RAYSVC_QUEUE_SIZE="many") as process:
        _, errors = process.communicate(timeout=60)
    assert process.returncode == 2
    assert errors.splitlines()[-1].startswith("error: RAYSVC_QUEUE_SIZE: ")
    assert "Traceback" not in errors
