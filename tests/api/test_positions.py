import io
import zipfile

import numpy as np
import pytest
from fastapi.testclient import TestClient

from tests.api.conftest import MakeClient
from tests.api.glb import POSITIONS, glb

TRIANGLE = np.frombuffer(POSITIONS, np.float32).reshape(3, 3)
BENT = TRIANGLE + np.float32([[0, 0, 1], [0, 0, 0], [0.5, 0, 0]])


@pytest.fixture
def link(client: TestClient) -> str:
    scene = client.post("/v1/scenes", files={"file": ("triangle.glb", glb())}).json()
    return str(scene["links"]["positions"])


def npy(array: np.ndarray) -> bytes:
    file = io.BytesIO()
    np.save(file, array)
    return file.getvalue()


def npz(**arrays: np.ndarray) -> bytes:
    file = io.BytesIO()
    np.savez_compressed(file, **arrays)
    return file.getvalue()


def test_positions_come_as_npy_in_the_order_in_which_they_are_taken(
    client: TestClient, link: str
) -> None:
    response = client.get(link)
    assert response.headers["Content-Type"] == "application/x-npy"
    positions = np.load(io.BytesIO(response.content))
    assert positions.dtype == np.float32
    np.testing.assert_array_equal(positions, TRIANGLE)
    etag = response.headers["ETag"]
    assert client.get(link, headers={"If-None-Match": etag}).status_code == 304
    # What is sent back as it came is the scene as it was.
    same = client.put(link, content=response.content)
    assert same.status_code == 200
    assert same.json()["links"]["positions"] == link


def test_moved_positions_are_a_new_scene_and_the_old_one_stays(
    client: TestClient, link: str
) -> None:
    scene = client.get(link.removesuffix("/positions")).json()
    response = client.put(link, content=npy(BENT))
    assert response.status_code == 201
    moved = response.json()
    assert response.headers["Location"] == moved["links"]["self"] == f"/v1/scenes/{moved['id']}"
    assert moved["rest"] == scene["id"]
    assert moved["links"]["rest"] == scene["links"]["self"]
    assert moved["bounds"]["max"] == BENT.max(axis=0).tolist()
    assert (moved["triangles"], moved["vertices"], moved["builtin"]) == (1, 3, None)
    assert client.get(moved["links"]["self"]).json() == moved
    assert client.get(link.removesuffix("/positions")).json() == scene
    assert scene["rest"] is None and "rest" not in scene["links"]
    there = np.load(io.BytesIO(client.get(moved["links"]["positions"]).content))
    np.testing.assert_array_equal(there, BENT)
    listed = client.get("/v1/scenes").json()["scenes"]
    assert {each["id"] for each in listed} == {scene["id"], moved["id"]}


@pytest.mark.parametrize(
    ("body", "kind"),
    [
        (npy(BENT), "application/x-npy"),
        (npy(BENT.astype(">f8")), "application/octet-stream; charset=binary"),
        (npz(positions=BENT), "application/x-npz"),
        (npz(positions=BENT), "application/zip"),
        (BENT.tobytes(), "application/octet-stream"),
        (BENT.tobytes(), ""),
    ],
)
def test_every_form_of_the_same_numbers_is_the_same_scene(
    client: TestClient, link: str, body: bytes, kind: str
) -> None:
    first = client.put(link, content=npy(BENT))
    again = client.put(link, content=body, headers={"Content-Type": kind} if kind else {})
    assert (first.status_code, again.status_code) == (201, 200)
    assert again.json() == first.json()
    assert again.headers["Location"] == first.headers["Location"]
    # Also when they are sent for the shape that was made.
    last = client.put(first.json()["links"]["positions"], content=body)
    assert (last.status_code, last.json()["id"]) == (200, first.json()["id"])


def test_normals_may_be_sent_along(client: TestClient, link: str) -> None:
    without = client.put(link, content=npz(positions=BENT)).json()
    given = client.put(link, content=npz(positions=BENT, normals=BENT + 1))
    assert given.status_code == 201
    assert given.json()["id"] != without["id"]
    wrong = client.put(link, content=npz(positions=BENT, normals=0 * BENT))
    assert (wrong.status_code, wrong.json()["field"]) == (422, "normals")


@pytest.mark.parametrize(
    ("body", "field", "says"),
    [
        (b"", "positions", "36 bytes"),
        (BENT.tobytes()[:-4], "positions", "three float32 for each of 3 vertices; has 32 bytes"),
        (npy(BENT[:2]), "positions", "needs the shape (3, 3), has (2, 3)"),
        (npy(BENT * np.float32(np.nan)), "positions", "NaN or infinite values at vertex 0"),
        (npy(BENT + np.float32(1e30)), "positions", "beyond 1e+18"),
        (npy(np.array([[object()] * 3] * 3)), "positions", "needs real numbers"),
        (npz(position=BENT), "positions", "holds 'position.npy'"),
        (b"PK\x03\x04 and then nothing", "archive", "broken archive"),
    ],
)
def test_wrong_positions_are_a_problem_that_says_what_is_wrong(
    client: TestClient, link: str, body: bytes, field: str, says: str
) -> None:
    response = client.put(link, content=body)
    problem = response.json()
    assert response.status_code == 422
    assert response.headers["content-type"] == "application/problem+json"
    assert problem["type"] == "urn:raysvc:problem:invalid-scene"
    assert (problem["field"], problem["instance"]) == (field, link)
    assert says in problem["detail"]
    assert len(client.get("/v1/scenes").json()["scenes"]) == 1


def test_no_more_is_read_than_the_vertices_can_need(client: TestClient, link: str) -> None:
    announced = client.put(link, content=b"\0" * 100_000)
    streamed = client.put(link, content=iter([b"\0" * 50_000] * 2))
    for response in (announced, streamed):
        assert (response.status_code, response.json()["field"]) == (413, "body")
        assert "36,784 bytes" in response.json()["detail"]
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("positions.npy", b"\0" * (10 << 20))
    bomb = client.put(link, content=file.getvalue())
    assert (bomb.status_code, bomb.json()["field"]) == (413, "archive/positions.npy")


@pytest.mark.parametrize("kind", ["application/json", "multipart/form-data", "text/plain"])
def test_bodies_of_another_kind_are_refused(client: TestClient, link: str, kind: str) -> None:
    response = client.put(link, content=npy(BENT), headers={"Content-Type": kind})
    assert response.status_code == 415
    assert "application/octet-stream" in response.json()["detail"]


def test_what_is_not_there_has_no_positions(client: TestClient, link: str) -> None:
    nowhere = "/v1/scenes/" + "0" * 64 + "/positions"
    assert client.get(nowhere).status_code == 404
    assert client.put(nowhere, content=npy(BENT)).status_code == 404
    assert client.delete(link.removesuffix("/positions")).status_code == 204
    assert client.get(link).status_code == 404


def test_a_moved_scene_outlives_the_one_it_was_made_from(
    make_client: MakeClient, client: TestClient, link: str
) -> None:
    moved = client.put(link, content=npy(BENT)).json()
    client.delete(link.removesuffix("/positions"))
    again = make_client()
    assert again.get(moved["links"]["self"]).json() == moved
    np.testing.assert_array_equal(
        np.load(io.BytesIO(again.get(moved["links"]["positions"]).content)), BENT
    )
    assert again.get(moved["links"]["rest"]).status_code == 404
