import sqlite3
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing
from dataclasses import replace
from pathlib import Path

import pytest

from raysvc.compare.settings import ComparisonSettings
from raysvc.errors import DeadlineExceeded, InvalidScene, RaysvcError, StorageFull
from raysvc.frame.probe import Probe
from raysvc.frame.settings import Settings
from raysvc.frame.view import View
from raysvc.jobs import ComparisonRequest, IdempotencyKey, JobState, Ledger, RenderRequest
from raysvc.jobs.ledger import LEDGER_FILE
from raysvc.jobs.model import JobRecord
from tests.jobs.requests import request

Opened = Callable[..., Ledger]


@pytest.fixture
def opened(tmp_path: Path) -> Iterator[Opened]:
    with ExitStack() as stack:

        def open_ledger(owner: str = "me", kept: int = 100, life_s: float = 1000.0) -> Ledger:
            return stack.enter_context(closing(Ledger(tmp_path, owner, kept, life_s)))

        yield open_ledger


def record(id: str = "job", **changes: object) -> JobRecord:
    new = JobRecord(id, request(), JobState.QUEUED, 0, False, 0.0, 1.0, None, None, None, None)
    return replace(new, **changes)  # type: ignore[arg-type]


DONE = {"state": JobState.DONE, "finished_s": 3.0}


@pytest.mark.parametrize(
    "asked",
    [
        request(seed=3, threads=2),
        RenderRequest(
            "a" * 64,
            "b" * 64,
            View(eye=(0.1, 0.2, 0.3), f_number=1.4, focal_length_mm=50),
            Settings(background=(0.1, 0.2, 0.3)),
            Probe(probe_at=(1.0, 2.0, 3.0), without=(1, "glass")),
        ),
        ComparisonRequest("a" * 64, ComparisonSettings(structures=("bvh:max_leaf=4",))),
    ],
)
def test_a_job_is_read_as_it_was_written(opened: Opened, asked: RenderRequest) -> None:
    written = record(
        request=asked,
        attempts=2,
        starts=4,
        interruptions=1,
        heartbeat_s=0.7,
        cancel_asked=True,
        stage_fraction=0.25,
        started_s=0.1 + 0.2,
        statistics={"rays": {"shadow": 7}, "seconds": 0.1 + 0.2},
        **DONE,
    )
    opened().accept(written)
    read = opened().find("job")
    assert read == written
    assert read is not None and read.request.name == asked.name


def test_an_error_is_read_as_it_was_written(opened: Opened) -> None:
    ledger = opened()
    for error in (InvalidScene("broken", field="meshes"), DeadlineExceeded("late")):
        ledger.accept(record(str(error), error=error, state=JobState.FAILED, finished_s=2.0))
        read = ledger.find(str(error))
        assert read is not None and read.error is not None
        assert type(read.error) is type(error)
        assert (read.error.message, read.error.field) == (error.message, error.field)
        assert read.error.retryable == error.retryable


def test_what_is_unfinished_comes_in_the_order_in_which_it_was_accepted(opened: Opened) -> None:
    ledger = opened()
    for name in ("c", "a", "b", "d"):
        ledger.accept(record(name))
    ledger.write(record("a", **DONE))
    ledger.write(record("d", state=JobState.RUNNING, attempts=1, started_s=2.0))
    found = [(each.id, each.state) for each in opened("other").unfinished()]
    assert found == [
        ("c", JobState.QUEUED),
        ("b", JobState.QUEUED),
        ("d", JobState.RUNNING),
    ]


def test_finished_jobs_are_forgotten_oldest_first_and_others_never(opened: Opened) -> None:
    ledger = opened(kept=3)
    ledger.accept(record("waits"))
    for n in range(5):
        ledger.accept(record(str(n), state=JobState.DONE, finished_s=10.0 - n))
    assert ledger.find("waits") is not None
    assert [n for n in range(5) if ledger.find(str(n))] == [0, 4]


def test_a_key_stands_for_its_job_until_it_is_too_old(opened: Opened) -> None:
    opened().accept(record(), IdempotencyKey("key", "fingerprint"))
    assert opened().keyed("key") == ("fingerprint", "job")
    assert opened().keyed("another") is None
    hasty = opened(life_s=0.0)
    assert hasty.keyed("key") is None
    hasty.accept(record("next"), IdempotencyKey("key", "another"))
    assert opened().keyed("key") == ("another", "next")


def test_a_key_goes_with_its_job(opened: Opened) -> None:
    ledger = opened(kept=1)
    ledger.accept(record(**DONE), IdempotencyKey("key", "fingerprint"))
    for n in range(2):
        ledger.accept(record(str(n), **DONE))
    assert ledger.find("job") is None
    assert ledger.keyed("key") is None


def test_a_refused_key_leaves_no_job(opened: Opened) -> None:
    ledger = opened()
    ledger.accept(record("first"), IdempotencyKey("key", "fingerprint"))
    with pytest.raises(RaysvcError):
        ledger.accept(record("second"), IdempotencyKey("key", "another"))
    assert ledger.find("second") is None


def heartbeat_s(ledger: Ledger, id: str) -> float | None:
    read = ledger.find(id)
    assert read is not None
    return read.heartbeat_s


def test_a_running_job_has_a_heartbeat(opened: Opened) -> None:
    ledger = opened()
    ledger.accept(record())
    assert heartbeat_s(ledger, "job") is None
    ledger.write(record(state=JobState.RUNNING, attempts=1, started_s=2.0, heartbeat_s=2.0))
    assert heartbeat_s(ledger, "job") == 2.0
    ledger.beat("job")
    second = heartbeat_s(ledger, "job")
    assert second is not None and second > 2.0


def test_a_ledger_of_the_layout_before_is_read(tmp_path: Path, opened: Opened) -> None:
    with closing(opened()) as ledger:
        ledger.accept(record(attempts=2), IdempotencyKey("key", "print"))
    with closing(sqlite3.connect(tmp_path / LEDGER_FILE)) as old:
        old.executescript(
            "ALTER TABLE jobs DROP COLUMN starts; ALTER TABLE jobs DROP COLUMN interruptions;"
            "ALTER TABLE idempotency_keys RENAME TO keys; PRAGMA user_version = 1;"
        )
    for _ in range(2):
        with closing(opened()) as ledger:
            assert ledger.find("job") == record(attempts=2, starts=2)
            assert ledger.keyed("key") == ("print", "job")


def test_who_lost_a_job_can_move_it_no_more(opened: Opened) -> None:
    running = record(state=JobState.RUNNING, attempts=1, started_s=2.0)
    slow, quick = opened("slow"), opened("quick")
    slow.accept(record())
    slow.write(running)
    with pytest.raises(RaysvcError, match="taken job job over"):
        quick.write(record(**DONE))
    quick.take_over()
    beaten_s = heartbeat_s(quick, "job")
    slow.beat("job")
    assert heartbeat_s(quick, "job") == beaten_s
    with pytest.raises(RaysvcError, match="taken job job over"):
        slow.write(record(**DONE))
    quick.write(record(**DONE))
    assert quick.find("job") == record(**DONE)


def test_many_threads_write_and_read(opened: Opened) -> None:
    ledger = opened(kept=1000)

    def write(part: int) -> None:
        for n in range(20):
            ledger.accept(record(f"{part}-{n}"))
            ledger.write(record(f"{part}-{n}", **DONE))
            assert ledger.find(f"{part}-{n}") is not None

    threads = [threading.Thread(target=write, args=(part,)) for part in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert ledger.unfinished() == []
    assert all(ledger.find(f"{part}-{n}") for part in range(4) for n in range(20))


def test_a_request_that_is_no_longer_known_is_written_off(opened: Opened, tmp_path: Path) -> None:
    opened().accept(record())
    with closing(sqlite3.connect(tmp_path / LEDGER_FILE)) as file, file:
        file.execute("""UPDATE jobs SET request = '{"kind": "render", "scene": "x"}'""")
    assert opened().unfinished() == []
    with closing(sqlite3.connect(tmp_path / LEDGER_FILE)) as file:
        assert file.execute("SELECT state FROM jobs").fetchone() == ("failed",)


def test_a_full_disk_is_said_to_be_full_and_recovered_from(opened: Opened) -> None:
    ledger = opened()
    ledger.accept(record("first"))
    # SQLite may have no more pages than there are: what a full disk looks like to it.
    (pages,) = ledger._writer.execute("PRAGMA page_count").fetchone()
    ledger._writer.execute(f"PRAGMA max_page_count = {pages}")
    with pytest.raises(StorageFull):
        for n in range(1000):
            ledger.accept(record(str(n), statistics={"text": "x" * 10_000}))
    ledger._writer.execute("PRAGMA max_page_count = 1000000")
    ledger.accept(record("last"))
    assert ledger.find("first") and ledger.find("last")


@pytest.mark.parametrize("content", [b"no database" * 1000, None])
def test_a_file_that_is_not_ours_is_refused_by_name(
    opened: Opened, tmp_path: Path, content: bytes | None
) -> None:
    path = tmp_path / LEDGER_FILE
    if content is not None:
        path.write_bytes(content)
    else:
        with closing(sqlite3.connect(path)) as file:
            file.execute("PRAGMA user_version = 99")
    with pytest.raises(RaysvcError, match=LEDGER_FILE):
        opened()
