"""Filtered maps over HTTP: forms of the answer, and what is refused."""

import io
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from PIL import Image

import raysvc
from tests.api.conftest import MakeClient

PATH = "/v1/environments/builtin:gradient/filtered"
SMALL: Mapping[str, Any] = {"width": 32, "roughness": [0.5]}


def exr_channels(data: bytes, folder: Any) -> dict[str, np.ndarray]:
    import OpenEXR

    file = folder / "answer.exr"
    file.write_bytes(data)
    with OpenEXR.File(str(file), separate_channels=True) as opened:
        return {name: np.array(channel.pixels) for name, channel in opened.channels().items()}


def test_one_map_is_a_picture_that_reads_back(client: TestClient) -> None:
    turned = {"environment_yaw_deg": 25, "environment_strength": 3}
    response = client.post(PATH, json={**SMALL, **turned})
    assert response.status_code == 200, response.text
    assert response.headers["content-type"] == "image/x-exr"
    found = raysvc.load_environment({"answer.exr": response.content}).radiance
    gradient = raysvc.load_environment("builtin:gradient")
    expected = raysvc.filtered_map(gradient, 0.5, 32, 16, yaw_deg=25.0, strength=3.0)
    np.testing.assert_array_equal(found, expected)


def test_several_maps_are_layers_or_arrays(client: TestClient, tmp_path: Any) -> None:
    body = {"width": 16, "height": 16, "roughness": [0.25, 1], "irradiance": True}
    layers = exr_channels(client.post(PATH, json=body).content, tmp_path)
    assert set(layers) == {
        f"{name}.{channel}"
        for name in ("roughness_0_25", "roughness_1", "irradiance")
        for channel in "RGB"
    }
    npz = client.post(PATH, json=body, headers={"Accept": "application/x-npz"})
    with np.load(io.BytesIO(npz.content)) as maps:
        assert list(maps) == ["roughness_0_25", "roughness_1", "irradiance"]
        np.testing.assert_array_equal(maps["irradiance"][..., 1], layers["irradiance.G"])
        np.testing.assert_allclose(maps["irradiance"], math.pi * maps["roughness_1"], rtol=1e-5)


def test_an_environment_that_was_sent_is_filtered(client: TestClient) -> None:
    grey = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n" + bytes([128, 128, 128, 128]) * 2
    sent = client.post("/v1/environments", files={"file": ("grey.hdr", grey)}).json()
    response = client.post(f"{sent['links']['self']}/filtered", json={**SMALL, "format": "npz"})
    with np.load(io.BytesIO(response.content)) as maps:
        np.testing.assert_allclose(maps["roughness_0_5"], 0.5, rtol=0.01)


@pytest.mark.parametrize(
    ("accept", "media_type"),
    [
        ("image/png", "image/png"),
        ("image/vnd.radiance, */*;q=0.1", "image/vnd.radiance"),
        ("image/*", "image/x-exr"),
    ],
)
def test_the_answer_is_what_is_accepted(client: TestClient, accept: str, media_type: str) -> None:
    response = client.post(PATH, json=dict(SMALL), headers={"Accept": accept})
    assert (response.status_code, response.headers["content-type"]) == (200, media_type)
    assert response.headers["vary"] == "Accept"
    if media_type == "image/png":
        assert Image.open(io.BytesIO(response.content)).size == (32, 16)


def test_as_json_it_is_nine_harmonics(client: TestClient) -> None:
    body = {"environment_yaw_deg": 70, "environment_strength": 0.5}
    response = client.post(PATH, json=body, headers={"Accept": "application/json"})
    assert response.status_code == 200, response.text
    gradient = raysvc.load_environment("builtin:gradient")
    assert response.json() == raysvc.sh9(gradient, 70.0, 0.5).to_dict()
    assert client.post(PATH, json={**body, "format": "json"}).json() == response.json()


@pytest.mark.parametrize(
    ("body", "status", "field"),
    [
        ({}, 422, "roughness"),
        ({"roughness": [1.1]}, 422, "roughness"),
        ({"roughness": 0.5}, 422, "roughness"),
        ({"roughness": [0.5, 0.5]}, 422, "roughness"),
        ({"roughness": [n / 20 for n in range(17)]}, 422, "roughness"),
        ({"roughness": [0.5], "width": 0}, 422, "width"),
        ({"roughness": [0.5], "width": 5000}, 422, "width"),
        ({"roughness": [0.5], "width": 8, "height": 9}, 422, "height"),
        ({"roughness": [0.5], "width": 8, "height": 2000}, 422, "height"),
        ({"roughness": [0.5], "width": 1 << 12, "height": 1 << 10}, 413, "width"),
        ({"roughness": [0.5], "format": "gif"}, 422, "format"),
        ({"roughness": [0.5], "irradiance": True, "width": 8, "format": "png"}, 422, "format"),
        ({"roughness": [0.5], "colour": 1}, 422, "colour"),
        ({"roughness": [0.5], "format": "json"}, 422, "roughness"),
        ({"irradiance": True, "format": "json"}, 422, "irradiance"),
        ({"width": 64, "format": "json"}, 422, "width"),
        ({"height": 64, "format": "json"}, 422, "height"),
    ],
)
def test_wrong_bodies_are_refused_by_name(
    client: TestClient, body: dict[str, Any], status: int, field: str
) -> None:
    response = client.post(PATH, json=body)
    assert (response.status_code, response.json()["field"]) == (status, field), response.text


def test_all_maps_together_have_a_limit(make_client: MakeClient) -> None:
    client = make_client(max_filtered_texels=1000)
    assert client.post(PATH, json={"width": 32, "roughness": [0.5]}).status_code == 200
    response = client.post(PATH, json={"width": 32, "roughness": [0.4, 0.5]})
    assert response.status_code == 413
    assert "1,000" in response.json()["detail"]


def test_work_ends_at_the_deadline(make_client: MakeClient) -> None:
    response = make_client(deadline_s=1e-9).post(PATH, json=dict(SMALL))
    assert (response.status_code, response.json()["retryable"]) == (422, True)


def test_what_is_not_there_or_not_acceptable_is_said(client: TestClient) -> None:
    assert client.post("/v1/environments/nothing/filtered", json=dict(SMALL)).status_code == 404
    response = client.post("/v1/environments/builtin:moon/filtered", json=dict(SMALL))
    assert (response.status_code, response.json()["field"]) == (422, "environment")
    response = client.post(PATH, json=dict(SMALL), headers={"Accept": "text/html"})
    assert response.status_code == 406
