import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from raysvc.errors import Cancelled, Crashed, InvalidScene, StorageFull
from raysvc.jobs import Job, JobState
from raysvc.jobs.model import MOST_ATTEMPTS, MOST_FALSE_STARTS, TRANSITIONS, JobRecord
from raysvc.parallel import Control
from tests.jobs.requests import job, request


def running(attempts: int, cancel_asked: bool = False) -> JobRecord:
    """What a process that died leaves of a job that it was doing."""
    return JobRecord(
        "job", request(), JobState.RUNNING, attempts, cancel_asked, 0.5, 1.0, 2.0, None, None, None
    )


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


def test_an_interrupted_job_waits_again_and_the_attempt_does_not_count() -> None:
    some, control = job(), Control()
    some.start(control)
    some.report("light", 0.5)
    some.interrupt()
    with pytest.raises(Cancelled):
        control.check()
    some.stop()
    assert (some.state, some.attempts, some.stage_fraction) == (JobState.QUEUED, 0, 0.0)
    assert not some.finished.done()
    assert some.start(Control())


def test_every_move_is_kept_before_it_is_seen() -> None:
    some, kept = job(), []

    def keep(record: JobRecord) -> None:
        kept.append((record.state, some.state))

    some.keep = keep
    some.start(Control())
    some.finish({})
    assert kept == [
        (JobState.RUNNING, JobState.QUEUED),
        (JobState.DONE, JobState.RUNNING),
    ]


def test_a_move_that_cannot_be_kept_is_not_made() -> None:
    some = job()

    def keep(record: JobRecord) -> None:
        raise StorageFull("no room")

    some.keep = keep
    with pytest.raises(StorageFull):
        some.cancel()
    assert some.state is JobState.QUEUED


@pytest.mark.parametrize("attempts", range(1, MOST_ATTEMPTS))
def test_a_job_whose_process_died_waits_again(attempts: int) -> None:
    some = Job.restored(running(attempts))
    some.recover()
    assert (some.state, some.attempts) == (JobState.QUEUED, attempts)


def test_a_job_whose_process_died_too_often_fails_and_says_so() -> None:
    some = Job.restored(running(MOST_ATTEMPTS))
    some.recover()
    assert some.state is JobState.FAILED
    assert isinstance(some.error, Crashed) and "3 times" in some.error.message


def test_a_job_that_came_to_keep_its_result_is_done_however_often_it_was_tried() -> None:
    some = Job.restored(running(MOST_ATTEMPTS))
    some.recover({"seconds": 1.0})
    assert (some.state, some.statistics) == (JobState.DONE, {"seconds": 1.0})


def test_an_attempt_counts_once_it_has_begun() -> None:
    some, kept = job(), []
    some.keep = kept.append
    some.start(Control())
    assert (some.attempts, kept[-1].attempts, kept[-1].starts) == (1, 0, 1)
    some.begin()
    some.begin()
    assert [(record.attempts, record.starts) for record in kept] == [(0, 1), (1, 1)]
    some.stop()
    assert (kept[-1].attempts, kept[-1].starts, kept[-1].interruptions) == (0, 1, 1)


def test_a_process_that_dies_before_it_begins_is_not_the_jobs_fault_until_it_often_does() -> None:
    some = job()
    for starts in range(1, MOST_FALSE_STARTS + 1):
        assert some.start(Control())
        record = some.record()
        assert (record.attempts, record.starts) == (0, starts)
        some = Job.restored(record)
        some.recover()
        assert some.state is (JobState.QUEUED if starts < MOST_FALSE_STARTS else JobState.FAILED)
    assert isinstance(some.error, Crashed) and "10 times" in some.error.message


def test_a_result_that_was_held_is_an_attempt_as_well() -> None:
    some = job()
    some.start(Control())
    some.finish({})
    assert some.attempts == some.record().attempts == 1


def test_revisions_grow_over_an_interruption() -> None:
    some = job()
    for _ in range(3):
        some.start(Control())
        some.begin()
        some.report("light", 0.5)
        before = some.revision
        some.stop()
        some = Job.restored(some.record())
        assert some.revision > before


def test_a_running_job_has_a_heartbeat() -> None:
    some = job()
    assert some.heartbeat_s is None
    some.start(Control())
    first = some.heartbeat_s
    some.report("light", 0.5)
    assert first is not None and some.heartbeat_s is not None
    assert some.created_s <= first <= some.heartbeat_s
    assert Job.restored(some.record()).heartbeat_s == some.heartbeat_s


def test_a_job_that_was_to_be_cancelled_when_its_process_died_is() -> None:
    some = Job.restored(running(1, cancel_asked=True))
    some.recover()
    assert some.state is JobState.CANCELLED


def test_revisions_only_grow_also_over_a_restart() -> None:
    some, revisions = job(), []

    def note() -> None:
        revisions.append(some.revision)

    some.start(Control())
    note()
    some.report("light", 0.5)
    note()
    some = Job.restored(some.record())
    some.recover()
    note()
    some.start(Control())
    note()
    some.finish({})
    note()
    assert revisions == sorted(set(revisions))
    assert Job.restored(some.record()).revision == some.revision


MOVES = {
    "start": lambda some: some.start(Control()),
    "begin": lambda some: some.begin(),
    "finish": lambda some: some.finish({}),
    "fail": lambda some: some.fail(InvalidScene("broken")),
    "stop": lambda some: some.stop(),
    "cancel": lambda some: some.cancel(),
    "interrupt": lambda some: some.interrupt(),
    "recover": lambda some: some.recover(),
}


@given(st.lists(st.sampled_from(sorted(MOVES)), max_size=12))
def test_whatever_is_asked_a_job_moves_as_the_table_says(moves: list[str]) -> None:
    some = job()
    kept = [JobState.QUEUED]
    some.keep = lambda record: kept.append(record.state)
    for move in moves:
        before = some.state
        try:
            MOVES[move](some)
        except AssertionError:
            assert some.state is before
            kept.pop() if kept[-1] is not before else None
    for before, after in itertools.pairwise(kept):
        assert after is before or after in TRANSITIONS[before]
    assert some.finished.done() == (not TRANSITIONS[some.state])
    assert (some.finished_s is not None) == some.finished.done()


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
