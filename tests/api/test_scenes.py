import io
import time
import zipfile
from pathlib import Path

import pytest
from fastapi.testclient import TestClient

from raysvc.jobs import PatternRenderer
from tests.api.conftest import MakeClient
from tests.api.glb import POSITIONS, glb, gltf


def test_a_scene_file_becomes_a_resource(client: TestClient) -> None:
    response = client.post("/v1/scenes", files={"file": ("triangle.glb", glb())})
    assert response.status_code == 201
    body = response.json()
    assert len(body["id"]) == 64
    assert response.headers["Location"] == f"/v1/scenes/{body['id']}"
    assert (body["triangles"], body["vertices"], body["warnings"]) == (1, 3, [])
    assert body["bounds"] == {"min": [0, 0, 0], "max": [1, 1, 0]}
    assert client.get(body["links"]["self"]).json() == body


def test_sending_a_scene_twice_is_one_resource(client: TestClient) -> None:
    first = client.post("/v1/scenes", files={"file": ("triangle.glb", glb())})
    second = client.post("/v1/scenes", files={"file": ("triangle.glb", glb())})
    assert (first.status_code, second.status_code) == (201, 200)
    assert first.json() == second.json()
    assert [scene["id"] for scene in client.get("/v1/scenes").json()["scenes"]] == [
        first.json()["id"]
    ]


def test_side_files_keep_their_relative_names(client: TestClient) -> None:
    files = [
        ("file", ("scene.gltf", gltf("buffers/points.bin"))),
        ("file", ("buffers/points.bin", POSITIONS)),
    ]
    response = client.post("/v1/scenes", files=files)
    assert response.status_code == 201, response.text
    assert response.json()["triangles"] == 1


def test_an_archive_is_opened(client: TestClient) -> None:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        archive.writestr("model/scene.gltf", gltf("points.bin"))
        archive.writestr("model/points.bin", POSITIONS)
    response = client.post("/v1/scenes", files={"file": ("scene.zip", packed.getvalue())})
    assert response.status_code == 201, response.text
    assert response.json()["triangles"] == 1


def test_of_several_scenes_main_says_which(client: TestClient) -> None:
    files = [("file", ("a.glb", glb())), ("file", ("b.glb", glb()))]
    refused = client.post("/v1/scenes", files=files)
    assert (refused.status_code, refused.json()["field"]) == (422, "main")
    chosen = client.post("/v1/scenes", files=files, data={"main": "b.glb"})
    assert chosen.status_code == 201


def test_a_built_in_scene_is_asked_for_by_name(client: TestClient) -> None:
    response = client.post("/v1/scenes", json={"builtin": "cornell"})
    assert response.status_code == 201
    assert response.json()["builtin"] == "cornell"
    assert client.post("/v1/scenes", json={"builtin": "cornell"}).status_code == 200


@pytest.mark.parametrize(
    ("body", "field"),
    [
        ({"builtin": "atlantis"}, "builtin"),
        ({"builtin": 3}, "body.builtin"),
        ({"builtin": "cornell", "scale": 2}, "body.scale"),
        ({}, "body.builtin"),
    ],
)
def test_a_wrong_built_in_name_is_refused(
    client: TestClient, body: dict[str, object], field: str
) -> None:
    response = client.post("/v1/scenes", json=body)
    assert (response.status_code, response.json()["field"]) == (422, field)


def test_scenes_are_known_after_a_restart(make_client: MakeClient) -> None:
    before = make_client().post("/v1/scenes", files={"file": ("triangle.glb", glb())}).json()
    assert make_client().get(f"/v1/scenes/{before['id']}").json() == before


def test_a_deleted_scene_is_gone(client: TestClient) -> None:
    link = client.post("/v1/scenes", json={"builtin": "cornell"}).json()["links"]["self"]
    assert client.delete(link).status_code == 204
    assert client.get(link).status_code == 404
    assert client.delete(link).status_code == 404


def test_a_form_without_a_file_or_with_unknown_fields_is_refused(client: TestClient) -> None:
    unknown = client.post("/v1/scenes", files={"scene": ("triangle.glb", glb())})
    assert (unknown.status_code, unknown.json()["field"]) == (422, "scene")
    nothing = client.post("/v1/scenes", files={"file": ("", b"")}, data={"main": "x.glb"})
    assert nothing.status_code in (400, 422)


def test_the_same_name_twice_in_a_form_is_refused(client: TestClient) -> None:
    files = [("file", ("a.glb", glb())), ("file", ("a.glb", glb()))]
    response = client.post("/v1/scenes", files=files)
    assert (response.status_code, response.json()["field"]) == (422, "file")


def test_too_much_is_refused_whether_announced_or_not(
    make_client: MakeClient, tmp_path: Path
) -> None:
    client = make_client(max_upload_bytes=1000)
    large = b"x" * (3 << 20)
    announced = client.post("/v1/scenes", files={"file": ("large.glb", large)})
    assert announced.status_code == 413
    assert announced.headers["content-type"] == "application/problem+json"
    assert announced.json()["field"] == "body"

    body = b'--b\r\nContent-Disposition: form-data; name="file"; filename="a.glb"\r\n\r\n' + large
    streamed = client.post(
        "/v1/scenes",
        content=iter([body, b"\r\n--b--\r\n"]),
        headers={"Content-Type": "multipart/form-data; boundary=b"},
    )
    assert streamed.status_code == 413
    barely = client.post("/v1/scenes", files={"file": ("large.glb", large[:2000])})
    assert barely.status_code == 413
    assert client.get("/v1/scenes").json() == {"scenes": []}
    assert list((tmp_path / "scenes" / "incoming").iterdir()) == []


def test_too_many_files_are_refused(make_client: MakeClient) -> None:
    client = make_client(max_upload_files=3)
    files = [("file", (f"{n}.bin", b"x")) for n in range(5)]
    assert client.post("/v1/scenes", files=files).status_code == 413


def test_a_scene_that_a_job_needs_is_not_deleted(make_client: MakeClient) -> None:
    client = make_client(PatternRenderer(seconds=30.0, steps=3000))
    job = client.post("/v1/renders", json={"scene": "builtin:cornell"}).json()
    path = f"/v1/scenes/{job['scene']}"
    refused = client.delete(path)
    assert (refused.status_code, refused.json()["type"]) == (409, "urn:raysvc:problem:in-use")
    assert refused.json()["retryable"] is True
    client.delete(job["links"]["self"])
    while client.get(job["links"]["self"]).json()["state"] == "running":
        time.sleep(0.01)
    assert client.delete(path).status_code == 204
