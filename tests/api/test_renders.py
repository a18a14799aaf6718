import time
from typing import Any

import pytest
from fastapi.testclient import TestClient

from raysvc.errors import InvalidSetting
from raysvc.jobs import PatternRenderer
from tests.api.conftest import MakeClient

SMALL = {"scene": "builtin:cornell", "camera": {"width": 8, "height": 4}}
SLOW = PatternRenderer(seconds=30.0, steps=3000)


def body(**camera: Any) -> dict[str, Any]:
    return {**SMALL, "camera": {**SMALL["camera"], **camera}}  # type: ignore[dict-item]


def done(client: TestClient, **camera: Any) -> dict[str, Any]:
    response = client.post("/v1/renders", json=body(**camera), headers={"Prefer": "wait=10"})
    assert response.status_code == 200, response.text
    resource: dict[str, Any] = response.json()
    return resource


def test_a_render_is_accepted_and_can_be_watched(client: TestClient) -> None:
    response = client.post("/v1/renders", json=SMALL)
    assert response.status_code == 202
    link = response.headers["Location"]
    assert link == response.json()["links"]["self"]
    while (resource := client.get(link).json())["state"] in ("queued", "running"):
        time.sleep(0.01)
    assert resource["state"] == "done"
    assert resource["progress"] == 1.0
    assert resource["statistics"]["width"] == 8
    assert resource["links"]["image"] == f"{link}/image"


def test_a_client_may_wait_for_the_picture(client: TestClient) -> None:
    response = client.post("/v1/renders", json=SMALL, headers={"Prefer": "respond-async, wait=10"})
    assert response.status_code == 200
    assert response.headers["Preference-Applied"] == "wait=10"
    assert response.json()["state"] == "done"


def test_a_wait_that_is_too_short_is_answered_as_accepted(make_client: MakeClient) -> None:
    client = make_client(SLOW, wait_max_s=0.1)
    began = time.monotonic()
    response = client.post("/v1/renders", json=SMALL, headers={"Prefer": "wait=60"})
    assert time.monotonic() - began < 5
    assert response.status_code == 202
    assert "Preference-Applied" not in response.headers
    assert response.json()["state"] in ("queued", "running")


def test_a_full_queue_is_answered_at_once(make_client: MakeClient) -> None:
    client = make_client(SLOW, queue_size=1)
    running = client.post("/v1/renders", json=body(width=1)).headers["Location"]
    while client.get(running).json()["state"] == "queued":
        time.sleep(0.01)
    statuses = [client.post("/v1/renders", json=body(width=n)).status_code for n in range(2, 5)]
    assert statuses == [202, 429, 429]
    refused = client.post("/v1/renders", json=SMALL)
    assert int(refused.headers["Retry-After"]) >= 1
    assert refused.json()["retryable"] is True
    assert client.get("/healthz").status_code == 200


def test_a_picture_that_is_not_there_yet_is_a_conflict(make_client: MakeClient) -> None:
    client = make_client(SLOW)
    link = client.post("/v1/renders", json=SMALL).headers["Location"]
    response = client.get(f"{link}/image")
    assert response.status_code == 409
    assert response.json()["type"] == "urn:raysvc:problem:not-finished"
    assert response.json()["retryable"] is True
    client.delete(link)
    while client.get(link).json()["state"] == "running":
        pass
    assert client.get(f"{link}/image").json()["retryable"] is False


def test_a_render_can_be_cancelled_while_it_runs(make_client: MakeClient) -> None:
    client = make_client(SLOW)
    link = client.post("/v1/renders", json=SMALL).headers["Location"]
    while client.get(link).json()["state"] != "running":
        time.sleep(0.01)
    assert client.delete(link).status_code == 202
    while (resource := client.get(link).json())["state"] == "running":
        time.sleep(0.01)
    assert resource["state"] == "cancelled"
    assert client.get(f"{link}/image").status_code == 409


def test_a_render_that_fails_says_why(make_client: MakeClient) -> None:
    client = make_client(PatternRenderer(fault=InvalidSetting("is odd", field="settings.seed")))
    resource = done(client)
    assert resource["state"] == "failed"
    assert resource["error"]["field"] == "settings.seed"
    assert client.get(f"{resource['links']['self']}/image").status_code == 422


def test_the_same_request_again_is_served_from_the_store(make_client: MakeClient) -> None:
    client = make_client(PatternRenderer(seconds=0.3))
    first = done(client)
    began = time.monotonic()
    second = done(client)
    assert time.monotonic() - began < 0.25
    assert second["id"] != first["id"]
    assert second["statistics"] == first["statistics"]


@pytest.mark.parametrize(
    ("accept", "media_type", "magic"),
    [
        ("", "image/png", b"\x89PNG"),
        ("*/*", "image/png", b"\x89PNG"),
        ("image/webp", "image/webp", b"RIFF"),
        ("image/png;q=0.5, image/jpeg", "image/jpeg", b"\xff\xd8"),
    ],
)
def test_the_form_of_a_picture_is_negotiated(
    client: TestClient, accept: str, media_type: str, magic: bytes
) -> None:
    link = done(client)["links"]["image"]
    response = client.get(link, headers={"Accept": accept})
    assert response.status_code == 200
    assert response.headers["Content-Type"] == media_type
    assert response.headers["Vary"] == "Accept"
    assert response.content.startswith(magic)


def test_a_form_that_there_is_not_is_not_acceptable(client: TestClient) -> None:
    link = done(client)["links"]["image"]
    assert client.get(link, headers={"Accept": "text/html"}).status_code == 406
    assert client.get(link, params={"format": "gif"}).status_code == 422
    assert client.get(link, params={"layer": "smell"}).status_code == 422
    assert client.get(link, params={"fromat": "png"}).json()["field"] == "fromat"


def test_a_picture_that_the_client_holds_is_not_sent_again(client: TestClient) -> None:
    link = done(client)["links"]["image"]
    etag = client.get(link).headers["ETag"]
    again = client.get(link, headers={"If-None-Match": f'"other", W/{etag}'})
    assert (again.status_code, again.content) == (304, b"")
    assert again.headers["ETag"] == etag
    assert client.get(link, headers={"If-None-Match": '"other"'}).status_code == 200
    assert client.get(link, params={"format": "jpg"}).headers["ETag"] != etag


def test_a_picture_that_made_room_is_gone(make_client: MakeClient) -> None:
    client = make_client(result_memory_bytes=1, result_disk_bytes=1)
    first = done(client)
    done(client, width=9)
    response = client.get(first["links"]["image"])
    assert response.status_code == 410
    assert response.json()["type"] == "urn:raysvc:problem:gone"


@pytest.mark.parametrize(
    ("change", "status", "field"),
    [
        ({"scene": "f" * 64}, 404, "scene"),
        ({"scene": "builtin:atlantis"}, 422, "scene"),
        ({"scene": 7}, 422, "scene"),
        ({"environment": "builtin:atlantis"}, 422, "environment"),
        ({"environment": "0" * 64}, 404, "environment"),
        ({"camera": {"width": 0}}, 422, "camera.width"),
        ({"camera": {"width": 100_000}}, 422, "camera.width"),
        ({"camera": {"width": 8192, "height": 8192}}, 422, "camera.width"),
        ({"camera": {"eye": [1, 2]}}, 422, "camera.eye"),
        ({"camera": {"eye": [0, 0, 0], "target": [0, 0, 0]}}, 422, "camera.eye"),
        ({"camera": [1]}, 422, "camera"),
        ({"settings": {"bounces": 9}}, 422, "settings.bounces"),
        ({"settings": {"mode": "fast"}}, 422, "settings.mode"),
        ({"settings": {"mode": "reference", "samples": 0}}, 422, "settings.samples"),
        ({"settings": {"colour": "red"}}, 422, "settings.colour"),
        ({"setings": {}}, 422, "setings"),
    ],
)
def test_what_is_wrong_is_named(
    client: TestClient, change: dict[str, Any], status: int, field: str
) -> None:
    response = client.post("/v1/renders", json={**SMALL, **change})
    assert (response.status_code, response.json()["field"]) == (status, field)


def test_the_limit_of_paths_is_the_services(make_client: MakeClient) -> None:
    client = make_client(max_paths=8 * 4 * 16)
    statuses = {}
    for samples in (16, 17):
        settings = {"mode": "reference", "samples": samples}
        response = client.post("/v1/renders", json={**SMALL, "settings": settings})
        statuses[samples] = response.status_code
    assert statuses == {16: 202, 17: 413}
    assert response.json()["field"] == "settings.samples"


def test_an_unknown_render_is_not_found(client: TestClient) -> None:
    for method, path in (("GET", ""), ("GET", "/image"), ("DELETE", "")):
        response = client.request(method, f"/v1/renders/nothing{path}")
        assert (response.status_code, response.json()["field"]) == (404, "render")
