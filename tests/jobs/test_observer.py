"""What an observer hears of jobs, and what caches count."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from raysvc.errors import InvalidSetting
from raysvc.frame.settings import Settings
from raysvc.frame.view import View
from raysvc.jobs import (
    Job,
    Observer,
    Observers,
    PatternRenderer,
    RenderRequest,
    RenderService,
    ServiceOptions,
)
from raysvc.jobs.lru import Counts, LeastRecentlyUsed


class Heard(Observer):
    """Writes down what it hears."""

    def __init__(self) -> None:
        self.events: list[tuple[str, str, str]] = []

    def accepted(self, job: Job[Any]) -> None:
        self.events.append(("accepted", job.id, ""))

    def ended(self, job: Job[Any]) -> None:
        assert job.finished_s is not None
        self.events.append(("ended", job.id, str(job.state)))


Submit = Callable[[int], Job[RenderRequest]]


@pytest.fixture
def heard() -> Heard:
    return Heard()


def service_with(
    folder: Path, heard: Heard, renderer: PatternRenderer
) -> tuple[RenderService, Submit]:
    service = RenderService(
        ServiceOptions(folder), lambda scenes, environments, limits: renderer, Observers(heard)
    )
    scene, _ = service.scenes.add_builtin("cornell")

    def submit(width: int) -> Job[RenderRequest]:
        view = View.model_validate({"width": width, "height": 4})
        return service.submit(RenderRequest(scene.id, None, view, Settings()))

    return service, submit


def test_each_job_is_accepted_once_and_ends_once(tmp_path: Path, heard: Heard) -> None:
    service, submit = service_with(tmp_path, heard, PatternRenderer())
    service.start()
    jobs = [submit(width) for width in (4, 5, 4)]
    for job in jobs:
        job.finished.result(5)
    service.close(1.0)
    assert sorted(heard.events) == sorted(
        event for job in jobs for event in (("accepted", job.id, ""), ("ended", job.id, "done"))
    )


@pytest.mark.parametrize("ends", ["failed", "cancelled"])
def test_a_job_that_comes_to_nothing_ends_too(tmp_path: Path, heard: Heard, ends: str) -> None:
    fault = InvalidSetting("is wrong", "settings") if ends == "failed" else None
    service, submit = service_with(tmp_path, heard, PatternRenderer(fault=fault))
    job = submit(4)
    if ends == "cancelled":
        job.cancel()  # while it waits
    service.start()
    job.finished.result(5)
    service.close(1.0)
    assert heard.events == [("accepted", job.id, ""), ("ended", job.id, ends)]


def test_how_many_jobs_wait_is_known(tmp_path: Path, heard: Heard) -> None:
    service, submit = service_with(tmp_path, heard, PatternRenderer())
    submit(4)
    submit(5)
    assert service.waiting == 2
    service.close(0.1)


def test_every_cache_says_what_it_holds(tmp_path: Path, heard: Heard) -> None:
    service, _ = service_with(tmp_path, heard, PatternRenderer())
    assert set(service.caches) == {"scenes", "environments", "results", "comparisons"}
    assert service.caches["scenes"].held_bytes > 0
    service.close(0.1)


def test_every_folder_says_what_it_holds(tmp_path: Path, heard: Heard) -> None:
    service, _ = service_with(tmp_path, heard, PatternRenderer())
    assert set(service.folders) == {"scenes", "environments", "results"}
    for name, counts in service.folders.items():
        files = (tmp_path / name).rglob("*")
        assert counts.held_bytes == sum(path.stat().st_size for path in files if path.is_file())
    assert service.folders["scenes"].held_bytes > 0
    service.close(0.1)


def test_a_mapping_counts_what_it_finds_misses_and_evicts() -> None:
    kept: LeastRecentlyUsed[bytes] = LeastRecentlyUsed(5, len)
    kept.put("a", b"123")
    kept.get("a")
    kept.get("b")
    kept.put("b", b"1234")
    kept.put("b", b"12")
    kept.drop("b")
    kept.get("a")
    assert kept.counts == Counts(hits=1, misses=2, evictions=1, held_bytes=0)
