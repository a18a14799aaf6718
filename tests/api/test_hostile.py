"""Files made to break loaders: each is taken, or refused as the client's mistake by name."""

import os
from pathlib import Path

import pytest
from fastapi.testclient import TestClient

from tests.api.conftest import MakeClient


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
