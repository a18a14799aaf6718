"""The real renderer behind the real application."""

import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from PIL import Image

import raysvc
from api.app import create_app
from api.settings import ApiSettings
from tests.api.glb import glb

CAMERA = {"width": 32, "height": 18}


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    settings = ApiSettings(data_dir=tmp_path_factory.mktemp("data"))
    with TestClient(create_app(settings)) as client:
        yield client


def rendered(client: TestClient, **body: Any) -> dict[str, Any]:
    body = {"camera": CAMERA, **body}
    response = client.post("/v1/renders", json=body, headers={"Prefer": "wait=60"})
    assert response.status_code == 200, response.text
    resource: dict[str, Any] = response.json()
    assert resource["state"] == "done", resource["error"]
    return resource


def test_an_uploaded_file_becomes_a_picture(client: TestClient) -> None:
    scene = client.post("/v1/scenes", files={"file": ("triangle.glb", glb())}).json()
    resource = rendered(client, scene=scene["id"])
    with Image.open(io.BytesIO(client.get(resource["links"]["image"]).content)) as picture:
        assert picture.size == (32, 18)
        assert len(picture.convert("RGB").getcolors() or []) > 10
    names = [stage["name"] for stage in resource["statistics"]["stages"]]
    assert {"rasterise", "light"} <= set(names)
    assert resource["statistics"]["total_seconds"] > 0


def test_the_service_gives_the_library_s_picture(client: TestClient) -> None:
    resource = rendered(client, scene="builtin:cornell", settings={"seed": 7})
    scene = raysvc.load("builtin:cornell")
    frame = raysvc.render(scene, camera=CAMERA, settings={"seed": 7, "threads": 1})
    assert client.get(resource["links"]["image"]).content == frame.encode("png")


def test_an_animation_moves_trees_and_gives_the_library_s_pictures(client: TestClient) -> None:
    scene = raysvc.load("builtin:cornell")
    id = client.post("/v1/scenes", json={"builtin": "cornell"}).json()["id"]
    settings = {"structure": "bvh", "occlusion_samples": 4}
    link = f"/v1/scenes/{id}/positions"
    positions = np.load(io.BytesIO(client.get(link).content))
    for frame in range(3):
        moved = positions * np.float32([1, 1 - 0.05 * frame, 1])
        shape = client.put(link, content=moved.astype("<f4").tobytes()).json()
        resource = rendered(client, scene=shape["id"], settings=settings)
        expected = raysvc.render(scene.deformed(moved), camera=CAMERA, settings=settings)
        assert client.get(resource["links"]["image"]).content == expected.encode("png")
        build = resource["statistics"]["build"]
        assert build["refitted"] == (frame > 0)
        assert (build["sah_ratio"] == 1.0) == (frame == 0)


def test_all_layers_can_be_had(client: TestClient) -> None:
    link = rendered(client, scene="builtin:cornell")["links"]["image"]
    response = client.get(link, params={"format": "npz"})
    with np.load(io.BytesIO(response.content)) as layers:
        assert {"beauty", "depth", "normal", "albedo", "id"} <= set(layers.files)
        for layer in layers.files:
            picture = client.get(link, params={"layer": layer})
            assert picture.status_code == 200
            assert picture.content.startswith(b"\x89PNG")
    exr = client.get(link, params={"format": "exr"})
    assert exr.headers["Content-Type"] == "image/x-exr"
    assert exr.content.startswith(b"\x76\x2f\x31\x01")


def test_a_render_with_a_deadline_that_cannot_be_met_fails(client: TestClient) -> None:
    body = {
        "scene": "builtin:shiny",
        "camera": {"width": 640, "height": 360},
        "settings": {"deadline_s": 0.01, "aa": "full", "seed": 3},
    }
    response = client.post("/v1/renders", json=body, headers={"Prefer": "wait=60"})
    assert response.json()["state"] == "failed"
    assert response.json()["error"]["type"] == "urn:raysvc:problem:deadline-exceeded"


def test_the_service_is_ready_after_its_first_picture(client: TestClient) -> None:
    rendered(client, scene="builtin:cornell")
    assert client.get("/readyz").json() == {"status": "ready"}


@pytest.mark.assets
def test_a_real_scene_under_a_real_sky_becomes_a_picture(client: TestClient, assets: Path) -> None:
    files = [
        ("scene", (path.name, path.read_bytes()))
        for path in sorted((assets / "gltf" / "FlightHelmet").iterdir())
    ]
    sky = assets / "hdr" / "venice_sunset_1k.hdr"
    files.append(("environment", (sky.name, sky.read_bytes())))
    response = client.post(
        "/v1/render?format=webp", files=files, data={"camera": '{"width": 64, "height": 64}'}
    )
    assert response.status_code == 200, response.text
    with Image.open(io.BytesIO(response.content)) as picture:
        assert picture.size == (64, 64)
    assert "rasterise;dur=" in response.headers["Server-Timing"]
