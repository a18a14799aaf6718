import json
from typing import Any

import httpx
import pytest
from hypothesis import given
from hypothesis import strategies as st

from raysvc.client.connection import Connection
from raysvc.client.following import events_in, follow
from raysvc.client.resources import Job
from raysvc.errors import DeadlineExceeded

PATH = "/v1/renders/7"


def resource(state: str, progress: float = 0.0, events: bool = True) -> dict[str, Any]:
    links = {"events": f"{PATH}/events"} if events else {}
    return {
        "id": "7",
        "state": state,
        "stage": "light" if state == "running" else None,
        "progress": progress,
        "position": None,
        "error": None,
        "links": links,
    }


def told(*resources: dict[str, Any]) -> str:
    return "".join(f"id: 1\nevent: x\ndata: {json.dumps(each)}\n\n" for each in resources)


def connection_to(*answers: tuple[str, httpx.Response]) -> tuple[Connection, list[str]]:
    asked: list[str] = []
    left = list(answers)

    def answer(request: httpx.Request) -> httpx.Response:
        asked.append(request.url.path)
        path, response = left.pop(0)
        assert request.url.path == path
        return response

    return Connection("http://service", transport=httpx.MockTransport(answer)), asked


def test_events_are_told_as_they_come_and_the_resource_ends_it() -> None:
    stream = "retry: 1000\n\n" + told(resource("running", 0.5)) + ": still here\n\n"
    stream += told(resource("done", 1.0))
    connection, _ = connection_to(
        (f"{PATH}/events", httpx.Response(200, text=stream)),
        (PATH, httpx.Response(200, json=resource("done", 1.0, events=False))),
    )
    seen: list[tuple[str, float]] = []
    job = follow(
        connection, PATH, Job.of(resource("queued")), lambda *progress: seen.append(progress)
    )
    assert job.state == "done"
    assert seen == [("light", 0.5), ("done", 1.0), ("done", 1.0)]


@pytest.mark.parametrize(
    "events",
    [
        httpx.Response(404, json={}),
        httpx.Response(200, text=""),
        httpx.Response(200, text="data: {\n\n"),
    ],
    ids=["none", "nothing in them", "nonsense"],
)
def test_without_events_the_resource_is_asked_for(events: httpx.Response) -> None:
    connection, asked = connection_to(
        (f"{PATH}/events", events),
        (PATH, httpx.Response(200, json=resource("running"))),
        (PATH, httpx.Response(200, json=resource("done"))),
    )
    assert follow(connection, PATH, Job.of(resource("queued"))).state == "done"
    assert asked == [f"{PATH}/events", PATH, PATH]


def test_a_service_without_events_is_never_asked_for_them() -> None:
    connection, asked = connection_to((PATH, httpx.Response(200, json=resource("cancelled"))))
    job = follow(connection, PATH, Job.of(resource("queued", events=False)))
    assert job.state == "cancelled"
    assert asked == [PATH]


def test_waiting_may_end_before_the_job() -> None:
    connection, _ = connection_to((PATH, httpx.Response(200, json=resource("running"))))
    job = Job.of(resource("running", events=False))
    with pytest.raises(DeadlineExceeded):
        follow(connection, PATH, job, timeout_s=0.01)


@given(
    st.lists(st.dictionaries(st.text(max_size=3), st.integers() | st.text(max_size=5), max_size=3))
)
def test_every_whole_event_is_read(objects: list[dict[str, Any]]) -> None:
    stream = told(*objects)
    assert list(events_in(iter(stream.split("\n")))) == objects
    # Cut before its end the last one is no event.
    cut = stream[: stream.rindex("\n\n")] if objects else ""
    assert list(events_in(iter(cut.split("\n")))) == objects[:-1]
