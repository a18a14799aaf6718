import asyncio
import sqlite3
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

import pytest
from fastapi import APIRouter
from fastapi.routing import APIRoute
from fastapi.testclient import TestClient

import api.routes
from api.access import SCOPES
from raysvc.access import KeyStore, Scope
from raysvc.access.key import id_in
from raysvc.access.key_store import FILE
from raysvc.errors import NotFound

UNKNOWN = f"raysvc_{'0' * 12}_{'0' * 64}"


@pytest.fixture
def keys(tmp_path: Path) -> Iterator[KeyStore]:
    """The keys of the service that `client` talks to, as another process sees them."""
    store = KeyStore(tmp_path)
    yield store
    store.close()


def bearer(key: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {key}"}


def routes() -> set[tuple[str, str]]:
    """Every route of every file in api/routes."""
    found = set()
    for path in Path(next(iter(api.routes.__path__))).glob("*.py"):
        module = __import__(f"api.routes.{path.stem}", fromlist=["router"])
        router: APIRouter | None = getattr(module, "router", None)
        for route in router.routes if router else ():
            assert isinstance(route, APIRoute)
            found |= {(method, route.path) for method in route.methods}
    return found


def test_every_route_is_in_the_table_and_nothing_else() -> None:
    assert set(SCOPES) == routes()


def test_without_keys_everybody_may_do_everything(client: TestClient) -> None:
    id = client.post("/v1/scenes", json={"builtin": "cornell"}).json()["id"]
    assert client.delete(f"/v1/scenes/{id}").status_code == 204


@pytest.mark.parametrize("route", sorted(SCOPES), ids=" ".join)
def test_each_route_wants_its_scope(
    client: TestClient, keys: KeyStore, route: tuple[str, str]
) -> None:
    method, path = route
    needed = SCOPES[route]
    url = path.replace("{id}", "0" * 64).replace("{format}", "json")
    every = {scope: keys.add(str(scope), scope) for scope in Scope}
    nobody = client.request(method, url)
    if needed is None:
        assert nobody.status_code == 200 or path == "/readyz"
        return
    assert nobody.status_code == 401
    for scope, key in every.items():
        status = client.request(method, url, headers=bearer(key)).status_code
        if scope.includes(needed):
            assert status not in (401, 403)
        else:
            assert status == 403


def test_a_refusal_says_what_to_do(client: TestClient, keys: KeyStore) -> None:
    key = keys.add("reader", Scope.READ)
    nothing = client.get("/v1/scenes")
    assert nothing.headers["WWW-Authenticate"] == 'Bearer realm="raysvc"'
    assert nothing.headers["Content-Type"] == "application/problem+json"
    assert nothing.json()["type"] == "urn:raysvc:problem:not-authenticated"
    assert nothing.json()["field"] == "Authorization"
    for given in (bearer(UNKNOWN), {"Authorization": f"Basic {key}"}, {"Authorization": key}):
        wrong = client.get("/v1/scenes", headers=given)
        assert wrong.status_code == 401
        assert wrong.headers["WWW-Authenticate"].endswith('error="invalid_token"')
    short = client.post("/v1/renders", json={}, headers=bearer(key))
    assert short.status_code == 403
    assert short.headers["WWW-Authenticate"].endswith('error="insufficient_scope", scope="render"')
    assert short.json()["type"] == "urn:raysvc:problem:not-allowed"
    assert key not in short.text


def test_keys_count_from_the_next_request_on(client: TestClient, keys: KeyStore) -> None:
    assert client.get("/v1/scenes").status_code == 200
    key = keys.add("some", Scope.READ)
    assert client.get("/v1/scenes").status_code == 401
    assert client.get("/v1/scenes", headers=bearer(key)).status_code == 200
    keys.revoke(str(id_in(key)))
    assert client.get("/v1/scenes", headers=bearer(key)).status_code == 401


def test_the_schema_says_which_operations_want_a_key(client: TestClient) -> None:
    schema = client.get("/openapi.json").json()
    assert schema["components"]["securitySchemes"]["key"]["scheme"] == "bearer"
    paths = schema["paths"]
    assert paths["/healthz"]["get"]["security"] == []
    assert paths["/v1/scenes/{id}"]["delete"]["security"] == [{"key": []}, {}]
    assert paths["/v1/scenes/{id}"]["delete"]["x-scope"] == "admin"


@pytest.mark.parametrize("path", ["/openapi.json", "/docs/assets/swagger-ui.css"])
def test_what_documents_the_service_is_public(
    client: TestClient, keys: KeyStore, path: str
) -> None:
    keys.add("some", Scope.ADMIN)
    assert client.get("/v1/scenes").status_code == 401
    assert client.get(path).status_code == 200


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Be a process that writes to an SQLite file, and takes its time."""
    connection = sqlite3.connect(path, isolation_level=None)
    connection.execute("BEGIN EXCLUSIVE")
    yield
    connection.execute("ROLLBACK")
    connection.close()


def test_who_writes_the_keys_keeps_nobody_waiting(
    client: TestClient, keys: KeyStore, tmp_path: Path
) -> None:
    key = keys.add("some", Scope.READ)
    assert client.get("/v1/scenes", headers=bearer(key)).status_code == 200
    with writing(tmp_path / FILE):
        began = time.monotonic()
        assert client.get("/v1/scenes", headers=bearer(key)).status_code == 200
        assert client.get("/v1/scenes").status_code == 401
        assert time.monotonic() - began < 1


def test_keys_that_have_to_be_read_hold_up_only_who_needs_them(
    client: TestClient, keys: KeyStore, tmp_path: Path
) -> None:
    key = keys.add("some", Scope.READ)
    with ThreadPoolExecutor(1) as pool, writing(tmp_path / FILE):
        asked = pool.submit(client.get, "/v1/scenes", headers=bearer(key))
        time.sleep(0.3)
        began = time.monotonic()
        assert client.get("/healthz").status_code == 200
        assert time.monotonic() - began < 1
        assert not asked.done()
    assert asked.result().status_code == 200


@pytest.mark.parametrize(
    ("method", "path"),
    [
        ("GET", "/v1/renders/{}"),
        ("GET", "/v1/renders/{}/image"),
        ("GET", "/v1/renders/{}/events"),
        ("DELETE", "/v1/renders/{}"),
        ("GET", "/v1/comparisons/{}"),
        ("GET", "/v1/comparisons/{}/table.csv"),
        ("GET", "/v1/comparisons/{}/events"),
        ("DELETE", "/v1/comparisons/{}"),
    ],
)
def test_jobs_are_looked_up_beside_the_event_loop(
    client: TestClient, monkeypatch: pytest.MonkeyPatch, method: str, path: str
) -> None:
    context = client.app.state.context  # type: ignore[attr-defined]
    looked: list[bool] = []

    def look(*_: object) -> None:
        try:
            asyncio.get_running_loop()
            looked.append(True)
        except RuntimeError:
            looked.append(False)
        raise NotFound("no such job")

    monkeypatch.setattr(context.service, "job", look)
    assert client.request(method, path.format("x")).status_code == 404
    assert looked == [False]
