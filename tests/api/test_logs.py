import json
import logging
import sys
from pathlib import Path

import pytest
from fastapi.testclient import TestClient

from api.logs import JsonLines, TextLines
from api.request_ids import request_id
from raysvc.access import KeyStore, Scope
from raysvc.access.key import id_in
from raysvc.errors import InvalidSetting
from raysvc.jobs import PatternRenderer
from tests.api.conftest import MakeClient

Caplog = pytest.LogCaptureFixture


def record(message: str, **fields: object) -> logging.LogRecord:
    made = logging.LogRecord("raysvc.http", logging.INFO, "file", 1, message, (), None)
    made.fields = fields
    return made


def test_a_line_of_json_holds_message_ids_and_fields() -> None:
    token = request_id.set("this-one")
    try:
        line = JsonLines().format(record("two\nlines", job_id="7", seconds=0.5))
    finally:
        request_id.reset(token)
    assert "\n" not in line
    entry = json.loads(line)
    assert entry.pop("time").endswith("+00:00")
    assert entry == {
        "level": "info",
        "logger": "raysvc.http",
        "message": "two\nlines",
        "request_id": "this-one",
        "job_id": "7",
        "seconds": 0.5,
    }


def test_an_exception_is_part_of_its_line() -> None:
    made = record("it failed")
    try:
        raise ZeroDivisionError("by nothing")
    except ZeroDivisionError:
        made.exc_info = sys.exc_info()
    assert "by nothing" in json.loads(JsonLines().format(made))["exception"]
    assert TextLines().format(made).splitlines()[-1].endswith("by nothing")


def test_a_line_for_people_is_one_line() -> None:
    line = TextLines().format(record("two\nlines", job_id="7", error="a\r\nb\u2028c"))
    assert line.endswith("raysvc.http: two lines job_id=7 error=a b c")


def test_a_request_its_job_and_the_answer_share_an_id(client: TestClient, caplog: Caplog) -> None:
    caplog.set_level(logging.INFO)
    seen: list[dict[str, object]] = []

    class Keep(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            seen.append(json.loads(JsonLines().format(record)))

    keep = Keep()
    logging.getLogger().addHandler(keep)
    try:
        body = {"scene": "builtin:cornell", "camera": {"width": 8, "height": 4}}
        headers = {"Prefer": "wait=5", "X-Request-Id": "this-one"}
        job = client.post("/v1/renders", json=body, headers=headers).json()["id"]
    finally:
        logging.getLogger().removeHandler(keep)
    of_request = [entry for entry in seen if entry.get("request_id") == "this-one"]
    assert {"render accepted", "POST /v1/renders 200"} <= {entry["message"] for entry in of_request}
    assert all(entry["job_id"] == job for entry in of_request)
    (ended,) = [entry for entry in seen if entry["message"] == "render done"]
    assert ended["job_id"] == job
    assert ended["state"] == "done"


def test_a_failed_job_is_a_warning_that_says_why(make_client: MakeClient, caplog: Caplog) -> None:
    caplog.set_level(logging.INFO)
    client = make_client(PatternRenderer(fault=InvalidSetting("is wrong", "settings")))
    body = {"scene": "builtin:cornell", "camera": {"width": 8, "height": 4}}
    client.post("/v1/renders", json=body, headers={"Prefer": "wait=5"})
    (found,) = [made for made in caplog.records if made.getMessage() == "render failed"]
    assert found.levelno == logging.WARNING
    assert found.__dict__["fields"]["error"] == "settings: is wrong"


def test_probes_are_logged_only_when_something_is_wrong(client: TestClient, caplog: Caplog) -> None:
    caplog.set_level(logging.INFO)
    client.get("/healthz")
    client.app.state.context.service.drain()  # type: ignore[attr-defined]
    assert client.get("/readyz").status_code == 503
    client.get("/v1/scenes/none")
    lines = [made.getMessage() for made in caplog.records if made.name == "raysvc.http"]
    assert lines == ["GET /v1/scenes/none 404"]


def test_the_id_of_a_key_is_logged_and_the_key_is_not(
    client: TestClient, caplog: Caplog, tmp_path: Path
) -> None:
    caplog.set_level(logging.DEBUG)
    key = KeyStore(tmp_path).add("some", Scope.READ)
    client.get("/v1/scenes", headers={"Authorization": f"Bearer {key}"})
    (line,) = [made for made in caplog.records if made.name == "raysvc.http"]
    assert line.__dict__["fields"]["key_id"] == id_in(key)
    assert key.rpartition("_")[2] not in caplog.text


def test_a_wrong_key_never_reaches_the_log(client: TestClient, caplog: Caplog) -> None:
    caplog.set_level(logging.DEBUG)
    key = f"raysvc_{'1' * 12}_{'2' * 64}"
    client.get("/v1/scenes", headers={"Authorization": f"Bearer {key}"})
    assert "2" * 64 not in caplog.text
