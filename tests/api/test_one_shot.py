import json
import time

import pytest
from fastapi.testclient import TestClient

from raysvc.errors import DeadlineExceeded
from raysvc.jobs import PatternRenderer
from tests.api.conftest import MakeClient
from tests.api.glb import POSITIONS, glb, gltf
from tests.api.test_environments import GREY_HDR

CAMERA = json.dumps({"width": 8, "height": 4})


def test_a_scene_goes_in_and_a_picture_comes_out(client: TestClient) -> None:
    response = client.post(
        "/v1/render", files={"scene": ("triangle.glb", glb())}, data={"camera": CAMERA}
    )
    assert response.status_code == 200, response.text
    assert response.headers["Content-Type"] == "image/png"
    assert response.content.startswith(b"\x89PNG")
    assert response.headers["Server-Timing"].startswith("pattern;dur=")
    assert json.loads(response.headers["X-Raysvc-Statistics"])["width"] == 8
    resource = response.headers["Link"].partition(">")[0].lstrip("<")
    assert client.get(resource).json()["state"] == "done"


def test_side_files_environment_and_settings_go_along(client: TestClient) -> None:
    files = [
        ("scene", ("scene.gltf", gltf("points.bin"))),
        ("scene", ("points.bin", POSITIONS)),
        ("environment", ("grey.hdr", GREY_HDR)),
    ]
    data = {"camera": CAMERA, "settings": json.dumps({"bounces": 2})}
    response = client.post("/v1/render?format=jpg", files=files, data=data)
    assert response.status_code == 200, response.text
    assert response.content.startswith(b"\xff\xd8")


def test_names_do_instead_of_files(client: TestClient) -> None:
    form = client.post(
        "/v1/render",
        files={"scene": (None, "builtin:cornell"), "camera": (None, CAMERA)},
    )
    body = {"scene": "builtin:cornell", "camera": {"width": 8, "height": 4}}
    plain = client.post("/v1/render", json=body)
    assert (form.status_code, plain.status_code) == (200, 200), form.text
    assert form.content == plain.content
    assert form.headers["ETag"] == plain.headers["ETag"]


@pytest.mark.parametrize(
    ("data", "status", "field"),
    [
        ({"camera": "{"}, 400, "camera"),
        ({"camera": '{"eye": [NaN, 0, 0]}'}, 400, "camera.eye.0"),
        ({"camera": '{"width": 0}'}, 422, "camera.width"),
        ({"settings": '{"bounces": "many"}'}, 422, "settings.bounces"),
        ({"colour": "red"}, 422, "colour"),
        ({"environment": "builtin:atlantis"}, 422, "environment"),
    ],
)
def test_what_is_wrong_is_named(
    client: TestClient, data: dict[str, str], status: int, field: str
) -> None:
    response = client.post("/v1/render", files={"scene": ("t.glb", glb())}, data=data)
    assert (response.status_code, response.json()["field"]) == (status, field)


def test_a_form_without_a_scene_is_refused(client: TestClient) -> None:
    response = client.post("/v1/render", files={"camera": (None, CAMERA)})
    assert (response.status_code, response.json()["field"]) == (422, "scene")


def test_a_picture_that_takes_too_long_is_given_up(make_client: MakeClient) -> None:
    slow = PatternRenderer(seconds=30.0, steps=3000)
    body = {"scene": "builtin:cornell", "settings": {"deadline_s": 0.05}}
    response = make_client(slow).post("/v1/render", json=body)
    assert response.status_code == 422
    assert response.json()["retryable"] is True


def test_an_error_of_the_render_is_the_answer(make_client: MakeClient) -> None:
    client = make_client(PatternRenderer(fault=DeadlineExceeded("too slow", field="deadline_s")))
    response = client.post("/v1/render", json={"scene": "builtin:cornell"})
    assert (response.status_code, response.json()["field"]) == (422, "deadline_s")


def test_a_picture_whose_turn_does_not_come_is_not_the_clients_fault(
    make_client: MakeClient,
) -> None:
    client = make_client(PatternRenderer(seconds=30.0, steps=3000), deadline_s=0.5)
    # A render that sets its own deadline may run for longer than others wait.
    long = {"scene": "builtin:cornell", "settings": {"deadline_s": 100}}
    running = client.post("/v1/renders", json=long).headers["Location"]
    while client.get(running).json()["state"] == "queued":
        time.sleep(0.01)
    refused = client.post("/v1/render", json={"scene": "builtin:cornell"})
    assert (refused.status_code, refused.json()["retryable"]) == (429, True)
    assert refused.json()["type"] == "urn:raysvc:problem:busy"
    assert int(refused.headers["Retry-After"]) > 0
