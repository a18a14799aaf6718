"""Every limit, set low, refuses something that passes without it, and names it."""

import base64
import dataclasses
import io
import json
import zipfile
from collections.abc import Callable
from typing import Any, NamedTuple

import httpx2 as httpx
import pytest
from fastapi.testclient import TestClient
from PIL import Image

from api.limit_settings import LimitSettings
from raysvc.limits import Limits
from tests.api.conftest import MakeClient
from tests.api.glb import document
from tests.parsing.test_parser import hdr, slow_ply

OBJ = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n"

Send = Callable[[TestClient], httpx.Response]


class Refusal(NamedTuple):
    """How low a limit is, what it refuses, and how."""

    limit: float
    send: Send
    field: str
    status: int = 413


def scene(name: str, data: bytes) -> Send:
    return lambda client: client.post("/v1/scenes", files={"file": (name, data)})


def with_side_file(client: TestClient) -> httpx.Response:
    files = [("file", ("a.obj", OBJ)), ("file", ("a.mtl", b"newmtl a\n"))]
    return client.post("/v1/scenes", files=files)


def gltf(**changes: Any) -> Send:
    uri = "data:application/octet-stream;base64," + base64.b64encode(bytes(36)).decode()
    whole = document(uri) | changes
    positions = whole["accessors"][0]
    positions["max"] = [0, 0, 0]
    return scene("a.gltf", json.dumps(whole).encode())


def textures(count: int) -> dict[str, Any]:
    uris = []
    for number in range(count):
        file = io.BytesIO()
        Image.new("RGB", (2, 2), (number, 0, 0)).save(file, "PNG")
        uris.append("data:image/png;base64," + base64.b64encode(file.getvalue()).decode())
    return {
        "images": [{"uri": uri} for uri in uris],
        "textures": [{"source": number} for number in range(count)],
        "materials": [
            {"pbrMetallicRoughness": {"baseColorTexture": {"index": number}}}
            for number in range(count)
        ],
        "meshes": [
            {
                "primitives": [
                    {"attributes": {"POSITION": 0}, "material": number} for number in range(count)
                ]
            }
        ],
    }


def packed(data: bytes) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a.obj", data)
    return file.getvalue()


def environment(width: int, height: int) -> Send:
    return lambda client: client.post(
        "/v1/environments", files={"file": ("sky.hdr", hdr(width, height))}
    )


def posted(path: str, body: dict[str, Any]) -> Send:
    return lambda client: client.post(path, json=body)


def render(**settings: Any) -> Send:
    camera = {"width": 80, "height": 40}
    return posted(
        "/v1/renders", {"scene": "builtin:cornell", "camera": camera, "settings": settings}
    )


def comparison(**settings: Any) -> Send:
    return posted("/v1/comparisons", {"scene": "builtin:cornell", **settings})


REFUSALS = {
    "parse_s": Refusal(0.05, scene("slow.ply", slow_ply(100_000)), "slow.ply"),
    "parse_cpu_s": Refusal(0.1, scene("slow.ply", slow_ply(250_000)), "slow.ply"),
    "parse_memory_bytes": Refusal(16 << 20, environment(2048, 1024), "sky.hdr"),
    "max_json_bytes": Refusal(10, render(), "body"),
    "max_upload_bytes": Refusal(10, scene("a.obj", OBJ), "a.obj"),
    "max_upload_files": Refusal(1, with_side_file, "body"),
    "max_file_bytes": Refusal(10, scene("a.obj", OBJ), "a.obj"),
    "max_archive_ratio": Refusal(2, scene("a.zip", packed(OBJ * 100)), "archive"),
    "max_json_depth": Refusal(4, gltf(), "json"),
    "max_nodes": Refusal(1, gltf(nodes=[{"children": [1]}, {"mesh": 0}]), "nodes"),
    "max_node_depth": Refusal(1, gltf(nodes=[{"children": [1]}, {"mesh": 0}]), "nodes[0].children"),
    "max_triangles": Refusal(1, scene("a.obj", OBJ), "a.obj"),
    "max_vertices": Refusal(3, scene("a.obj", OBJ), "a.obj"),
    "max_materials": Refusal(1, gltf(**textures(2)), "materials"),
    "max_texture_pixels": Refusal(3, gltf(**textures(1)), "images[0]"),
    "max_scene_texture_pixels": Refusal(7, gltf(**textures(2)), "images[1]"),
    "max_environment_pixels": Refusal(7, environment(4, 2), "sky.hdr"),
    "max_image_pixels": Refusal(3199, render(), "camera.width", 422),
    "max_image_side": Refusal(79, render(), "camera.width", 422),
    "max_paths": Refusal(3200, render(mode="reference", samples=2), "settings.samples"),
    "max_render_core_s": Refusal(10, render(mode="reference", samples=65536), "settings.samples"),
    "max_filtered_texels": Refusal(
        1000,
        posted("/v1/environments/builtin:gradient/filtered", {"roughness": [0.5], "width": 64}),
        "width",
    ),
    "max_comparison_rays": Refusal(10, comparison(count=11), "count"),
    "max_brute_tests": Refusal(10, comparison(count=11, structures=["brute"]), "structures"),
}
NEVER_REFUSE = {"parse_processes", "parse_uploads"}


def client_with(make_client: MakeClient, name: str, **settings: float) -> TestClient:
    processes = {"parse_processes": 1} if name.startswith("parse_") else {}
    return make_client(**processes, **settings)


def test_every_limit_is_tried_here() -> None:
    assert REFUSALS.keys() | NEVER_REFUSE == LimitSettings.model_fields.keys()


def test_every_limit_of_the_core_is_a_setting() -> None:
    renamed = {"max_scene_bytes": "max_upload_bytes", "max_files": "max_upload_files"}
    for field in dataclasses.fields(Limits):
        assert renamed.get(field.name, field.name) in LimitSettings.model_fields


@pytest.mark.parametrize("name", REFUSALS)
def test_a_limit_refuses_by_name(make_client: MakeClient, name: str) -> None:
    refusal = REFUSALS[name]
    response = refusal.send(client_with(make_client, name, **{name: refusal.limit}))
    assert response.status_code == refusal.status, response.text
    problem = response.json()
    assert problem["field"] == refusal.field, problem
    assert not problem["retryable"]


@pytest.mark.parametrize("name", [name for name in REFUSALS if name != "max_render_core_s"])
def test_without_the_limit_it_passes(make_client: MakeClient, name: str) -> None:
    response = REFUSALS[name].send(client_with(make_client, name, queue_size=10))
    assert response.is_success, response.text
