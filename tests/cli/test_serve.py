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

from api.settings import settings_from_environment
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


@pytest.mark.parametrize(
    "told", [{"RAYSVC_DATA_DIR": ""}, {"raysvc_data_dir": "elsewhere"}, {"RAYSVC_DATA_DIR": "here"}]
)
def test_the_check_for_keys_and_the_service_look_at_the_same_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, told: dict[str, str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "home"))
    # Set and taken away, so that what `serve` writes is forgotten after the test.
    monkeypatch.setenv("RAYSVC_DATA_DIR", "")
    monkeypatch.delenv("RAYSVC_DATA_DIR")
    for name, value in told.items():
        monkeypatch.setenv(name, value)
    seen: list[Path] = []

    def run_service(_: object, sockets: list[socket.socket]) -> None:
        seen.append(settings_from_environment().data_dir)
        for listening in sockets:
            listening.close()

    def look(self: KeyStore, data_dir: Path) -> None:
        seen.append(data_dir)
        made(self, data_dir)

    made = KeyStore.__init__
    monkeypatch.setattr(KeyStore, "__init__", look)
    monkeypatch.setattr(uvicorn.Server, "run", run_service)
    expected = tmp_path / (told.get("RAYSVC_DATA_DIR") or "home/raysvc")
    store = KeyStore(expected)
    store.add("some", Scope.READ)
    store.close()
    seen.clear()
    assert run(["serve", "--host", "0.0.0.0", "--port", "0"]) == 0
    assert seen == [expected, expected]


@pytest.mark.parametrize(
    ("host", "given", "names"),
    [
        ("127.0.0.1", None, "localhost,127.0.0.1,[::1],127.0.0.1"),
        ("127.8.9.10", None, "localhost,127.0.0.1,[::1],127.8.9.10"),
        ("127.0.0.1", "renders.example.org", "renders.example.org"),
        ("0.0.0.0", None, None),
    ],
)
def test_on_an_address_of_its_machine_it_answers_to_names_of_its_machine(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    host: str,
    given: str | None,
    names: str | None,
) -> None:
    monkeypatch.setenv("RAYSVC_HOSTS", given or "")
    if given is None:
        monkeypatch.delenv("RAYSVC_HOSTS")
    monkeypatch.setattr(
        uvicorn.Server, "run", lambda self, sockets: [one.close() for one in sockets]
    )
    words = ["serve", "--host", host, "--port", "0", "--data-dir", str(tmp_path), "--open"]
    assert run(words) == 0
    assert os.environ.get("RAYSVC_HOSTS") == names


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
