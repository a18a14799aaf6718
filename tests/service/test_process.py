"""What only a process can show: signals, locks, and how soon the processors are free."""

import json
import os
import signal
import time
from pathlib import Path

import httpx
import pytest

from tests.service.process import address, service, wait_until

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(os.name == "nt", reason="there are no such signals"),
]

LONG = {
    "scene": "builtin:shiny",
    "camera": {"width": 640, "height": 360},
    "settings": {"mode": "reference", "samples": 4096},
}


def begun(client: httpx.Client) -> str:
    """Have a long render begun; returns its link."""
    wait_until(client, "/readyz")
    link: str = client.post("/v1/renders", json=LONG).headers["Location"]
    while client.get(link).json()["progress"] == 0:
        time.sleep(0.02)
    return link


def test_a_second_process_on_the_folder_is_refused_in_one_line(tmp_path: Path) -> None:
    with service(tmp_path) as first, httpx.Client(base_url=address(first)) as client:
        wait_until(client, "/healthz")
        with service(tmp_path) as second:
            _, errors = second.communicate(timeout=120)
        assert second.returncode == 1
        assert errors.splitlines()[-1].startswith(
            f"error: {tmp_path} is in use by process {first.pid}"
        )
        assert "Traceback" not in errors
        assert client.get("/healthz").is_success


def test_a_cancelled_render_soon_leaves_the_processors(tmp_path: Path) -> None:
    with service(tmp_path) as process, httpx.Client(base_url=address(process)) as client:
        link = begun(client)
        began = time.monotonic()
        client.delete(link)
        while client.get(link).json()["state"] == "running":
            time.sleep(0.002)
        assert time.monotonic() - began < 1.0  # 0.1 s where nobody else uses the machine
        assert client.get(link).json()["state"] == "cancelled"


def test_on_sigterm_what_runs_is_left_to_the_next_process(tmp_path: Path) -> None:
    with (
        service(tmp_path, RAYSVC_GRACE_S="1") as process,
        httpx.Client(base_url=address(process), timeout=60) as client,
    ):
        link = begun(client)
        with client.stream("GET", f"{link}/events") as events:
            lines = events.iter_lines()
            while not next(lines).startswith("data: "):
                pass
            process.send_signal(signal.SIGTERM)
            began = time.monotonic()
            told = [json.loads(line[6:]) for line in lines if line.startswith("data: ")]
        assert all(event["state"] == "running" for event in told)
        assert process.wait(60) in (0, -signal.SIGTERM)
        assert time.monotonic() - began < 20
        assert process.stderr is not None
        assert "Traceback" not in process.stderr.read()
    with service(tmp_path) as process, httpx.Client(base_url=address(process)) as client:
        wait_until(client, "/readyz")
        while (known := client.get(link).json())["state"] == "queued":
            time.sleep(0.02)
        assert (known["state"], known["attempts"]) == ("running", 1)
