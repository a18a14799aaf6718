import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from raysvc.errors import Gone, InvalidSetting, NotFinished, NotFound, QueueFull
from raysvc.frame.settings import Settings
from raysvc.frame.view import View
from raysvc.jobs import JobState, PatternRenderer, RenderRequest, RenderService, ServiceOptions
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
    service = service_in(tmp_path, PatternRenderer(), result_memory_bytes=1)
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


def test_closing_cancels_what_waits_and_what_runs_too_long(tmp_path: Path) -> None:
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
    assert running.state is JobState.CANCELLED
    assert waiting.state is JobState.CANCELLED
    with pytest.raises(QueueFull):
        service.submit(request(service, width=10))
