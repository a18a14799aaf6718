"""What a warm frame costs, and how that grows with bounces, pixels, triangles and threads.

Each series varies one thing and leaves the rest as asked. Its frames are rendered once before they
count, and then take turns in every round, so that a machine that is busy for a while slows all of
them; the median over the rounds counts.
"""

import statistics
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Final, Literal, get_args

import numpy as np

from raysvc.compare.machine import machine
from raysvc.compare.measure import Steps, alone, thread_counts
from raysvc.compare.tessellation import tessellated
from raysvc.errors import InvalidSetting
from raysvc.frame.render import render
from raysvc.frame.settings import Settings
from raysvc.frame.statistics import StageTime, Statistics
from raysvc.frame.view import View, camera_from
from raysvc.parallel import Control
from raysvc.scene import Scene
from raysvc.version import VERSION

Series = Literal["stages", "bounces", "resolution", "triangles", "threads"]
SERIES: Final[tuple[Series, ...]] = get_args(Series)

BOUNCES: Final = (0, 1, 2, 3, 5, 8)
SIZES: Final = (0.25, 0.5, 0.75, 1.0, 1.5)
"""Of the asked width and height; by default 320x180 to 1920x1080."""
MOST_TRIANGLES: Final = 3_000_000
MOST_PARTS: Final = 8
"""A triangle is cut into 1, 4, 9 ... parts, up to the square of this and as long as the scene then
has at most MOST_TRIANGLES."""


@dataclass(frozen=True, slots=True)
class FramePoint:
    """A frame of a series, and what it took."""

    series: Series
    point: str
    """What is varied, for people: `3`, `640x360`."""
    scene: str
    width: int
    height: int
    triangles: int
    threads: int
    settings: Mapping[str, Any]
    """All of them."""
    seconds: float
    """Median over the rounds."""
    iqr: float
    """Seconds between the quartiles of the rounds."""
    stages: tuple[StageTime, ...]
    """Medians over the rounds."""
    rays: Mapping[str, int]
    """Traced in one frame, by purpose."""
    edge_fraction: float


@dataclass(frozen=True, slots=True, eq=False)
class _Subject:
    """A frame that will be rendered."""

    series: Series
    point: str
    name: str
    scene: Scene
    parts: int
    """Into the square of this the scene's triangles are cut."""
    view: View
    settings: Settings


def bench_frame(
    scenes: Mapping[str, Scene],
    series: Sequence[str] = SERIES,
    view: View | None = None,
    settings: Settings | None = None,
    rounds: int = 5,
    control: Control | None = None,
) -> dict[str, Any]:
    """Measure frames of scenes, by the names they have in the results.

    Parameters
    ----------
    series
        some of SERIES; `stages` is the frame as it was asked for, by itself
    view, settings
        what is not varied; without a camera a scene's own first one is taken

    Returns `machine`, `version`, `rounds` and `results`, ready for JSON. Raises InvalidSetting,
    LimitExceeded, Cancelled.
    """
    view, settings, control = view or View(), settings or Settings(), control or Control()
    chosen = dict.fromkeys(_known(name) for name in series)
    turns = [
        _subjects(name, each, scene, _seen_from(view, scene), settings, control)
        for name, scene in scenes.items()
        for each in chosen
    ]
    steps = Steps((rounds + 1) * sum(len(subjects) for subjects in turns), control)
    results: list[FramePoint] = []
    with alone(control):
        for subjects in turns:
            results += _measured(subjects, rounds, steps, control)
    return {
        "machine": machine(),
        "version": VERSION,
        "rounds": rounds,
        "results": [asdict(result) for result in results],
    }


def _known(name: str) -> Series:
    for series in SERIES:
        if name == series:
            return series
    raise InvalidSetting(f"unknown {name!r}; there is {', '.join(SERIES)}", field="series")


def _seen_from(view: View, scene: Scene) -> View:
    """The scene's own camera, if it has one and no other was asked for."""
    free = view.eye is None and view.world_from_camera is None and view.gltf_camera is None
    takes = free and view.target is None and bool(scene.cameras)
    return view.model_copy(update={"gltf_camera": 0}) if takes else view


def _subjects(
    name: str, series: Series, scene: Scene, view: View, settings: Settings, control: Control
) -> list[_Subject]:
    """The frames of one series; refuses what cannot be rendered before time is spent."""

    def subject(point: str, *, seen: View = view, parts: int = 1, **changed: int) -> _Subject:
        camera_from(seen, scene)
        asked = settings.model_copy(update=changed)
        return _Subject(series, point, name, scene, parts, seen, asked)

    if series == "bounces":
        return [subject(str(n), bounces=n) for n in BOUNCES]
    if series == "threads":
        most = control.limited(settings.threads, None).threads
        return [subject(str(n), threads=n) for n in thread_counts(most)]
    if series == "resolution":
        sized = [_sized(view, factor) for factor in SIZES]
        return [subject(f"{each.width}x{each.height}", seen=each) for each in sized]
    if series == "triangles":
        count = len(scene.triangles)
        return [
            subject(f"{n * n * count:,}", parts=n)
            for n in range(1, MOST_PARTS + 1)
            if n == 1 or n * n * count <= MOST_TRIANGLES
        ]
    return [subject("frame")]


def _sized(view: View, factor: float) -> View:
    width, height = (max(round(side * factor), 1) for side in (view.width, view.height))
    return view.model_copy(update={"width": width, "height": height})


def _measured(
    subjects: Sequence[_Subject], rounds: int, steps: Steps, control: Control
) -> list[FramePoint]:
    """Render every frame of a series once and then in every round."""
    scenes = []
    for subject in subjects:
        control.check()
        scenes.append(tessellated(subject.scene, subject.parts))
    frames: list[list[Statistics]] = [[] for _ in subjects]
    for number in range(rounds + 1):
        for subject, scene, seen in zip(subjects, scenes, frames, strict=True):
            steps.next(f"{subject.series}, {subject.point}")
            frame = render(
                scene,
                camera=subject.view,
                settings=subject.settings,
                control=control.quiet(),
            )
            if number:
                seen.append(frame.statistics)
    return [_point(subject, seen) for subject, seen in zip(subjects, frames, strict=True)]


def _point(subject: _Subject, frames: Sequence[Statistics]) -> FramePoint:
    seconds = [frame.total_seconds for frame in frames]
    low, high = np.percentile(seconds, [25.0, 75.0])
    stages = zip(*(frame.stages for frame in frames), strict=True)
    one = frames[0]
    return FramePoint(
        series=subject.series,
        point=subject.point,
        scene=subject.name,
        width=one.width,
        height=one.height,
        triangles=one.triangles,
        threads=one.threads,
        settings=subject.settings.model_dump(mode="json"),
        seconds=statistics.median(seconds),
        iqr=float(high - low),
        stages=tuple(
            StageTime(stage[0].name, statistics.median(each.seconds for each in stage))
            for stage in stages
        ),
        rays=one.rays,
        edge_fraction=one.edge_fraction,
    )
