import threading
import time
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import pytest

from raysvc.errors import DeadlineExceeded, InvalidScene
from raysvc.jobs import (
    Job,
    JobQueue,
    JobState,
    PatternRenderer,
    Picture,
    RenderRequest,
    Worker,
)
from raysvc.parallel import Control
from tests.jobs.requests import job

Start = Callable[[PatternRenderer], tuple[JobQueue, dict[str, Picture]]]


@pytest.fixture
def start() -> Iterator[Start]:
    queues: list[tuple[JobQueue, Worker]] = []

    def begin(renderer: PatternRenderer) -> tuple[JobQueue, dict[str, Picture]]:
        queue, results = JobQueue(8), {}

        def fulfil(job: Job, control: Control) -> Mapping[str, Any]:
            request = job.request
            assert isinstance(request, RenderRequest)
            picture = renderer.render(request, control)
            results[request.name] = picture
            return picture.statistics.to_dict()

        worker = Worker(queue, fulfil, renderer.warm_up, deadline_s=None)
        worker.start()
        queues.append((queue, worker))
        return queue, results

    yield begin
    for queue, worker in queues:
        queue.close()
        assert worker.join(5)


def finished(some: Job) -> Job:
    some.finished.result(5)
    return some


def test_a_job_becomes_a_picture(start: Start) -> None:
    queue, results = start(PatternRenderer())
    some = job()
    queue.put(some)
    assert finished(some).state is JobState.DONE
    picture = results[some.request.name]
    assert picture.encode("png").startswith(b"\x89PNG")
    assert some.statistics is not None and some.statistics["width"] == 8


def test_an_error_of_the_renderer_fails_that_job_alone(start: Start) -> None:
    queue, _ = start(PatternRenderer(fault=InvalidScene("broken", field="meshes")))
    first, second = job("1"), job("2")
    queue.put(first)
    queue.put(second)
    for each in (first, second):
        assert finished(each).state is JobState.FAILED
        assert each.error is not None and each.error.field == "meshes"


@pytest.mark.parametrize("fault", [ZeroDivisionError("secret"), MemoryError()])
def test_a_fault_of_the_code_fails_the_job_without_telling_secrets(
    start: Start, fault: Exception
) -> None:
    queue, _ = start(PatternRenderer(fault=fault))
    some = job()
    queue.put(some)
    assert finished(some).state is JobState.FAILED
    assert "secret" not in str(some.error)


def test_a_running_job_stops_soon_after_it_is_cancelled(start: Start) -> None:
    queue, _ = start(PatternRenderer(seconds=20.0, steps=1000))
    some = job()
    queue.put(some)
    while some.state is JobState.QUEUED:
        time.sleep(0.005)
    some.cancel()
    began = time.monotonic()
    assert finished(some).state is JobState.CANCELLED
    assert time.monotonic() - began < 1.0


def test_a_job_that_takes_too_long_fails_and_may_be_tried_again(start: Start) -> None:
    queue, _ = start(PatternRenderer(seconds=20.0, steps=1000))
    some = job(deadline_s=0.05)
    queue.put(some)
    assert finished(some).state is JobState.FAILED
    assert isinstance(some.error, DeadlineExceeded) and some.error.retryable


def test_a_job_that_gets_on_is_heard_of() -> None:
    beats: list[Job] = []
    queue = JobQueue(1)
    renderer = PatternRenderer(steps=5)

    def fulfil(job: Job, control: Control) -> Mapping[str, Any]:
        return renderer.render(job.request, control).statistics.to_dict()

    worker = Worker(queue, fulfil, renderer.warm_up, None, beats.append)
    some = job()
    queue.put(some)
    worker.start()
    finished(some)
    assert beats == [some] * 5
    assert not worker.stalled
    queue.close()
    assert worker.join(5)


def test_a_job_that_is_deaf_to_its_deadline_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("raysvc.jobs.worker.PATIENCE_S", 0.05)
    queue, ears, heard = JobQueue(1), threading.Event(), threading.Event()

    def fulfil(job: Job, control: Control) -> Mapping[str, Any]:
        heard.set()
        ears.wait(10)
        return {}

    worker = Worker(queue, fulfil, lambda: None, None)
    some = job(deadline_s=0.01)
    queue.put(some)
    worker.start()
    assert heard.wait(5) and not worker.stalled
    while not worker.stalled:
        time.sleep(0.01)
    ears.set()
    finished(some)
    queue.close()
    assert worker.join(5)
    assert not worker.stalled
