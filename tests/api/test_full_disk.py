import errno
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from fastapi.testclient import TestClient

from tests.api.conftest import MakeClient
from tests.api.glb import glb

RENDER = {"scene": "builtin:cornell", "camera": {"width": 8, "height": 4}}


@contextmanager
def full_disk() -> Iterator[None]:
    def fsync(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("raysvc.jobs.durable_file.os.fsync", fsync)
        yield


def is_storage_full(response: Any) -> bool:
    problem = response.json()
    assert response.status_code == 507, problem
    assert problem["type"] == "urn:raysvc:problem:storage-full"
    assert problem["retryable"]
    return int(response.headers["Retry-After"]) > 0


def test_an_upload_that_finds_no_room_is_told_so_and_may_come_again(client: TestClient) -> None:
    files = {"file": ("triangle.glb", glb())}
    with full_disk():
        assert is_storage_full(client.post("/v1/scenes", files=files))
        assert client.get("/v1/scenes").json() == {"scenes": []}
        assert client.get("/healthz").status_code == 200
    assert client.post("/v1/scenes", files=files).status_code == 201


def test_a_job_that_cannot_be_written_down_is_not_accepted(make_client: MakeClient) -> None:
    client = make_client(queue_size=100)
    client.post("/v1/scenes", json={"builtin": "cornell"})
    service = client.app.state.context.service  # type: ignore[attr-defined]
    writer = service._ledger._writer
    (pages,) = writer.execute("PRAGMA page_count").fetchone()
    writer.execute(f"PRAGMA max_page_count = {pages}")
    for seed in range(2000):
        key = {"Idempotency-Key": f"{seed}" * 30}
        body = {**RENDER, "settings": {"seed": seed}}
        answer = client.post("/v1/renders", json=body, headers=key)
        if answer.status_code == 429:  # the queue is bounded, too: let it run on
            time.sleep(0.01)
        elif answer.status_code != 202:
            break
    assert is_storage_full(answer)
    writer.execute("PRAGMA max_page_count = 1000000")
    wait = {"Prefer": "wait=10"}
    done = client.post("/v1/renders", json={**RENDER, "settings": {"seed": 99}}, headers=wait)
    assert (done.status_code, done.json()["state"]) == (200, "done")


def test_a_render_that_finds_no_room_fails_and_may_come_again(client: TestClient) -> None:
    client.post("/v1/scenes", json={"builtin": "cornell"})
    wait = {"Prefer": "wait=10"}
    with full_disk():
        failed = client.post("/v1/renders", json=RENDER, headers=wait).json()
        assert failed["state"] == "failed"
        assert (failed["error"]["status"], failed["error"]["retryable"]) == (507, True)
        assert is_storage_full(client.get(failed["links"]["self"] + "/image"))
    assert client.post("/v1/renders", json=RENDER, headers=wait).json()["state"] == "done"


def test_a_scene_makes_room_for_newer_ones(make_client: MakeClient) -> None:
    client = make_client(scene_disk_bytes=1)
    first = client.post("/v1/scenes", files={"file": ("triangle.glb", glb())}).json()
    second = client.post("/v1/scenes", json={"builtin": "cornell"}).json()
    assert [scene["id"] for scene in client.get("/v1/scenes").json()["scenes"]] == [second["id"]]
    assert client.get(first["links"]["self"]).status_code == 404


def test_an_environment_makes_room_for_newer_ones(make_client: MakeClient) -> None:
    client = make_client(environment_disk_bytes=1)
    for name in ("studio", "gradient"):
        client.post("/v1/environments", json={"builtin": name})
    assert len(client.get("/v1/environments").json()["environments"]) == 1
