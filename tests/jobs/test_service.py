import errno
import os
import sqlite3
import threading
import time
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from raysvc.compare.settings import ComparisonSettings
from raysvc.errors import (
    Draining,
    FolderInUse,
    Gone,
    InUse,
    InvalidSetting,
    NotFinished,
    NotFound,
    StorageFull,
)
from raysvc.frame.settings import Settings
from raysvc.frame.view import View
from raysvc.jobs import (
    ComparisonRequest,
    Job,
    JobState,
    PatternRenderer,
    RenderRequest,
    RenderService,
    ServiceOptions,
)
from raysvc.jobs.kept_picture import KeptPicture
from raysvc.jobs.ledger import LEDGER_FILE
from raysvc.parallel import Control
from raysvc.parsing import ParserOptions


def service_in(folder: Path, renderer: PatternRenderer, **options: int) -> RenderService:
    return RenderService(
        ServiceOptions(folder, parsing=ParserOptions(processes=0), **options),  # type: ignore[arg-type]
        lambda scenes, environments, limits: renderer,
    )


@pytest.fixture
def service(tmp_path: Path) -> Iterator[RenderService]:
    service = service_in(tmp_path, PatternRenderer(), queue_size=1, kept_jobs=3)
    service.start()
    yield service
    service.close(1.0)


def request(service: RenderService, **camera: object) -> RenderRequest:
    scene, _ = service.scenes.add_builtin("cornell")
    view = View.model_validate({"width": 8, "height": 4, **camera})
    return RenderRequest(scene.id, None, view, Settings())


def test_a_request_that_was_rendered_is_done_at_once_the_second_time(
    service: RenderService,
) -> None:
    first = service.submit(request(service))
    first.finished.result(5)
    second = service.submit(request(service))
    assert second.state is JobState.DONE
    assert second.id != first.id
    assert service.picture(second) is service.picture(first)


def test_a_camera_that_the_scene_does_not_have_is_refused_before_it_waits(
    service: RenderService,
) -> None:
    with pytest.raises(InvalidSetting) as raised:
        service.submit(request(service, gltf_camera=99))
    assert raised.value.field == "camera.gltf_camera"


def test_old_jobs_are_forgotten_and_running_ones_are_not(service: RenderService) -> None:
    ids = []
    for width in range(1, 6):
        some = service.submit(request(service, width=width))
        some.finished.result(5)
        ids.append(some.id)
    assert service.job(ids[-1], RenderRequest).id == ids[-1]
    with pytest.raises(NotFound):
        service.job(ids[0], RenderRequest)


def test_a_picture_that_is_not_there_yet_or_no_longer_is_said_to_be_so(tmp_path: Path) -> None:
    service = service_in(tmp_path, PatternRenderer(), result_memory_bytes=1, result_disk_bytes=1)
    first = service.submit(request(service))
    with pytest.raises(NotFinished):
        service.picture(first)
    service.start()
    first.finished.result(5)
    service.submit(request(service, width=9)).finished.result(5)
    with pytest.raises(Gone):
        service.picture(first)
    service.close(1.0)


def test_a_failed_job_says_why_every_time_and_gathers_no_frames(tmp_path: Path) -> None:
    fault = InvalidSetting("is wrong", "settings")
    service = service_in(tmp_path, PatternRenderer(fault=fault))
    service.start()
    failed = service.submit(request(service))
    failed.finished.result(5)
    depths = []
    for _ in range(3):
        with pytest.raises(InvalidSetting) as raised:
            service.picture(failed)
        depths.append(len(raised.traceback))
    assert len(set(depths)) == 1
    service.close(1.0)


def test_closing_leaves_what_waits_and_what_runs_too_long_to_the_next_process(
    tmp_path: Path,
) -> None:
    service = service_in(tmp_path, PatternRenderer(seconds=60.0, steps=6000))
    assert service.not_ready == "warming up"
    service.start()
    running = service.submit(request(service))
    while running.state is JobState.QUEUED:
        time.sleep(0.005)
    waiting = service.submit(request(service, width=9))
    assert service.not_ready is None
    service.close(0.1)
    assert service.not_ready == "draining"
    assert running.state is waiting.state is JobState.QUEUED
    with pytest.raises(Draining):
        service.submit(request(service, width=10))
    following = service_in(tmp_path, PatternRenderer())
    following.start()
    for each in (running, waiting):
        again = following.job(each.id, RenderRequest)
        again.finished.result(5)
        assert (again.state, again.attempts) == (JobState.DONE, 1)
    following.close(1.0)


def test_a_picture_survives_a_restart_with_its_bytes_and_is_not_made_again(tmp_path: Path) -> None:
    service = service_in(tmp_path, PatternRenderer())
    service.start()
    asked = request(service, width=64)
    first = service.submit(asked)
    first.finished.result(5)
    files = [service.picture(first).encode(form) for form in ("png", "exr", "npz")]
    service.close(1.0)
    following = service_in(tmp_path, PatternRenderer(fault=AssertionError("not again")))
    following.start()
    for job in (following.job(first.id, RenderRequest), following.submit(asked)):
        assert job.state is JobState.DONE
        assert job.statistics == first.statistics
        assert [following.picture(job).encode(form) for form in ("png", "exr", "npz")] == files
    following.close(1.0)


def test_a_folder_serves_one_process(tmp_path: Path) -> None:
    service = service_in(tmp_path, PatternRenderer())
    with pytest.raises(FolderInUse, match=f"process {os.getpid()}"):
        service_in(tmp_path, PatternRenderer())
    service.close(1.0)
    service_in(tmp_path, PatternRenderer()).close(1.0)


def test_what_a_job_needs_is_not_deleted_before_it_is_done(tmp_path: Path) -> None:
    service = service_in(tmp_path, PatternRenderer())
    waiting = service.submit(request(service))
    with pytest.raises(InUse):
        service.scenes.delete(waiting.request.scene)
    service.start()
    waiting.finished.result(5)
    assert waiting.state is JobState.DONE
    service.scenes.delete(waiting.request.scene)
    service.close(1.0)


def test_closing_does_not_wait_for_a_warm_up(tmp_path: Path) -> None:
    warm, leave = threading.Event(), threading.Event()

    class Slow(PatternRenderer):
        def warm_up(self) -> None:
            warm.set()
            leave.wait(20)

    service = service_in(tmp_path, Slow())
    service.start()
    waiting = service.submit(request(service))
    warm.wait(5)
    began = time.monotonic()
    service.close(10.0)
    assert time.monotonic() - began < 5
    leave.set()
    following = service_in(tmp_path, PatternRenderer())
    assert following.job(waiting.id, RenderRequest).state is JobState.QUEUED
    following.close(1.0)


def test_readers_of_uploads_start_once_the_kernels_are_warm(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    order: list[str] = []
    started = threading.Event()

    class Noting(PatternRenderer):
        def warm_up(self) -> None:
            time.sleep(0.05)
            order.append("kernels")

    def start() -> None:
        order.append("readers")
        started.set()

    service = service_in(tmp_path, Noting())
    monkeypatch.setattr(service.parser, "start", start)
    service.start()
    assert started.wait(5)
    assert order == ["kernels", "readers"]
    service.close(1.0)


def test_the_grace_begins_with_the_draining(tmp_path: Path) -> None:
    service = service_in(tmp_path, PatternRenderer(seconds=60.0, steps=6000))
    service.start()
    running = service.submit(request(service))
    while running.state is JobState.QUEUED:
        time.sleep(0.005)
    service.drain()
    time.sleep(1.0)
    began = time.monotonic()
    service.close(1.5)
    assert time.monotonic() - began < 1.4
    assert running.state is JobState.QUEUED


@pytest.mark.parametrize("kind", ["render", "comparison"])
def test_a_result_that_was_kept_before_the_third_death_is_not_lost(
    tmp_path: Path, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    service = service_in(tmp_path, PatternRenderer())
    if kind == "render":
        job: Job[Any] = service.submit(request(service))
    else:
        scene, _ = service.scenes.add_builtin("cornell")
        settings = ComparisonSettings(structures=("brute",), count=10, rounds=1)
        job = service.submit_comparison(ComparisonRequest(scene.id, settings))
    service.start()
    job.finished.result(60)
    assert job.state is JobState.DONE
    service.close(1.0)
    with closing(sqlite3.connect(tmp_path / LEDGER_FILE, isolation_level=None)) as ledger:
        ledger.execute(
            "UPDATE jobs SET state = 'running', owner = 'dead', attempts = 3, starts = 3, "
            "finished_s = NULL, statistics = NULL"
        )
    following = service_in(tmp_path, PatternRenderer(fault=AssertionError("not again")))
    again = following.job(job.id, type(job.request))
    assert (again.state, again.statistics) == (JobState.DONE, job.statistics)
    following.close(1.0)


def test_a_comparison_that_is_kept_is_not_measured_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    service = service_in(tmp_path, PatternRenderer())
    scene, _ = service.scenes.add_builtin("cornell")
    settings = ComparisonSettings(structures=("brute",), count=10, rounds=1)
    job = service.submit_comparison(ComparisonRequest(scene.id, settings))
    service.start()
    job.finished.result(60)
    service.close(1.0)
    with closing(sqlite3.connect(tmp_path / LEDGER_FILE, isolation_level=None)) as ledger:
        ledger.execute(
            "UPDATE jobs SET state = 'queued', finished_s = NULL, statistics = NULL, attempts = 0"
        )
    monkeypatch.setattr("raysvc.jobs.scene_comparer.compare", None)
    following = service_in(tmp_path, PatternRenderer())
    again = following.job(job.id, ComparisonRequest)
    following.start()
    again.finished.result(10)
    assert (again.state, again.statistics) == (JobState.DONE, job.statistics)
    following.close(1.0)


def test_two_of_a_request_in_the_line_are_rendered_once(tmp_path: Path) -> None:
    class Counting(PatternRenderer):
        pictures = 0

        def render(self, request: RenderRequest, control: Control) -> KeptPicture:
            Counting.pictures += 1
            return super().render(request, control)

    service = service_in(tmp_path, Counting())
    jobs = [service.submit(request(service)) for _ in range(3)]
    service.start()
    for job in jobs:
        job.finished.result(5)
    assert Counting.pictures == 1
    service.close(1.0)


def test_a_scene_that_a_job_needs_does_not_make_room(tmp_path: Path) -> None:
    service = service_in(tmp_path, PatternRenderer(), scene_disk_bytes=0)
    needed = service.submit(request(service)).request.scene
    service.scenes.add_builtin("glass")
    newest, _ = service.scenes.add_builtin("shiny")
    assert {record.id for record in service.scenes.records()} == {needed, newest.id}
    service.close(1.0)


def test_a_start_with_less_room_keeps_what_jobs_are_going_to_read(tmp_path: Path) -> None:
    first = service_in(tmp_path, PatternRenderer())
    waiting = first.submit(request(first))
    first.scenes.add_builtin("glass")
    unneeded, _ = first.scenes.add_builtin("shiny")
    first.scenes.add_builtin("fence")
    first.close(0.1)
    second = service_in(tmp_path, PatternRenderer(), scene_disk_bytes=1)
    second.start()
    again = second.job(waiting.id, RenderRequest)
    again.finished.result(5)
    assert again.state is JobState.DONE
    assert second.scenes.record(waiting.request.scene)
    with pytest.raises(NotFound):
        second.scenes.record(unneeded.id)
    second.close(1.0)


def full_disk(*_: object) -> None:
    raise OSError(errno.ENOSPC, "No space left on device")


def test_a_render_that_finds_no_room_fails_and_the_next_does_not(
    service: RenderService, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = request(service)
    with monkeypatch.context() as patch:
        patch.setattr("raysvc.jobs.durable_file.os.fsync", full_disk)
        failed = service.submit(asked)
        failed.finished.result(5)
    assert failed.state is JobState.FAILED
    assert isinstance(failed.error, StorageFull) and failed.error.retryable
    again = service.submit(asked)
    again.finished.result(5)
    assert again.state is JobState.DONE


def test_older_results_make_room_on_a_full_disk(
    service: RenderService, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = service.submit(request(service))
    first.finished.result(5)
    fsync, refusals = os.fsync, iter([full_disk])
    monkeypatch.setattr(
        "raysvc.jobs.durable_file.os.fsync", lambda file: next(refusals, fsync)(file)
    )
    second = service.submit(request(service, width=9))
    second.finished.result(5)
    assert second.state is JobState.DONE
    held = {path.name for path in (tmp_path / "results").iterdir() if path.is_file()}
    assert held == {second.request.name}


def test_a_scene_that_finds_no_room_leaves_nothing_behind(
    service: RenderService, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as patch:
        patch.setattr("raysvc.jobs.durable_file.os.fsync", full_disk)
        with pytest.raises(StorageFull, match="the scene"):
            service.scenes.add_builtin("glass")
    assert service.scenes.records() == []
    assert [path.name for path in (tmp_path / "scenes").iterdir()] == ["incoming"]
    assert not list((tmp_path / "scenes" / "incoming").iterdir())
    assert service.scenes.add_builtin("glass")[1]
