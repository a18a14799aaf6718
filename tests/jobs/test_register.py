"""What happens between the ledger and the line, and when the ledger has no room."""

from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from raysvc.errors import InvalidScene, RaysvcError, StorageFull
from raysvc.jobs import IdempotencyKey, Job, JobQueue, JobState, Ledger, Observer, RenderRequest
from raysvc.jobs.model import JobRecord
from raysvc.jobs.register import JobRegister
from raysvc.parallel import Control
from tests.jobs.requests import job

KEY = IdempotencyKey("key", "print")


class Rig:
    """A register on a ledger whose disk can be full, and its line."""

    def __init__(self, ledger: Ledger, monkeypatch: pytest.MonkeyPatch) -> None:
        self.ledger, self.queue = ledger, JobQueue(8)
        self.register = JobRegister(ledger, self.queue, Observer())
        self.full = False
        write = ledger.write

        def write_if_there_is_room(record: JobRecord) -> None:
            if self.full:
                raise StorageFull("no room")
            write(record)

        monkeypatch.setattr(ledger, "write", write_if_there_is_room)

    def running(self) -> Job[Any]:
        """A job that was accepted and has begun."""
        some = self.register.accept(job())
        taken = self.queue.take()
        assert taken is some
        assert some.start(Control())
        some.begin()
        return some

    def written(self, id: str) -> JobState:
        """What the next process would read."""
        record = self.ledger.find(id)
        assert record is not None
        return record.state


@pytest.fixture
def rig(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Rig]:
    with closing(Ledger(tmp_path, "me", 100, 1000.0)) as ledger:
        yield Rig(ledger, monkeypatch)


def test_a_key_brings_the_very_job_from_the_commit_on(
    rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    accept, again = rig.ledger.accept, []

    def accept_and_be_asked_again(record: JobRecord, key: IdempotencyKey | None) -> None:
        accept(record, key)
        again.append(rig.register.keyed(KEY, RenderRequest))

    monkeypatch.setattr(rig.ledger, "accept", accept_and_be_asked_again)
    some = rig.register.accept(job(), KEY)
    assert again == [some]


def test_what_the_ledger_refuses_leaves_nothing(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(record: JobRecord, key: IdempotencyKey | None) -> None:
        raise StorageFull("no room")

    monkeypatch.setattr(rig.ledger, "accept", refuse)
    with pytest.raises(StorageFull):
        rig.register.accept(job())
    assert rig.register.unfinished() == []
    assert len(rig.queue) == 0


def test_what_is_written_down_is_accepted_though_the_queue_closes_meanwhile(
    rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    accept = rig.ledger.accept

    def accept_and_drain(record: JobRecord, key: IdempotencyKey | None) -> None:
        accept(record, key)
        rig.queue.close()

    monkeypatch.setattr(rig.ledger, "accept", accept_and_drain)
    some = rig.register.accept(job())
    assert some.state is JobState.QUEUED
    assert [record.id for record in rig.ledger.unfinished()] == [some.id]


@pytest.mark.parametrize("runs", [False, True])
def test_a_cancellation_that_cannot_be_written_down_is_refused(rig: Rig, runs: bool) -> None:
    some = rig.running() if runs else rig.register.accept(job())
    state = some.state
    rig.full = True
    with pytest.raises(StorageFull):
        some.cancel()
    assert some.state is state
    assert not some.record().cancel_asked
    rig.full = False
    some.cancel()
    read = rig.ledger.find(some.id)
    assert read is not None and read.cancel_asked


@pytest.mark.parametrize("when", ["at the next sign of life", "at the next job", "at the end"])
def test_an_end_that_found_no_room_is_written_down_when_there_is(rig: Rig, when: str) -> None:
    some = rig.running()
    rig.full = True
    some.fail(InvalidScene("broken"))
    assert rig.register.unfinished() == [], "it would pin its scene"
    assert rig.register.find(some.id, RenderRequest).state is JobState.FAILED
    assert rig.written(some.id) is JobState.RUNNING
    rig.register.close()
    assert rig.written(some.id) is JobState.RUNNING
    rig.full = False
    if when == "at the next sign of life":
        rig.register.beat(job("another"))
    elif when == "at the next job":
        rig.register.accept(job("another"))
    else:
        rig.register.close()
    assert rig.written(some.id) is JobState.FAILED
    assert rig.register.find(some.id, RenderRequest).state is JobState.FAILED


def test_a_job_that_another_process_took_over_ends_here_all_the_same(
    rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    some = rig.running()

    def taken(record: JobRecord) -> None:
        raise RaysvcError("another process has taken it over")

    monkeypatch.setattr(rig.ledger, "write", taken)
    some.finish({})
    assert some.state is JobState.DONE
    rig.register.close()
