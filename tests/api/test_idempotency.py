from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from raysvc.access import KeyStore, Scope
from tests.api.conftest import MakeClient

RENDER = {"scene": "builtin:cornell", "camera": {"width": 8, "height": 4}}
COMPARISON = {"scene": "builtin:cornell", "count": 10, "rounds": 1, "structures": ["bvh"]}


def post(client: TestClient, path: str, body: dict[str, Any], key: str = "key") -> Any:
    return client.post(path, json=body, headers={"Idempotency-Key": key, "Prefer": "wait=10"})


@pytest.mark.parametrize(
    ("path", "body"), [("/v1/renders", RENDER), ("/v1/comparisons", COMPARISON)]
)
def test_the_same_key_with_the_same_body_is_the_same_job(
    client: TestClient, path: str, body: dict[str, Any]
) -> None:
    first, again = post(client, path, body), post(client, path, dict(reversed(body.items())))
    assert first.status_code == again.status_code == 200
    assert first.json() == again.json()
    assert first.headers["Location"] == again.headers["Location"]
    assert post(client, path, body, "another").json()["id"] != first.json()["id"]


@pytest.mark.parametrize(
    ("path", "body"),
    [
        ("/v1/renders", {**RENDER, "settings": {"seed": 1}}),
        ("/v1/comparisons", COMPARISON),
    ],
)
def test_the_same_key_with_something_else_is_refused(
    client: TestClient, path: str, body: dict[str, Any]
) -> None:
    post(client, "/v1/renders", RENDER)
    problem = post(client, path, body)
    assert problem.status_code == 422
    assert problem.json()["type"] == "urn:raysvc:problem:idempotency-key-reused"
    assert problem.json()["field"] == "Idempotency-Key"


@pytest.mark.parametrize(
    ("path", "body"), [("/v1/renders", RENDER), ("/v1/comparisons", COMPARISON)]
)
def test_a_key_outlives_its_scene(client: TestClient, path: str, body: dict[str, Any]) -> None:
    scene = client.post("/v1/scenes", json={"builtin": "cornell"}).json()["id"]
    named = {**body, "scene": scene}
    first = post(client, path, named).json()
    assert client.delete(f"/v1/scenes/{scene}").status_code == 204
    assert post(client, path, named).json() == first
    assert post(client, path, named, "another").status_code == 404


def test_keys_of_different_clients_have_nothing_to_do_with_each_other(
    make_client: MakeClient, tmp_path: Path
) -> None:
    with closing(KeyStore(tmp_path)) as keys:
        bearers = [keys.add(name, Scope.RENDER) for name in ("one", "other")]
    client = make_client()
    ids = [
        client.post(
            "/v1/renders",
            json={**RENDER, "settings": {"seed": seed}},
            headers={"Idempotency-Key": "key", "Authorization": f"Bearer {bearer}"},
        ).json()["id"]
        for seed, bearer in enumerate(bearers)
    ]
    assert ids[0] != ids[1]


def test_a_key_is_known_after_a_restart(make_client: MakeClient) -> None:
    first = post(make_client(), "/v1/renders", RENDER).json()
    assert post(make_client(), "/v1/renders", RENDER).json() == first


def test_a_key_is_forgotten_after_its_time(make_client: MakeClient) -> None:
    client = make_client(idempotency_key_life_s=1e-6)
    first, second = (post(client, "/v1/renders", RENDER).json()["id"] for _ in range(2))
    assert first != second


@pytest.mark.parametrize("key", ["", " ", "a" * 256, "a b", "\x7f"])
def test_an_odd_key_is_refused(client: TestClient, key: str) -> None:
    problem = post(client, "/v1/renders", RENDER, key)
    assert (problem.status_code, problem.json()["field"]) == (422, "Idempotency-Key")


def test_a_request_that_is_refused_uses_no_key_up(client: TestClient) -> None:
    assert post(client, "/v1/renders", {**RENDER, "scene": "builtin:nothing"}).status_code == 422
    assert post(client, "/v1/renders", RENDER).status_code == 200
