import csv
import io
import time
from typing import Any

import pytest
from fastapi.testclient import TestClient

from raysvc.jobs import PatternRenderer
from tests.api.conftest import MakeClient

SMALL = {
    "scene": "builtin:cornell",
    "count": 200,
    "rounds": 1,
    "builds": 1,
    "structures": ["bvh", "brute"],
    "camera": {"gltf_camera": 0, "width": 16, "height": 12},
}
LONG = {**SMALL, "rounds": 100, "structures": ["bvh"], "count": 2_000_000}


def done(client: TestClient, **change: Any) -> dict[str, Any]:
    response = client.post(
        "/v1/comparisons", json={**SMALL, **change}, headers={"Prefer": "wait=30"}
    )
    assert response.status_code == 200, response.text
    resource: dict[str, Any] = response.json()
    assert resource["state"] == "done", resource["error"]
    return resource


def test_a_comparison_is_accepted_and_can_be_watched(client: TestClient) -> None:
    response = client.post("/v1/comparisons", json=SMALL)
    assert response.status_code == 202
    link = response.headers["Location"]
    assert link == response.json()["links"]["self"]
    assert response.json()["rays"] == {"kind": "random", "count": 200, "seed": 0}
    while (resource := client.get(link).json())["state"] in ("queued", "running"):
        assert resource["structures"] is None
        time.sleep(0.01)
    assert resource["state"] == "done"
    assert [s["name"] for s in resource["structures"]] == ["bvh", "brute"]
    first, second = (s["traversal"] for s in resource["structures"])
    assert first["hit_checksum"] == second["hit_checksum"]
    assert resource["talk_2009"] is None
    assert resource["links"]["chart"] == f"{link}/chart.svg"


def test_every_request_is_measured_anew(client: TestClient) -> None:
    first, second = done(client), done(client)
    assert first["id"] != second["id"]
    assert first["seconds"] != second["seconds"]
    steps = [r["structures"][0]["traversal"]["node_steps_per_ray"] for r in (first, second)]
    assert steps[0] == steps[1]


@pytest.mark.parametrize(
    ("file", "media_type", "start"),
    [
        ("table.json", "application/json", b"{"),
        ("table.csv", "text/csv; charset=utf-8", b"source,"),
        ("table.md", "text/markdown; charset=utf-8", b"# builtin:cornell"),
        ("chart.svg", "image/svg+xml", b"<?xml"),
        ("chart.png", "image/png", b"\x89PNG"),
        ("heat_map.png", "image/png", b"\x89PNG"),
        ("heat_map.exr", "image/x-exr", b"v/1\x01"),
    ],
)
def test_the_figures_come_as_files(
    client: TestClient, file: str, media_type: str, start: bytes
) -> None:
    link = done(client, heat_map=True)["links"]["self"]
    response = client.get(f"{link}/{file}")
    assert response.status_code == 200
    assert response.headers["Content-Type"] == media_type
    assert response.content.startswith(start)
    held = {"If-None-Match": response.headers["ETag"]}
    assert client.get(f"{link}/{file}", headers=held).status_code == 304


def test_the_table_has_the_figures_of_the_resource(client: TestClient) -> None:
    resource = done(client)
    text = client.get(f"{resource['links']['table']}").text
    rows = list(csv.DictReader(io.StringIO(text)))
    assert [row["name"] for row in rows] == ["bvh", "brute"]
    assert float(rows[0]["sah_cost"]) == resource["structures"][0]["build"]["sah_cost"]


def test_a_heat_map_that_was_not_asked_for_is_not_there(client: TestClient) -> None:
    resource = done(client)
    assert "heat_map" not in resource["links"]
    response = client.get(f"{resource['links']['self']}/heat_map.png")
    assert (response.status_code, response.json()["field"]) == (404, "heat_map")


def test_figures_that_are_not_there_yet_are_waited_for(make_client: MakeClient) -> None:
    client = make_client()
    link = client.post("/v1/comparisons", json=LONG).headers["Location"]
    assert client.get(f"{link}/table.csv").status_code == 409
    client.delete(link)


def test_a_running_comparison_is_cancelled_soon(client: TestClient) -> None:
    link = client.post("/v1/comparisons", json=LONG).headers["Location"]
    while not (client.get(link).json()["stage"] or "").startswith("timing"):
        time.sleep(0.01)
    began = time.monotonic()
    assert client.delete(link).status_code == 202
    while (resource := client.get(link).json())["state"] == "running":
        time.sleep(0.005)
    assert resource["state"] == "cancelled"
    assert time.monotonic() - began < 1.0
    assert 0 < resource["progress"] < 1


def test_comparisons_wait_in_the_line_of_renders(make_client: MakeClient) -> None:
    client = make_client(PatternRenderer(seconds=30.0, steps=3000), queue_size=1)
    render = client.post("/v1/renders", json={"scene": "builtin:cornell"}).headers["Location"]
    while client.get(render).json()["state"] == "queued":
        time.sleep(0.01)
    waiting = client.post("/v1/comparisons", json=SMALL)
    assert (waiting.status_code, waiting.json()["position"]) == (202, 0)
    assert client.post("/v1/comparisons", json=SMALL).status_code == 429
    client.delete(render)


@pytest.mark.parametrize(
    ("change", "status", "field"),
    [
        ({"scene": "f" * 64}, 404, "scene"),
        ({"scene": "builtin:atlantis"}, 422, "scene"),
        ({"rays": "purple"}, 422, "rays"),
        ({"count": 0}, 422, "count"),
        ({"count": 10_000_001}, 413, "count"),
        ({"count": 1_000_000}, 413, "structures"),
        ({"structures": ["quadtree"]}, 422, "structures"),
        ({"structures": ["bvh:bins=1"]}, 422, "structures.bvh.bins"),
        ({"structures": "bvh"}, 422, "structures"),
        ({"trees": "many"}, 422, "trees"),
        ({"camera": {"gltf_camera": 9}}, 422, "camera.gltf_camera"),
        ({"camera": {"width": 0}}, 422, "camera.width"),
        ({"camera": 3}, 422, "camera"),
        ({"colour": "red"}, 422, "colour"),
    ],
)
def test_what_is_wrong_is_named(
    client: TestClient, change: dict[str, Any], status: int, field: str
) -> None:
    response = client.post("/v1/comparisons", json={**SMALL, **change})
    assert (response.status_code, response.json()["field"]) == (status, field)


def test_the_limit_of_rays_is_the_services(make_client: MakeClient) -> None:
    client = make_client(max_comparison_rays=100)
    assert client.post("/v1/comparisons", json=SMALL).status_code == 413


def test_a_body_without_a_scene_is_refused(client: TestClient) -> None:
    response = client.post("/v1/comparisons", json={"rays": "random"})
    assert (response.status_code, response.json()["field"]) == (422, "scene")


def test_a_comparison_that_made_room_keeps_its_figures_but_not_its_files(
    make_client: MakeClient,
) -> None:
    client = make_client(comparison_memory_bytes=1, result_disk_bytes=1)
    first = done(client)
    done(client)
    assert client.get(first["links"]["self"]).json()["structures"] is not None
    assert client.get(first["links"]["table"]).status_code == 410


def test_a_comparison_is_no_render_and_nothing_is_no_comparison(client: TestClient) -> None:
    comparison = done(client)["id"]
    assert client.get(f"/v1/renders/{comparison}").status_code == 404
    for method, path in (("GET", ""), ("GET", "/table.csv"), ("DELETE", "")):
        response = client.request(method, f"/v1/comparisons/nothing{path}")
        assert (response.status_code, response.json()["field"]) == (404, "comparison")
    assert client.get(f"/v1/comparisons/{comparison}/table.xls").status_code == 422
