"""What is repeated and what is not, against a service that is made up."""

from collections.abc import Callable
from typing import Any

import httpx
import pytest

from raysvc.client.connection import LONGEST_PAUSE_S, Connection
from raysvc.errors import (
    DeadlineExceeded,
    InvalidSetting,
    NotAuthenticated,
    QueueFull,
    RaysvcError,
    Unreachable,
)

Answer = httpx.Response | Exception
BUSY = {"type": "urn:raysvc:problem:queue-full", "title": "The queue is full", "status": 429}
LATE = {"type": "urn:raysvc:problem:deadline-exceeded", "title": "It took too long", "status": 422}
AWAY = {"type": "urn:raysvc:problem:draining", "title": "The service ends", "status": 503}
OK = httpx.Response(200, json={})


class Scripted:
    """Answers requests as it is told, and remembers them and the pauses between."""

    def __init__(self, *answers: Answer, patience_s: float = 60.0) -> None:
        self.answers = list(answers)
        self.requests: list[httpx.Request] = []
        self.pauses: list[float] = []
        self.connection = Connection(
            "http://service",
            "secret",
            patience_s=patience_s,
            transport=httpx.MockTransport(self._answer),
            sleep=self.pauses.append,
        )

    def _answer(self, request: httpx.Request) -> httpx.Response:
        request.read()
        self.requests.append(request)
        answer = self.answers.pop(0)
        if isinstance(answer, Exception):
            raise answer
        return answer


def refused(status: int, body: Any = None, **headers: str) -> httpx.Response:
    shown = {name.replace("_", "-"): value for name, value in headers.items()}
    return httpx.Response(status, json=body, headers=shown)


@pytest.mark.parametrize(
    "fault",
    [
        httpx.ConnectError("refused"),
        httpx.ReadError("reset"),
        httpx.ReadTimeout("silence"),
        httpx.RemoteProtocolError("cut"),
        refused(502),
        refused(503, AWAY),
        refused(503, {**AWAY, "detail": f'said "{LATE["type"]}"', "type": LATE["type"]}),
        refused(504),
        refused(429, BUSY),
    ],
    ids=repr,
)
@pytest.mark.parametrize("method", ["GET", "PUT", "DELETE", "POST with a key"])
def test_what_may_be_done_twice_is_repeated(fault: Answer, method: str) -> None:
    service = Scripted(fault, OK)
    name, _, keyed = method.partition(" ")
    answer = service.connection.send(name, "/v1/x", repeatable=True if keyed else None)
    assert answer.status_code == 200
    assert len(service.requests) == 2


@pytest.mark.parametrize(
    ("fault", "repeated"),
    [
        (httpx.ConnectError("refused"), True),
        (httpx.ConnectTimeout("silence"), True),
        (refused(429, BUSY), True),
        (httpx.ReadError("reset"), False),
        (httpx.ReadTimeout("silence"), False),
        (refused(502), False),
        (refused(503, AWAY), False),
    ],
    ids=repr,
)
def test_a_post_is_repeated_only_if_nothing_was_done(fault: Answer, repeated: bool) -> None:
    service = Scripted(fault, OK)
    if repeated:
        service.connection.send("POST", "/v1/x")
    else:
        with pytest.raises(RaysvcError):
            service.connection.send("POST", "/v1/x")
    assert len(service.requests) == 1 + repeated


@pytest.mark.parametrize(
    ("answer", "kind"),
    [
        (
            refused(401, {"type": "urn:raysvc:problem:not-authenticated", "title": ""}),
            NotAuthenticated,
        ),
        (refused(422, LATE), DeadlineExceeded),
        (refused(500, {"type": "urn:raysvc:problem:internal", "title": "?"}), RaysvcError),
        (refused(404), Unreachable),
    ],
    ids=["no key", "too late", "a fault", "no raysvc"],
)
def test_what_would_be_the_same_again_is_not_repeated(
    answer: httpx.Response, kind: type[RaysvcError]
) -> None:
    service = Scripted(answer)
    with pytest.raises(kind):
        service.connection.send("GET", "/v1/x")
    assert service.pauses == []


def test_the_service_says_when_to_come_back() -> None:
    service = Scripted(refused(429, BUSY, retry_after="7"), refused(429, BUSY), OK)
    service.connection.send("POST", "/v1/x")
    assert service.pauses[0] == 7
    assert 0 < service.pauses[1] < 7


def test_pauses_grow_to_a_limit() -> None:
    service = Scripted(*[refused(503, AWAY)] * 12, OK)
    service.connection.send("GET", "/v1/x")
    for number, pause in enumerate(service.pauses):
        longest = min(0.2 * 2**number, LONGEST_PAUSE_S)
        assert longest / 2 <= pause <= longest


def test_patience_ends() -> None:
    service = Scripted(refused(429, BUSY, retry_after="7"), patience_s=5)
    with pytest.raises(QueueFull) as raised:
        service.connection.send("GET", "/v1/x")
    assert raised.value.retry_after_s == 7
    assert service.pauses == []


def test_a_form_is_opened_anew_for_each_try() -> None:
    service = Scripted(refused(429, BUSY), OK)
    opened: list[int] = []

    def parts(_: object) -> list[tuple[str, Any]]:
        opened.append(1)
        return [("file", ("a.ply", b"ply"))]

    service.connection.send("POST", "/v1/x", files=parts)
    assert len(opened) == 2
    assert all(b'filename="a.ply"' in request.content for request in service.requests)


def test_the_key_goes_along() -> None:
    service = Scripted(OK)
    service.connection.send("GET", "/v1/x")
    assert service.requests[0].headers["Authorization"] == "Bearer secret"


def test_a_redirection_is_not_followed_with_the_key() -> None:
    away = httpx.Response(302, headers={"Location": "http://elsewhere/"})
    service = Scripted(away)
    service.connection.send("GET", "/v1/x")
    assert len(service.requests) == 1


@pytest.mark.parametrize(
    "make",
    [
        lambda: Connection("127.0.0.1:8000"),
        lambda: Connection("file:///etc/passwd"),
        lambda: Connection("http://[::1"),
        lambda: Connection("http://service", "kéy"),
    ],
)
def test_what_is_no_address_or_no_key_is_refused(make: Callable[[], Connection]) -> None:
    with pytest.raises(InvalidSetting) as raised:
        make()
    assert raised.value.field == "url"
