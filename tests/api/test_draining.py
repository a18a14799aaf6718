"""What is answered from the moment on at which the service is told to end."""

import threading
import time
from typing import Any

import pytest
from fastapi.testclient import TestClient

from raysvc.jobs import PatternRenderer
from tests.api.conftest import MakeClient

RENDER = {"scene": "builtin:cornell", "camera": {"width": 8, "height": 4}}
SLOW = PatternRenderer(seconds=30.0, steps=3000)


def other(seed: int) -> dict[str, Any]:
    return {**RENDER, "settings": {"seed": seed}}


def test_a_draining_service_takes_no_work_and_shows_what_there_is(client: TestClient) -> None:
    done = client.post("/v1/renders", json=RENDER, headers={"Prefer": "wait=10"}).json()
    client.app.state.context.service.drain()  # type: ignore[attr-defined]
    refused = client.post("/v1/renders", json={**RENDER, "settings": {"seed": 1}})
    assert (refused.status_code, refused.json()["retryable"]) == (503, True)
    assert int(refused.headers["Retry-After"]) > 0
    assert client.get(done["links"]["image"]).status_code == 200
    # What is held needs no work.
    assert client.post("/v1/renders", json=RENDER).json()["state"] == "done"


@pytest.mark.parametrize(("path", "status"), [("/v1/renders", 202), ("/v1/render", 503)])
def test_who_waits_for_a_job_that_will_not_run_is_answered_at_once(
    make_client: MakeClient, path: str, status: int
) -> None:
    client = make_client(SLOW)
    running = client.post("/v1/renders", json=RENDER).headers["Location"]
    while client.get(running).json()["state"] == "queued":
        time.sleep(0.01)
    drain = threading.Timer(0.3, client.app.state.context.service.drain)  # type: ignore[attr-defined]
    drain.start()
    began = time.monotonic()
    answer = client.post(path, json=other(1), headers={"Prefer": "wait=30"})
    assert answer.status_code == status
    assert time.monotonic() - began < 10
    drain.join()


def test_what_was_interrupted_and_what_waited_is_done_by_the_next_process(
    make_client: MakeClient,
) -> None:
    client = make_client(SLOW)
    links = [client.post("/v1/renders", json=other(n)).headers["Location"] for n in range(2)]
    following = make_client()
    for link in links:
        while following.get(link).json()["state"] in ("queued", "running"):
            time.sleep(0.01)
        known = following.get(link).json()
        assert (known["state"], known["attempts"]) == ("done", 1)
