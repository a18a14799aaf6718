"""Files made to break loaders: each is taken, or refused as the client's mistake by name."""

import os
import time
from concurrent.futures import ThreadPoolExecutor
from io import BytesIO
from pathlib import Path

import pytest
from fastapi.testclient import TestClient
from starlette.datastructures import Headers, UploadFile

from api.forms import Form, take
from api.problems import MalformedBody
from tests.api.conftest import MakeClient
from tests.parsing.test_parser import slow_ply


def crafted(assets: Path) -> list[Path]:
    return sorted(path for path in (assets / "hostile").rglob("*") if path.is_file())


@pytest.mark.assets
def test_hostile_files_are_taken_or_refused_by_name(
    make_client: MakeClient, assets: Path, tmp_path: Path
) -> None:
    client = make_client()
    faults = []
    for path in crafted(assets):
        collection = "environments" if path.suffix in (".hdr", ".exr") else "scenes"
        response = client.post(f"/v1/{collection}", files={"file": (path.name, path.read_bytes())})
        if response.status_code in (200, 201):
            continue
        body = response.json()
        if not (400 <= response.status_code < 500 and body["field"] and body["detail"]):
            faults.append((path.name, response.status_code, response.text[:200]))
    assert not faults
    assert os.listdir(tmp_path / "scenes" / "incoming") == []


@pytest.mark.assets
def test_a_real_scene_with_side_files_is_taken(client: TestClient, assets: Path) -> None:
    folder = assets / "gltf" / "FlightHelmet"
    files = [("file", (path.name, path.read_bytes())) for path in sorted(folder.iterdir())]
    response = client.post("/v1/scenes", files=files)
    assert response.status_code == 201, response.text
    assert response.json()["triangles"] == 94_722


@pytest.mark.skipif(os.name != "posix", reason="needs rlimits")
def test_uploads_that_are_slow_to_read_keep_nobody_else_waiting(make_client: MakeClient) -> None:
    client = make_client(parse_processes=1, heavy_threads=1, parse_s=2, parse_cpu_s=60)
    client.post("/v1/scenes", files={"file": ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")})
    slow = {"file": ("slow.ply", slow_ply(600_000))}
    with ThreadPoolExecutor(1) as pool:
        uploaded = pool.submit(client.post, "/v1/scenes", files=slow)
        time.sleep(0.5)
        began = time.monotonic()
        rendered = client.post(
            "/v1/renders", json={"scene": "builtin:cornell", "camera": {"width": 8, "height": 8}}
        )
        assert rendered.status_code == 202
        assert not uploaded.done()
        assert time.monotonic() - began < 4
        assert uploaded.result().status_code == 413


@pytest.mark.parametrize(
    "charset",
    ["undefined", "idna", "punycode", "utf-7", "unicode_escape", "raw_unicode_escape", "latin-1"],
)
@pytest.mark.parametrize("route", ["/v1/scenes", "/v1/environments", "/v1/render", "/v1/lens"])
def test_forms_are_in_utf_8(client: TestClient, route: str, charset: str) -> None:
    kind = f"multipart/form-data; boundary=x; charset={charset}"
    part = (
        b'--x\r\nContent-Disposition: form-data; name="file"; filename="%s"\r\n\r\nv\r\n--x--\r\n'
    )
    for name in (b"a.obj", b"\\ud800.obj", b"+2AA-.obj", b"\xff.obj"):
        response = client.post(route, content=part % name, headers={"Content-Type": kind})
        assert response.status_code == 415, response.text
        assert response.json()["field"] == "Content-Type"
        assert charset in response.json()["detail"]


@pytest.mark.parametrize("charset", ["", "; charset=utf-8", '; charset="UTF-8"', "; charset=utf8"])
def test_names_of_files_are_in_utf_8(client: TestClient, charset: str) -> None:
    text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    body = (
        f'--x\r\nContent-Disposition: form-data; name="file"; filename="\u00e4.obj"\r\n\r\n{text}'
    )
    response = client.post(
        "/v1/scenes",
        content=f"{body}\r\n--x--\r\n".encode(),
        headers={"Content-Type": f"multipart/form-data; boundary=x{charset}"},
    )
    assert response.status_code == 201, response.text
    assert response.json()["name"] == "\u00e4"


@pytest.mark.parametrize(
    "item",
    [
        ("file\ud800", "text"),
        ("camera", "\ud800"),
        ("file", UploadFile(BytesIO(), filename="\udfff.obj", headers=Headers())),
    ],
)
def test_a_form_holds_text_alone(item: tuple[str, UploadFile | str]) -> None:
    with pytest.raises(MalformedBody, match="surrogate"):
        take(Form({}, {}), [item])
