import re
import threading

from fastapi.testclient import TestClient

from raysvc.jobs import PatternRenderer, RenderRequest
from raysvc.parallel import Control
from tests.api.conftest import MakeClient


def test_the_root_links_to_pages_that_are_there(client: TestClient) -> None:
    links = client.get("/").json()["links"]
    assert client.get(links["documentation"]).status_code == 200
    assert client.get(links["openapi"]).status_code == 200
    for name in ("scenes", "environments", "structures", "live"):
        assert client.get(links[name]).status_code == 200


def test_the_documentation_loads_nothing_from_elsewhere(client: TestClient) -> None:
    page = client.get("/docs").text
    sources = re.findall(r"(?:src|href)=\"([^\"]+)\"", page)
    assert sources
    assert "://" not in page
    for source in sources:
        assert client.get(source).status_code == 200


def test_the_schema_describes_bodies_with_their_names(client: TestClient) -> None:
    schema = client.get("/openapi.json").json()
    parts = schema["components"]["schemas"]
    assert "bounces" in parts["Settings"]["properties"]
    assert "fov_y_deg" in parts["View"]["properties"]
    refs = re.findall(r"#/components/schemas/(\w+)", client.get("/openapi.json").text)
    assert set(refs) <= set(parts)


def test_the_structures_are_listed_with_their_parameters(client: TestClient) -> None:
    structures = {
        entry["name"]: entry for entry in client.get("/v1/structures").json()["structures"]
    }
    assert {"embree", "brute"} <= set(structures)
    assert structures["brute"]["available"] is True
    assert structures["brute"]["why_not"] is None
    assert structures["brute"]["parameters"]["type"] == "object"


def test_the_service_is_ready_once_it_is_warm(make_client: MakeClient) -> None:
    class SlowToWarm(PatternRenderer):
        warm = threading.Event()

        def warm_up(self) -> None:
            assert self.warm.wait(5)

    renderer = SlowToWarm()
    client = make_client(renderer)
    assert client.get("/healthz").json() == {"status": "ok"}
    response = client.get("/readyz")
    assert (response.status_code, response.json()) == (503, {"status": "warming up"})
    renderer.warm.set()
    while client.get("/readyz").status_code == 503:
        pass
    client.app.state.context.service.drain()  # type: ignore[attr-defined]
    response = client.get("/readyz")
    assert (response.status_code, response.json()) == (503, {"status": "draining"})
    assert client.post("/v1/renders", json={"scene": "builtin:cornell"}).status_code == 503


def test_a_service_that_cannot_warm_up_is_alive_but_not_ready(make_client: MakeClient) -> None:
    class Broken(PatternRenderer):
        def warm_up(self) -> None:
            raise OSError("no compiler")

    client = make_client(Broken())
    assert client.get("/readyz").status_code == 503
    assert client.get("/healthz").status_code == 200


def test_health_is_answered_while_uploads_and_renders_wait(make_client: MakeClient) -> None:
    class Stuck(PatternRenderer):
        free = threading.Event()

        def render(self, request: RenderRequest, control: Control):  # type: ignore[no-untyped-def]
            assert self.free.wait(5)
            return super().render(request, control)

    renderer = Stuck()
    client = make_client(renderer)
    body = {"scene": "builtin:cornell", "camera": {"width": 4, "height": 4}}
    waiting = threading.Thread(
        target=client.post,
        args=("/v1/renders",),
        kwargs={"json": body, "headers": {"Prefer": "wait=5"}},
    )
    waiting.start()
    assert client.get("/healthz").status_code == 200
    renderer.free.set()
    waiting.join(5)
