import threading
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient
from prometheus_client.parser import text_string_to_metric_families

from api.app import create_app
from api.settings import ApiSettings
from raysvc.errors import InvalidSetting
from raysvc.jobs import PatternRenderer, RenderRequest
from raysvc.parallel import Control
from raysvc.version import VERSION
from tests.api.conftest import MakeClient
from tests.api.glb import glb

WAIT = {"Prefer": "wait=5"}

Samples = dict[tuple[str, frozenset[tuple[str, str]]], float]


def measured(client: TestClient) -> Samples:
    answer = client.get("/metrics")
    assert answer.headers["content-type"] == "text/plain; version=0.0.4; charset=utf-8"
    families = text_string_to_metric_families(answer.text)
    samples = [sample for family in families for sample in family.samples]
    found = {(s.name, frozenset(s.labels.items())): s.value for s in samples}
    assert len(found) == len(samples)
    return found


def value(samples: Samples, name: str, **labels: str) -> float:
    """One sample; 0 where it was never counted."""
    return samples.get((name, frozenset(labels.items())), 0.0)


def render(client: TestClient, width: int = 8) -> Any:
    body = {"scene": "builtin:cornell", "camera": {"width": width, "height": 4}}
    return client.post("/v1/renders", json=body, headers=WAIT).json()


def test_a_render_is_counted_with_its_stages_and_its_wait(client: TestClient) -> None:
    assert render(client)["state"] == "done"
    found = measured(client)
    assert value(found, "raysvc_jobs_total", kind="render", state="done") == 1
    assert value(found, "raysvc_queue_wait_seconds_count", kind="render") == 1
    assert value(found, "raysvc_job_seconds_count", kind="render") == 1
    assert value(found, "raysvc_stage_seconds_count", stage="pattern") == 1
    assert value(found, "raysvc_queue_jobs") == 0
    assert value(found, "raysvc_ready") == 1


def test_a_held_result_is_counted_as_served_and_never_waits(client: TestClient) -> None:
    render(client)
    render(client)
    found = measured(client)
    assert value(found, "raysvc_jobs_served_total", kind="render") == 1
    assert value(found, "raysvc_jobs_total", kind="render", state="done") == 2
    assert value(found, "raysvc_queue_wait_seconds_count", kind="render") == 1
    assert value(found, "raysvc_cache_hits_total", cache="results") == 1
    assert value(found, "raysvc_cache_misses_total", cache="results") == 1


def test_what_makes_room_is_counted(make_client: MakeClient) -> None:
    client = make_client(result_memory_bytes=1)
    for width in (8, 9, 10):
        render(client, width)
    found = measured(client)
    assert value(found, "raysvc_cache_evictions_total", cache="results") == 2
    assert 0 < value(found, "raysvc_cache_bytes", cache="results") < 1000


def test_what_makes_room_on_the_disk_is_counted_apart(make_client: MakeClient) -> None:
    client = make_client(result_disk_bytes=1, scene_disk_bytes=1)
    for width in (8, 9, 10):
        render(client, width)
    assert client.post("/v1/scenes", files={"file": ("triangle.glb", glb())}).status_code == 201
    found = measured(client)
    assert value(found, "raysvc_disk_evictions_total", folder="results") == 2
    assert value(found, "raysvc_disk_evictions_total", folder="scenes") == 1
    assert value(found, "raysvc_disk_evictions_total", folder="environments") == 0
    assert value(found, "raysvc_cache_evictions_total", cache="results") == 0
    for folder in ("results", "scenes"):
        root = client.app.state.context.settings.data_dir / folder  # type: ignore[attr-defined]
        files = sum(path.stat().st_size for path in root.rglob("*") if path.is_file())
        assert value(found, "raysvc_disk_bytes", folder=folder) == files > 0


def test_the_version_is_told_and_no_time_of_birth(client: TestClient) -> None:
    render(client)
    found = measured(client)
    assert value(found, "raysvc_info", version=VERSION) == 1
    assert not [name for name, _ in found if name.endswith("_created")]
    assert all(name.startswith("raysvc_") for name, _ in found)


def test_applications_in_one_process_do_not_count_together(
    make_client: MakeClient, tmp_path: Path
) -> None:
    settings = ApiSettings(data_dir=tmp_path / "other", parse_processes=0)
    renderer = PatternRenderer()
    with TestClient(create_app(settings, lambda *_: renderer)) as other:
        render(other)
        assert value(measured(other), "raysvc_jobs_total", kind="render", state="done") == 1
        assert not value(measured(make_client()), "raysvc_jobs_total", kind="render", state="done")


def test_rays_are_counted_by_kind_and_by_the_second(make_client: MakeClient) -> None:
    class Tracing(PatternRenderer):
        def render(self, request: RenderRequest, control: Control) -> Any:
            picture = super().render(request, control)
            told = picture.statistics.to_dict() | {
                "rays": {"shadow": 300, "reflection": 100},
                "total_seconds": 2.0,
            }
            object.__setattr__(picture, "statistics", Told(told))
            return picture

    class Told:
        def __init__(self, told: dict[str, Any]) -> None:
            self.told = told

        def to_dict(self) -> dict[str, Any]:
            return self.told

    client = make_client(Tracing())
    render(client)
    found = measured(client)
    assert value(found, "raysvc_rays_total", kind="shadow") == 300
    assert value(found, "raysvc_rays_per_second") == 200


def test_jobs_that_wait_and_those_that_are_refused(make_client: MakeClient) -> None:
    class Stuck(PatternRenderer):
        free = threading.Event()

        def render(self, request: RenderRequest, control: Control) -> Any:
            assert self.free.wait(10)
            return super().render(request, control)

    renderer = Stuck()
    client = make_client(renderer)
    statuses = []
    for width in range(1, 7):
        body = {"scene": "builtin:cornell", "camera": {"width": width, "height": 4}}
        statuses.append(client.post("/v1/renders", json=body).status_code)
    found = measured(client)
    assert value(found, "raysvc_queue_jobs") == 2
    assert statuses.count(429) == value(found, "raysvc_rejections_total", reason="queue-full") > 0
    renderer.free.set()


def test_a_failed_job_is_counted_as_such(make_client: MakeClient) -> None:
    client = make_client(PatternRenderer(fault=InvalidSetting("is wrong", "settings")))
    assert render(client)["state"] == "failed"
    assert value(measured(client), "raysvc_jobs_total", kind="render", state="failed") == 1


def test_requests_are_counted_by_the_template_of_their_route(client: TestClient) -> None:
    for id in ("a", "b"):
        client.get(f"/v1/renders/{id}")
    client.get("/v1/anything/else")
    client.request("BREW", "/coffee")
    found = measured(client)
    assert (
        value(
            found,
            "raysvc_http_requests_total",
            method="GET",
            route="/v1/renders/{id}",
            status="404",
        )
        == 2
    )
    assert value(found, "raysvc_http_requests_total", method="GET", route="unmatched", status="404")
    assert value(
        found, "raysvc_http_requests_total", method="OTHER", route="unmatched", status="404"
    )
    assert value(found, "raysvc_rejections_total", reason="not-found") == 4


@pytest.mark.parametrize("path", ["/v1/renders", "/v1/renders/{id}", "/v1/renders/{id}/image"])
def test_answers_of_a_finished_render_say_what_it_took(client: TestClient, path: str) -> None:
    id = render(client)["id"]
    if path == "/v1/renders":
        body = {"scene": "builtin:cornell", "camera": {"width": 8, "height": 4}}
        answer = client.post(path, json=body, headers=WAIT)
    else:
        answer = client.get(path.replace("{id}", id))
    assert answer.status_code == 200
    timing = answer.headers["Server-Timing"]
    assert "pattern;dur=" in timing
    assert "total;dur=" in timing
