"""Environments that are captured from a point of the scene, over HTTP."""

import json
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from api.app import create_app
from api.settings import ApiSettings
from tests.api.glb import glb
from tests.api.test_environments import GREY_HDR

CAMERA = {"width": 8, "height": 4}
SMALL = {"scene": "builtin:cornell", "camera": CAMERA}
PROBE = {"probe_at": [0.0, 1.0, 0.0], "size": 16, "without": [0]}


def asked(client: TestClient, probe: dict[str, Any], **settings: Any) -> Any:
    body = {**SMALL, "environment": probe, "settings": settings}
    return client.post("/v1/renders", json=body, headers={"Prefer": "wait=60"})


def test_a_render_with_a_probe_says_what_it_was_asked_for(client: TestClient) -> None:
    resource = asked(client, {**PROBE, "environment": "builtin:studio"}).json()
    studio = client.get("/v1/environments").json()["environments"][0]["id"]
    assert resource["state"] == "done"
    assert resource["environment"] == {**PROBE, "environment": studio}
    assert asked(client, PROBE).json()["environment"] == {**PROBE, "environment": None}


@pytest.mark.parametrize(
    ("probe", "settings", "status", "field"),
    [
        ({}, {}, 422, "environment.probe_at"),
        ({**PROBE, "size": 1024}, {}, 422, "environment.size"),
        ({**PROBE, "colour": "red"}, {}, 422, "environment.colour"),
        ({**PROBE, "without": ["chair"]}, {}, 422, "environment.without"),
        ({**PROBE, "environment": "builtin:atlantis"}, {}, 422, "environment.environment"),
        ({**PROBE, "environment": "0" * 64}, {}, 404, None),
        ({**PROBE, "environment": {}}, {}, 422, "environment.environment"),
        (PROBE, {"bounces": 1}, 422, "settings.bounces"),
        (PROBE, {"mode": "reference"}, 422, "environment"),
    ],
)
def test_what_is_wrong_is_named(
    client: TestClient, probe: dict[str, Any], settings: dict[str, Any], status: int, field: str
) -> None:
    response = asked(client, probe, **settings)
    assert response.status_code == status, response.text
    if field is not None:
        assert response.json()["field"] == field


def test_a_form_may_hold_a_probe_beside_an_environment_s_file(client: TestClient) -> None:
    files = [("scene", ("scene.glb", glb())), ("environment", ("grey.hdr", GREY_HDR))]
    data = {"camera": json.dumps(CAMERA), "probe": json.dumps(PROBE)}
    response = client.post("/v1/render", files=files, data=data)
    assert response.status_code == 200, response.text
    link = response.headers["Link"].partition(">")[0].lstrip("<")
    grey = client.get("/v1/environments").json()["environments"][0]["id"]
    assert client.get(link).json()["environment"] == {**PROBE, "environment": grey}
    named = {**PROBE, "environment": "builtin:studio"}
    response = client.post("/v1/render", files=files, data={**data, "probe": json.dumps(named)})
    assert (response.status_code, response.json()["field"]) == (422, "environment")


def test_the_service_s_own_renderer_captures_it(tmp_path: Path) -> None:
    with TestClient(create_app(ApiSettings(data_dir=tmp_path))) as client:
        probe = {"probe_at": [0.0, 1.0, 0.0], "size": 16}
        statistics = asked(client, probe, occlusion_samples=4).json()["statistics"]
        assert statistics["probe"]["at"] == probe["probe_at"]
        assert statistics["probe"]["rebuilt"] is True
        again = asked(client, probe, occlusion_samples=4, exposure_stops=1.0).json()["statistics"]
        assert again["probe"]["rebuilt"] is False
