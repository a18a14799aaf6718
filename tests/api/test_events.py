import json
import threading
import time
from collections.abc import Iterator
from typing import Any

import pytest
from fastapi.testclient import TestClient

from raysvc.jobs import PatternRenderer
from tests.api.conftest import MakeClient

BODY = {"scene": "builtin:cornell", "camera": {"width": 8, "height": 4}}
Event = tuple[int, str, dict[str, Any]]


def events(client: TestClient, link: str, seen: int | None = None) -> Iterator[Event]:
    """What is told until the connection ends."""
    headers = {} if seen is None else {"Last-Event-ID": str(seen)}
    with client.stream("GET", link, headers=headers) as response:
        assert response.status_code == 200
        assert response.headers["content-type"].startswith("text/event-stream")
        fields: dict[str, str] = {}
        for line in response.iter_lines():
            if line:
                name, _, value = line.partition(": ")
                fields[name] = value
            elif "data" in fields:
                yield int(fields["id"]), fields["event"], json.loads(fields["data"])
                fields = {}


def test_a_render_is_told_of_until_it_is_done(make_client: MakeClient) -> None:
    client = make_client(PatternRenderer(seconds=0.6))
    links = client.post("/v1/renders", json=BODY).json()["links"]
    told = list(events(client, links["events"]))
    ids = [id for id, _, _ in told]
    assert ids == sorted(set(ids))
    assert len([event for _, event, _ in told if event == "running"]) >= 3
    assert [event for _, event, _ in told][-1] == "done"
    progress = [data["progress"] for _, _, data in told]
    assert progress == sorted(progress) and progress[-1] == 1.0
    assert all(event == data["state"] for _, event, data in told)
    end = told[-1][2]
    assert client.get(end["links"]["image"]).status_code == 200
    assert "events" not in end["links"]


def test_who_comes_back_hears_what_is_new_and_nothing_after_the_end(
    make_client: MakeClient,
) -> None:
    client = make_client(PatternRenderer(seconds=0.6))
    link = client.post("/v1/renders", json=BODY).json()["links"]["events"]
    seen, _, _ = next(events(client, link))
    told = list(events(client, link, seen))
    assert all(id > seen for id, _, _ in told)
    last = told[-1][0]
    assert client.get(link, headers={"Last-Event-ID": str(last)}).status_code == 204
    assert [event for _, event, _ in events(client, link, last - 1)] == ["done"]
    assert [event for _, event, _ in events(client, link)] == ["done"]


def test_events_go_on_after_a_restart(make_client: MakeClient) -> None:
    client = make_client(PatternRenderer(seconds=30.0, steps=3000))
    link = client.post("/v1/renders", json=BODY).json()["links"]["events"]
    told = (item for item in events(client, link) if item[1] == "running")
    cut = threading.Timer(0.3, client.app.state.context.service.drain)  # type: ignore[attr-defined]
    cut.start()
    seen = list(told)[-1][0]
    cut.join()
    again = list(events(make_client(), link, seen))
    assert [event for _, event, _ in again][-1] == "done"


@pytest.mark.parametrize("seen", ["", "abc", "-1", "9" * 30, "\uff11"])
def test_an_odd_last_event_is_as_none(client: TestClient, seen: str) -> None:
    response = client.post("/v1/renders", json=BODY, headers={"Prefer": "wait=10"})
    link = response.json()["links"]["self"] + "/events"
    response = client.get(link, headers={"Last-Event-ID": seen.encode()})
    assert (response.status_code, response.text.count("event: done")) == (200, 1)


def test_who_waits_hears_of_the_place_in_the_line(make_client: MakeClient) -> None:
    client = make_client(PatternRenderer(seconds=0.5))
    client.post("/v1/renders", json=BODY)
    body = {**BODY, "settings": {"seed": 1}}
    told = list(events(client, client.post("/v1/renders", json=body).json()["links"]["events"]))
    assert told[0][1] == "queued" and told[0][2]["position"] == 0
    assert told[-1][1] == "done"


def test_a_cancelled_render_is_told_of(make_client: MakeClient) -> None:
    client = make_client(PatternRenderer(seconds=30.0, steps=3000))
    links = client.post("/v1/renders", json=BODY).json()["links"]
    cancel = threading.Timer(0.3, client.delete, (links["self"],))
    cancel.start()
    began = time.monotonic()
    told = list(events(client, links["events"]))
    cancel.join()
    assert told[-1][1] == "cancelled"
    assert time.monotonic() - began < 5


def test_a_comparison_is_told_of_with_its_links(client: TestClient) -> None:
    body = {"scene": "builtin:cornell", "count": 10, "rounds": 1, "structures": ["bvh"]}
    told = list(events(client, client.post("/v1/comparisons", json=body).json()["links"]["events"]))
    assert told[-1][1] == "done"
    assert client.get(told[-1][2]["links"]["table"]).status_code == 200


@pytest.mark.parametrize("kind", ["renders", "comparisons"])
def test_there_are_no_events_of_nothing(client: TestClient, kind: str) -> None:
    assert client.get(f"/v1/{kind}/nothing/events").status_code == 404
