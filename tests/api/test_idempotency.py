from typing import Any

import pytest
from fastapi.testclient import TestClient

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
    assert problem.json()["type"] == "urn:raysvc:problem:key-reused"
    assert problem.json()["field"] == "Idempotency-Key"


def test_a_key_is_known_after_a_restart(make_client: MakeClient) -> None:
    first = post(make_client(), "/v1/renders", RENDER).json()
    assert post(make_client(), "/v1/renders", RENDER).json() == first


def test_a_key_is_forgotten_after_its_time(make_client: MakeClient) -> None:
    client = make_client(key_life_s=1e-6)
    first, second = (post(client, "/v1/renders", RENDER).json()["id"] for _ in range(2))
    assert first != second


@pytest.mark.parametrize("key", ["", " ", "a" * 256, "a b", "\x7f"])
def test_an_odd_key_is_refused(client: TestClient, key: str) -> None:
    problem = post(client, "/v1/renders", RENDER, key)
    assert (problem.status_code, problem.json()["field"]) == (422, "Idempotency-Key")


def test_a_request_that_is_refused_uses_no_key_up(client: TestClient) -> None:
    assert post(client, "/v1/renders", {**RENDER, "scene": "builtin:nothing"}).status_code == 422
    assert post(client, "/v1/renders", RENDER).status_code == 200
