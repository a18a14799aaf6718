"""Every error has one shape, RFC 9457's, and a client's mistake is never a 5xx."""

from typing import Any

import pytest
from fastapi.testclient import TestClient

from api.problems import PROBLEMS, problem_of
from raysvc import errors
from raysvc.jobs import PatternRenderer
from tests.api.conftest import MakeClient

JSON = {"Content-Type": "application/json"}
FORM = {"Content-Type": "multipart/form-data; boundary=b"}
DEEP = b'{"a":' * 100_000 + b"1" + b"}" * 100_000

MISTAKES: dict[str, tuple[str, str, dict[str, Any], int]] = {
    "no such path": ("GET", "/v1/nothing", {}, 404),
    "a trailing slash": ("GET", "/v1/scenes/", {}, 404),
    "a path that is not UTF-8": ("GET", "/v1/scenes/%ff%00", {}, 404),
    "a path that climbs": ("GET", "/v1/scenes/..%2f..%2fetc", {}, 404),
    "a very long id": ("GET", "/v1/scenes/" + "a" * 5000, {}, 404),
    "an asset that climbs": ("GET", "/docs/assets/..%2f__init__.py", {}, 404),
    "no such method": ("PUT", "/v1/scenes", {}, 405),
    "no such scene": ("GET", "/v1/scenes/" + "0" * 64, {}, 404),
    "no body": ("POST", "/v1/scenes", {}, 415),
    "the wrong kind of body": ("POST", "/v1/renders", {"content": b"<a/>"}, 415),
    "not JSON": ("POST", "/v1/renders", {"content": b"{", "headers": JSON}, 400),
    "not UTF-8": ("POST", "/v1/renders", {"content": b'{"a":"\xff"}', "headers": JSON}, 400),
    "not an object": ("POST", "/v1/renders", {"content": b"[]", "headers": JSON}, 400),
    "an empty body": ("POST", "/v1/renders", {"content": b"", "headers": JSON}, 400),
    "an empty object": ("POST", "/v1/renders", {"json": {}}, 422),
    "deep JSON": ("POST", "/v1/renders", {"content": DEEP, "headers": JSON}, 400),
    "too much JSON": ("POST", "/v1/renders", {"content": b" " * 2_000_000, "headers": JSON}, 413),
    "a form without a boundary": (
        "POST",
        "/v1/scenes",
        {"content": b"x", "headers": {"Content-Type": "multipart/form-data"}},
        400,
    ),
    "a broken form": ("POST", "/v1/scenes", {"content": b"nonsense", "headers": FORM}, 400),
    "an unfinished form": (
        "POST",
        "/v1/scenes",
        {"content": b'--b\r\nContent-Disposition: form-data; name="file"', "headers": FORM},
        422,
    ),
    "a file that is no scene": ("POST", "/v1/scenes", {"files": {"file": ("a.glb", b"x")}}, 422),
    "a name that climbs": ("POST", "/v1/scenes", {"files": {"file": ("../../a.glb", b"x")}}, 422),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_answered_as_a_problem(client: TestClient, mistake: str) -> None:
    method, path, arguments, status = MISTAKES[mistake]
    response = client.request(method, path, **arguments)
    assert response.status_code == status, response.text
    assert_is_problem(response.headers["Content-Type"], response.json(), status)
    assert response.json()["instance"] == path


def assert_is_problem(content_type: str, body: dict[str, Any], status: int) -> None:
    assert content_type == "application/problem+json"
    about = {"type", "title", "status", "detail", "instance", "field", "retryable", "request_id"}
    assert set(body) == about
    assert body["status"] == status
    assert body["type"].startswith("urn:raysvc:problem:")
    assert body["title"] and body["detail"]
    assert body["field"] is None or isinstance(body["field"], str)
    assert isinstance(body["retryable"], bool)


def test_a_refused_method_says_which_are_allowed(client: TestClient) -> None:
    assert client.put("/v1/structures").headers["Allow"] == "GET"


def test_a_fault_of_the_service_is_a_problem_without_a_traceback(make_client: MakeClient) -> None:
    client = make_client(PatternRenderer(fault=ZeroDivisionError("secret")))
    response = client.post("/v1/render", json={"scene": "builtin:cornell"})
    assert_is_problem(response.headers["Content-Type"], response.json(), 500)
    assert "secret" not in response.text

    client.app.state.context = None  # type: ignore[attr-defined]
    response = client.get("/readyz")
    assert_is_problem(response.headers["Content-Type"], response.json(), 500)
    assert "NoneType" not in response.text


def every_error() -> list[type[errors.RaysvcError]]:
    kinds: list[type[errors.RaysvcError]] = [errors.RaysvcError]
    for kind in kinds:
        kinds += kind.__subclasses__()
    return kinds


@pytest.mark.parametrize("kind", every_error())
def test_every_kind_of_error_has_a_problem(kind: type[errors.RaysvcError]) -> None:
    error = kind("message", 1.0) if kind in (errors.QueueFull, errors.Busy) else kind("message")  # type: ignore[arg-type]
    problem = problem_of(error)
    if isinstance(error, errors.InvalidInput):
        assert 400 <= problem.status < 500


def test_types_of_problems_are_told_apart() -> None:
    types = [problem.type for problem in PROBLEMS.values()]
    assert len(types) == len(set(types))
