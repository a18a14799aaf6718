"""The service as a process: its address, its settings, its end."""

import os
import signal
import time
from pathlib import Path

import httpx
import pytest

from tests.service.process import address, service, wait_until


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="there are no such signals")
def test_on_sigterm_the_service_ends_within_its_grace(tmp_path: Path) -> None:
    with (
        service(tmp_path, RAYSVC_GRACE_S="1") as process,
        httpx.Client(base_url=address(process), timeout=60) as client,
    ):
        wait_until(client, "/healthz")
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
