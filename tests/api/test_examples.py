"""Every operation of the OpenAPI document has examples, and they are right."""

from typing import Any

import pytest
from fastapi.testclient import TestClient

from api import comparison_schemas, filter_schemas, schemas
from api.answer_examples import ANSWERS
from api.body_examples import BODIES, PARAMETERS
from tests.api.conftest import MakeClient

JSON_BODIES = [
    (method, path, name, body)
    for (method, path), contents in BODIES.items()
    for name, body in contents.get("application/json", {}).items()
]


@pytest.fixture
def operations(client: TestClient) -> list[tuple[str, str, dict[str, Any]]]:
    paths = client.get("/openapi.json").json()["paths"]
    return [(method, path, found) for path, ways in paths.items() for method, found in ways.items()]


def test_every_body_that_is_sent_has_one(operations: list[tuple[str, str, dict[str, Any]]]) -> None:
    sending = set()
    for method, path, operation in operations:
        contents = operation.get("requestBody", {}).get("content", {})
        if contents:
            sending.add((method, path))
            shown = [content for content in contents.values() if content.get("examples")]
            assert shown, (method, path)
        if "application/json" in contents:
            assert contents["application/json"]["examples"], (method, path)
        if "multipart/form-data" in contents:
            known = contents["multipart/form-data"]["schema"]["properties"]
            for example in contents["multipart/form-data"]["examples"].values():
                assert set(example["value"]) <= set(known)
    assert sending == set(BODIES)


def test_every_answer_that_is_no_file_has_one(
    operations: list[tuple[str, str, dict[str, Any]]],
) -> None:
    for method, path, operation in operations:
        for status, answer in operation["responses"].items():
            for media_type, content in answer.get("content", {}).items():
                # A table's JSON is a file as well.
                if "json" in media_type and content.get("schema"):
                    assert content.get("example"), (method, path, status)


def test_every_id_has_one(operations: list[tuple[str, str, dict[str, Any]]]) -> None:
    for method, path, operation in operations:
        for parameter in operation.get("parameters", ()):
            if parameter["in"] == "path":
                shown = parameter.get("example") or parameter["schema"].get("enum")
                assert shown, (method, path, parameter["name"])
    assert all(len(known["id"]) in (32, 64) for known in PARAMETERS.values())


def test_problems_are_said_to_be_problems(
    operations: list[tuple[str, str, dict[str, Any]]],
) -> None:
    for _, path, operation in operations:
        for status, answer in operation["responses"].items():
            if status.endswith("XX"):
                assert list(answer["content"]) == ["application/problem+json"], path


@pytest.mark.parametrize(
    ("method", "path", "name", "body"), JSON_BODIES, ids=[f"{p} {n}" for _, p, n, _ in JSON_BODIES]
)
def test_what_is_sent_is_taken(
    make_client: MakeClient, method: str, path: str, name: str, body: dict[str, Any]
) -> None:
    client = make_client()
    environment = client.post("/v1/environments", json={"builtin": "gradient"}).json()["id"]
    url = path.replace("{id}", environment)
    assert client.request(method, url, json=body).status_code in (200, 201, 202)


@pytest.mark.parametrize("name", sorted(ANSWERS))
def test_what_comes_back_fits_its_schema(name: str) -> None:
    places = (schemas, comparison_schemas, filter_schemas)
    (model,) = {getattr(place, name) for place in places if hasattr(place, name)}
    assert model.model_validate(ANSWERS[name], strict=False, extra="forbid")
