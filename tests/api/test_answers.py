"""What every answer carries: an id, security headers, and CORS where it is set."""

import re
from typing import Any

import pytest
from fastapi.testclient import TestClient

from api.problems import problem_of
from api.security_headers import policy_of_page
from api.settings import ApiSettings
from raysvc.errors import RaysvcError
from raysvc.jobs import PatternRenderer
from tests.api.conftest import MakeClient

ELSEWHERE = "https://app.example.org"


@pytest.mark.parametrize("id", ["a", "7f3c-1.2_x:Y", "x" * 64])
def test_a_sane_request_id_is_taken_over(client: TestClient, id: str) -> None:
    answer = client.get("/v1/scenes/unknown", headers={"X-Request-Id": id})
    assert answer.headers["X-Request-Id"] == id
    assert answer.json()["request_id"] == id


@pytest.mark.parametrize("id", ["", "x" * 65, "a b", "-dash", 'quote"', "a,b", "<b>", "{}"])
def test_another_request_id_is_replaced(client: TestClient, id: str) -> None:
    answer = client.get("/healthz", headers={"X-Request-Id": id})
    assert re.fullmatch(r"[0-9a-f]{32}", answer.headers["X-Request-Id"])


def test_ids_differ(client: TestClient) -> None:
    ids = {client.get("/healthz").headers["X-Request-Id"] for _ in range(8)}
    assert len(ids) == 8


def test_an_unexpected_error_has_id_and_headers_too(
    make_client: MakeClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    client = make_client()
    service = client.app.state.context.service  # type: ignore[attr-defined]

    def broken() -> list[Any]:
        raise ZeroDivisionError

    monkeypatch.setattr(service.scenes, "records", broken)
    answer = client.get("/v1/scenes", headers={"X-Request-Id": "this-one"})
    assert answer.status_code == problem_of(RaysvcError("")).status
    assert answer.headers["X-Request-Id"] == answer.json()["request_id"] == "this-one"
    assert answer.headers["X-Content-Type-Options"] == "nosniff"
    assert 'raysvc_http_requests_total{method="GET",route="/v1/scenes",status="500"} 1' in (
        client.get("/metrics").text
    )


@pytest.mark.parametrize("path", ["/healthz", "/v1/scenes", "/nothing", "/docs/assets/favicon.png"])
def test_browsers_are_told_to_guess_load_and_frame_nothing(client: TestClient, path: str) -> None:
    headers = client.get(path).headers
    assert headers["X-Content-Type-Options"] == "nosniff"
    assert headers["X-Frame-Options"] == "DENY"
    assert headers["Referrer-Policy"] == "no-referrer"
    assert headers["Content-Security-Policy"].startswith("default-src 'none'")


def test_the_documentation_may_run_the_scripts_that_are_in_it(client: TestClient) -> None:
    page = client.get("/docs")
    policy = page.headers["Content-Security-Policy"]
    assert policy == policy_of_page(page.content)
    assert "'sha256-" in policy
    assert "unsafe-inline" not in policy.partition("script-src")[2].partition(";")[0]
    assert policy_of_page(page.content.replace(b"<script>", b"<script>evil();")) != policy


def test_pages_of_other_origins_may_not_call_unless_they_are_named(make_client: MakeClient) -> None:
    asked = {"Origin": ELSEWHERE, "Access-Control-Request-Method": "POST"}
    closed = make_client()
    assert "Access-Control-Allow-Origin" not in closed.get("/healthz", headers=asked).headers
    assert closed.options("/v1/renders", headers=asked).status_code == 405


def test_pages_of_a_named_origin_may_call(make_client: MakeClient) -> None:
    client = make_client(PatternRenderer(), cors_origins=f"{ELSEWHERE}, http://localhost:3000")
    asked = {"Origin": ELSEWHERE, "Access-Control-Request-Method": "POST"}
    preflight = client.options("/v1/renders", headers=asked)
    assert preflight.status_code == 200
    assert preflight.headers["Access-Control-Allow-Origin"] == ELSEWHERE
    answer = client.get("/v1/scenes/none", headers=asked)
    assert answer.status_code == 404
    assert answer.headers["Access-Control-Allow-Origin"] == ELSEWHERE
    assert "Retry-After" in answer.headers["Access-Control-Expose-Headers"]
    other = {"Origin": "https://other.example.org"}
    assert "Access-Control-Allow-Origin" not in client.get("/healthz", headers=other).headers


@pytest.mark.parametrize(
    ("site", "allowed"),
    [
        ("cross-site", False),
        ("same-site", False),
        ("same-origin", True),
        ("none", True),
        ("", False),
    ],
)
def test_pages_of_strangers_may_not_post_forms(
    make_client: MakeClient, site: str, allowed: bool
) -> None:
    client = make_client()
    headers = {"Origin": ELSEWHERE, **({"Sec-Fetch-Site": site} if site else {})}
    files = {"scene": (None, "builtin:cornell"), "camera": (None, '{"width": 4, "height": 4}')}
    answer = client.post("/v1/render", files=files, headers=headers)
    assert answer.status_code == (200 if allowed else 403)
    if not allowed:
        assert answer.json()["field"] == "Origin"
        assert answer.json()["type"] == "urn:raysvc:problem:foreign-page"
        assert "WWW-Authenticate" not in answer.headers
    assert client.get("/v1/structures", headers=headers).status_code == 200


@pytest.mark.parametrize(
    ("origin", "host", "allowed"),
    [
        (None, "here:8000", True),
        ("http://here:8000", "here:8000", True),
        ("http://HERE:8000", "here:8000", True),
        ("http://here", "here:80", True),
        ("https://here", "here", True),
        ("https://here", "here:443", True),
        ("http://[::1]:8000", "[::1]:8000", True),
        ("http://evil.example", "here:8000", False),
        ("http://here:8001", "here:8000", False),
        ("http://here:8000.evil.example", "here:8000", False),
        ("http://here", "here:8000", False),
        ("null", "here:8000", False),
        ("", "here:8000", False),
    ],
)
def test_without_fetch_metadata_the_origin_is_held_against_the_host(
    client: TestClient, origin: str | None, host: str, allowed: bool
) -> None:
    headers = {"Host": host} if origin is None else {"Host": host, "Origin": origin}
    answer = client.post("/v1/scenes", json={"builtin": "cornell"}, headers=headers)
    assert answer.status_code == (201 if allowed else 403)
    assert client.get("/v1/scenes", headers=headers).status_code == 200


@pytest.mark.parametrize(
    ("host", "allowed"),
    [
        ("localhost", True),
        ("localhost:8000", True),
        ("LOCALHOST.:1", True),
        ("127.0.0.1:8000", True),
        ("[::1]:8000", True),
        ("evil.example:8000", False),
        ("localhost.evil.example", False),
        ("127.0.0.1.evil.example", False),
        ("[::2]:8000", False),
        ("[", False),
        ("", False),
    ],
)
def test_a_service_answers_to_its_names_alone(
    make_client: MakeClient, host: str, allowed: bool
) -> None:
    client = make_client(hosts="localhost, 127.0.0.1, [::1]")
    # As a page would whose name leads here: of its own origin, as far as the browser can see.
    headers = {"Host": host, "Sec-Fetch-Site": "same-origin", "Origin": f"http://{host}"}
    for answer in (client.get("/v1/scenes", headers=headers), client.get("/", headers=headers)):
        assert answer.status_code == (200 if allowed else 403)
        if not allowed:
            assert answer.json()["type"] == "urn:raysvc:problem:foreign-page"
            assert answer.json()["field"] == "Host"


@pytest.mark.parametrize("origins", [ELSEWHERE, "*"])
def test_pages_of_a_named_origin_may_post(make_client: MakeClient, origins: str) -> None:
    client = make_client(cors_origins=origins)
    headers = {"Origin": ELSEWHERE, "Sec-Fetch-Site": "cross-site"}
    body = {"builtin": "cornell"}
    assert client.post("/v1/scenes", json=body, headers=headers).status_code == 201


@pytest.mark.parametrize("origins", ["example.org", "https://example.org/", "null"])
def test_what_is_no_origin_is_refused(tmp_path: Any, origins: str) -> None:
    with pytest.raises(ValueError, match="is no origin"):
        ApiSettings(data_dir=tmp_path, cors_origins=origins)
