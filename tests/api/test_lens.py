"""A picture and its depth in, the picture through a lens out."""

import asyncio
import io
import json
import time

import numpy as np
import pytest
from fastapi.testclient import TestClient
from PIL import Image

from raysvc.errors import Cancelled
from raysvc.imaging.encode_layers import encode_exr, encode_npz
from raysvc.parallel import Control
from tests.api.conftest import MakeClient

LENS = {"fov_y_deg": 40, "aperture_radius": 0.4, "focus_distance": 4.0}


def sharp() -> tuple[np.ndarray, np.ndarray]:
    """A white square, near, before black at infinity; and its depth."""
    picture = np.zeros((24, 32, 4), np.float32)
    picture[..., 3] = 1.0
    depth = np.full((24, 32), np.inf, np.float32)
    picture[8:16, 12:20, :3], depth[8:16, 12:20] = 1.0, 2.0
    return picture, depth


def png(values: np.ndarray) -> bytes:
    out = io.BytesIO()
    Image.fromarray(values).save(out, "PNG")
    return out.getvalue()


def post(client: TestClient, files: dict, query: str = "?format=npz", **texts: object):
    data = {"camera": json.dumps(LENS)} | {
        name: text if isinstance(text, str) else json.dumps(text) for name, text in texts.items()
    }
    named = {field: (field, content) for field, content in files.items()}
    return client.post(f"/v1/lens{query}", files=named, data=data)


def beauty(response) -> np.ndarray:
    assert response.status_code == 200, response.text
    with np.load(io.BytesIO(response.content)) as layers:
        return layers["beauty"]


def test_every_form_of_picture_and_depth_gives_the_same_blur(client: TestClient) -> None:
    picture, depth = sharp()
    layers = {"beauty": picture, "depth": depth}
    grey = np.where(np.isfinite(depth), depth / 0.001, 0).astype(np.uint16)
    white = (picture * 255).astype(np.uint8)
    one = beauty(post(client, {"picture": encode_exr(layers)}))
    assert 0.05 < one[12, 10, 0] < 0.95
    others = [
        post(client, {"picture": encode_npz(layers)}),
        post(client, {"picture": encode_exr({"beauty": picture}), "depth": encode_npz(layers)}),
        post(client, {"picture": png(white), "depth": png(grey)}, depth_scale_m="0.001"),
        post(client, {"picture": png(white[..., :3]), "depth": encode_exr({"depth": depth})}),
    ]
    for other in others:
        assert np.allclose(beauty(other), one, atol=2e-3)


def test_settings_and_focus_have_an_effect(client: TestClient) -> None:
    picture, depth = sharp()
    files = {"picture": encode_npz({"beauty": picture, "depth": depth})}
    plain = beauty(post(client, files))
    for settings in (
        {"aperture_blades": 3},
        {"lens_shape": "box"},
        {"lens_order": 3},
        {"lens": "gather"},
    ):
        assert not np.array_equal(beauty(post(client, files, settings=settings)), plain), settings
    assert np.array_equal(beauty(post(client, files, settings={"lens": "none"})), picture)
    slanted = {"beauty": picture, "depth": depth * np.linspace(0.3, 1.7, 32, dtype=np.float32)}
    files_too = {"picture": encode_npz(slanted)}
    few = beauty(post(client, files_too, settings={"lens_layers": 1}))
    assert not np.array_equal(few, beauty(post(client, files_too)))
    at_square = {"fov_y_deg": 40, "aperture_radius": 0.4, "focus_pixel": [16, 12]}
    focused = beauty(post(client, files, camera=at_square))
    assert np.array_equal(focused[8:16, 12:20], picture[8:16, 12:20])
    middle = {"fov_y_deg": 40, "aperture_radius": 0.4}
    assert np.array_equal(beauty(post(client, files, camera=middle)), focused)
    by_number = {"focal_length_mm": 400, "f_number": 1.0, "focus_distance": 4.0}
    assert not np.array_equal(beauty(post(client, files, camera=by_number)), plain)


def test_the_picture_comes_in_the_form_that_is_asked_for(client: TestClient) -> None:
    picture, depth = sharp()
    files = {"picture": ("p", encode_npz({"beauty": picture, "depth": depth}))}
    data = {"camera": json.dumps(LENS)}
    response = client.post("/v1/lens", files=files, data=data, headers={"Accept": "image/webp"})
    assert response.headers["Content-Type"] == "image/webp"
    assert response.headers["Server-Timing"].startswith("lens;dur=")
    statistics = json.loads(response.headers["X-Raysvc-Statistics"])
    assert (statistics["width"], statistics["height"]) == (32, 24)
    assert statistics["max_coc_px"] > 2
    shown = client.post("/v1/lens?layer=coc", files=files, data=data)
    assert shown.headers["Content-Type"] == "image/png"
    assert (
        client.post("/v1/lens", files=files, data=data, headers={"Accept": "text/html"}).status_code
        == 406
    )


PICTURE, DEPTH = sharp()
BOTH = encode_npz({"beauty": PICTURE, "depth": DEPTH})
BELOW = np.where(np.isfinite(DEPTH), -DEPTH, DEPTH)


@pytest.mark.parametrize(
    ("files", "texts", "status", "field"),
    [
        ({}, {}, 422, "picture"),
        ({"picture": b"GIF89a"}, {}, 422, "depth"),
        ({"picture": b"GIF89a", "depth": BOTH}, {}, 422, "picture"),
        ({"picture": b"PK\x03\x04 broken"}, {}, 422, "picture"),
        ({"picture": b"\x76\x2f\x31\x01 broken"}, {}, 422, "picture"),
        ({"picture": png(np.zeros((4, 4, 3), np.uint8))}, {}, 422, "depth"),
        ({"picture": BOTH, "depth": png(np.ones((24, 32), np.uint8))}, {}, 422, "depth"),
        ({"picture": BOTH, "depth": png(np.ones((24, 32, 3), np.uint8))},
         {"depth_scale_m": "1"}, 422, "depth"),
        ({"picture": BOTH}, {"depth_scale_m": "-1"}, 422, "depth_scale_m"),
        ({"picture": BOTH, "depth": encode_npz({"depth": DEPTH[:5]})}, {}, 422, "depth"),
        ({"picture": BOTH, "depth": encode_npz({"depth": BELOW})}, {}, 422, "depth"),
        ({"picture": encode_npz({"a": PICTURE, "b": PICTURE})}, {}, 422, "picture"),
        ({"picture": BOTH}, {"camera": "{"}, 400, "camera"),
        ({"picture": BOTH}, {"camera": {}}, 422, "camera.focus_pixel"),
        ({"picture": BOTH}, {"camera": {"focus_distance": 2}}, 422, "camera.aperture_radius"),
        ({"picture": BOTH}, {"camera": {"eye": [0, 0, 0]}}, 422, "camera.eye"),
        ({"picture": BOTH}, {"camera": LENS | {"focus_pixel": [1, 1]}}, 422,
         "camera.focus_distance"),
        ({"picture": BOTH}, {"settings": {"bounces": 2}}, 422, "settings.bounces"),
        ({"picture": BOTH}, {"settings": {"aperture_blades": 1}}, 422, "settings.aperture_blades"),
        ({"picture": BOTH}, {"colour": "red"}, 422, "colour"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_refused_by_name(client, files, texts, status, field) -> None:
    if field == "camera.focus_pixel":
        empty = np.full_like(DEPTH, np.inf)
        files = {"picture": encode_npz({"beauty": PICTURE, "depth": empty})}
    files = files or {"depth": BOTH}
    response = post(client, files, "", **texts)
    assert response.status_code == status, response.text
    assert response.json()["field"] == field


def test_a_picture_over_the_limit_is_refused_before_it_is_blurred(make_client: MakeClient) -> None:
    client = make_client(max_image_pixels=100)
    for picture in (BOTH, encode_exr({"beauty": PICTURE, "depth": DEPTH})):
        response = post(client, {"picture": picture})
        assert (response.status_code, response.json()["field"]) == (413, "picture")


def test_a_body_of_another_kind_is_refused(client: TestClient) -> None:
    assert client.post("/v1/lens", json={}).status_code == 415


def test_a_client_that_goes_away_stops_it(client: TestClient, monkeypatch) -> None:
    stopped = []

    def endless(*_, control: Control) -> None:
        try:
            for _ in range(200):
                control.check()
                time.sleep(0.05)
        except Cancelled:
            stopped.append(True)
            raise

    monkeypatch.setattr("api.routes.lens.refocus", endless)
    files = {"picture": ("p", BOTH)}
    asked = client.build_request("POST", "/v1/lens", files=files, data={"camera": json.dumps(LENS)})
    received = [
        {"type": "http.request", "body": asked.read(), "more_body": False},
        {"type": "http.disconnect"},
    ]
    scope = {
        "type": "http",
        "method": "POST",
        "path": "/v1/lens",
        "query_string": b"",
        "headers": [(name.lower(), value) for name, value in asked.headers.raw],
    }

    async def receive() -> dict:
        return received.pop(0) if len(received) > 1 else received[0]

    async def send(message: dict) -> None:
        pass

    asyncio.run(client.app(scope, receive, send))
    assert stopped == [True]
