import itertools

import pytest

from raysvc.errors import Cancelled, InvalidScene
from raysvc.jobs import JobState
from raysvc.jobs.model import TRANSITIONS
from raysvc.parallel import Control
from tests.jobs.requests import job, request


def test_an_end_is_an_end() -> None:
    for state in (JobState.DONE, JobState.FAILED, JobState.CANCELLED):
        assert not TRANSITIONS[state]
    assert set(TRANSITIONS) == set(JobState)


def test_a_job_that_runs_and_finishes_says_when() -> None:
    some = job()
    assert some.start(Control())
    some.report("light", 0.5)
    some.finish({"total_seconds": 1.0})
    assert some.state is JobState.DONE
    assert some.started_s is not None and some.finished_s is not None
    assert some.created_s <= some.started_s <= some.finished_s
    assert some.finished.done()


def test_a_waiting_job_is_cancelled_at_once_and_never_starts() -> None:
    some = job()
    some.cancel()
    assert some.state is JobState.CANCELLED
    assert not some.start(Control())


def test_a_running_job_is_told_to_stop() -> None:
    some, control = job(), Control()
    some.start(control)
    some.cancel()
    assert some.state is JobState.RUNNING
    with pytest.raises(Cancelled):
        control.check()
    some.stop()
    assert some.state is JobState.CANCELLED


def test_cancelling_what_has_ended_changes_nothing() -> None:
    some = job()
    some.start(Control())
    some.fail(InvalidScene("broken"))
    some.cancel()
    assert some.state is JobState.FAILED


def test_illegal_moves_are_refused() -> None:
    some = job()
    some.start(Control())
    some.finish({})
    with pytest.raises(AssertionError, match="done job cannot become failed"):
        some.fail(InvalidScene("too late"))


def test_a_request_is_named_by_what_decides_its_picture() -> None:
    requests = [request(), request("b" * 64), request(seed=1), request(bounces=3)]
    for first, second in itertools.combinations(requests, 2):
        assert first.name != second.name
    assert request().name == request(threads=3, deadline_s=5.0).name
