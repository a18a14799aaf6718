"""The service as a process: its address, its settings, its end."""

import json
import os
import signal
import socket
import time
from pathlib import Path

import httpx
import pytest
import uvicorn

from raysvc.access import KeyStore, Scope
from raysvc.cli.app import run
from raysvc.cli.serve import is_private
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


@pytest.mark.parametrize(
    ("host", "private"), [("127.0.0.1", True), ("127.8.9.10", True), ("0.0.0.0", False)]
)
def test_an_address_is_private_if_only_this_machine_reaches_it(host: str, private: bool) -> None:
    with socket.socket() as listening:
        listening.bind((host, 0))
        assert is_private(listening) is private


def test_a_public_address_without_a_key_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["serve", "--host", "0.0.0.0", "--port", "0", "--data-dir", str(tmp_path)]
    assert run(words) == 2
    complaint = capsys.readouterr().err
    assert complaint.startswith("error: --host: 0.0.0.0 can be reached from elsewhere")
    assert "--open" in complaint
    assert "raysvc keys add" in complaint


@pytest.mark.parametrize("allowed_by", ["open", "key"])
def test_a_public_address_is_allowed_by_a_key_or_by_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, allowed_by: str
) -> None:
    served: list[object] = []
    monkeypatch.setattr(uvicorn.Server, "run", lambda self, sockets: served.extend(sockets))
    words = ["serve", "--host", "0.0.0.0", "--port", "0", "--data-dir", str(tmp_path)]
    if allowed_by == "open":
        words.append("--open")
    else:
        KeyStore(tmp_path).add("some", Scope.READ)
    assert run(words) == 0
    (listening,) = served
    listening.close()  # type: ignore[attr-defined]


@pytest.mark.slow
def test_the_service_logs_as_it_is_told_to(tmp_path: Path) -> None:
    with service(tmp_path, RAYSVC_LOG_FORMAT="json", RAYSVC_LOG_LEVEL="info") as process:
        with httpx.Client(base_url=address(process), timeout=60) as client:
            wait_until(client, "/healthz")
            client.get("/v1/scenes", headers={"X-Request-Id": "this-one"})
        process.send_signal(signal.SIGTERM)
        assert process.stderr is not None
        entries = [json.loads(line) for line in process.stderr.read().splitlines()]
    of_request = [entry for entry in entries if entry.get("request_id") == "this-one"]
    assert [entry["message"] for entry in of_request] == ["GET /v1/scenes 200"]
    assert {"time", "level", "logger", "message"} <= set(entries[0])
