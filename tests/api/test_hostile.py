"""Files made to break loaders: each is taken, or refused as the client's mistake by name."""

import os
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from fastapi.testclient import TestClient

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
    client = make_client(parse_processes=1, heavy_threads=1, parse_s=5, parse_cpu_s=60)
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
