"""What the lens costs, by size of blur and by bokeh; and how near it is to a sampled lens."""

import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Final

import numpy as np

from raysvc.compare.machine import machine
from raysvc.compare.measure import Steps, alone
from raysvc.compare.picture_comparison import reference_settings
from raysvc.compare.picture_difference import PictureDifference, picture_difference
from raysvc.frame.frame import Frame
from raysvc.frame.render import render
from raysvc.frame.settings import Settings
from raysvc.frame.view import View
from raysvc.imaging.ssim import ssim
from raysvc.lens.aperture import Aperture
from raysvc.lens.bokeh import Bokeh
from raysvc.lens.gather import gather
from raysvc.lens.spread import spread
from raysvc.parallel import Control
from raysvc.scene import Environment, Scene
from raysvc.types import Floats
from raysvc.version import VERSION

DIAMETERS_PX: Final = (2, 4, 8, 16, 32, 64, 128)
LAYERS: Final = 4
SEED: Final = 1
FRAMES: Final[Mapping[str, Mapping[str, Any]]] = {
    "none": {"lens": "none"},
    "gather": {"lens": "gather"},
    "spread": {"lens": "spread"},
    "fine": {"lens": "spread", "aa": "accumulate", "aa_samples": 16},
}
"""What is compared, and how it differs from a subject's settings."""
PINHOLE_M: Final = 1e-9
"""Radius of a lens that blurs nothing, through which pictures can be accumulated all the same."""
Blur = Callable[[Floats, Floats, Control], Floats]


@dataclass(frozen=True, slots=True)
class LensCost:
    """Time for one picture whose blur goes evenly from -max_coc_px at the left to +max_coc_px."""

    max_coc_px: int
    order: int
    shape: str
    """`box`, `disc`, `6 blades`; or `gather`."""
    layers: int
    width: int
    height: int
    threads: int
    seconds: float
    """Median over the rounds."""
    iqr: float


@dataclass(frozen=True, slots=True)
class LensTruth:
    """A frame's lens against as many samples of the lens."""

    scene: str
    against: str
    """`accumulated`: pictures of the same renderer, shaded alike; or `reference` mode."""
    lens: str
    """`spread`; `gather`; `fine`, which spreads what `aa=accumulate` makes of 16 pictures; `none`,
    a frame without a lens against samples without one, which is what the rest of the frame
    contributes; or `alone`, what `spread` makes of nothing but the sampled picture of `none` and
    its depth."""
    max_coc_px: float
    samples: int
    ssim: float
    flip: float
    seconds: float
    """Of the lens and of what it needs before: the stages `lens` and `peel`; 0 for `alone`."""


@dataclass(frozen=True, slots=True, eq=False)
class LensSubject:
    """A scene as it is looked at through a lens."""

    scene: Scene
    view: View
    environment: Environment | None = None
    settings: Settings = field(default_factory=Settings)


def bench_lens(
    subjects: Mapping[str, LensSubject],
    samples: int,
    size: tuple[int, int] = (1280, 720),
    rounds: int = 5,
    control: Control | None = None,
    show: Callable[[str, PictureDifference], None] | None = None,
) -> dict[str, Any]:
    """Measure the lens.

    Parameters
    ----------
    subjects
        what is rendered both ways, by name
    samples
        of the reference, per pixel
    size
        width and height of the pictures that are timed
    show
        is given `NAME_LENS_AGAINST` and what was compared

    Returns `machine`, `version`, `rounds`, `results` (LensCost) and `truth` (LensTruth), ready for
    JSON.
    """
    control = control or Control()
    steps = Steps((rounds + 1) * len(DIAMETERS_PX) + 8 * len(subjects), control)
    with alone(control):
        costs = _costs(size, rounds, steps, control)
        truths = [
            truth
            for name, subject in subjects.items()
            for truth in _truths(name, subject, samples, steps, control, show)
        ]
    return {
        "machine": machine(),
        "version": VERSION,
        "rounds": rounds,
        "results": [asdict(cost) for cost in costs],
        "truth": [asdict(truth) for truth in truths],
    }


def ramp(diameter_px: float, width: int, height: int) -> Floats:
    """(H, W) circles of confusion that go evenly from -diameter_px to diameter_px."""
    line = np.linspace(-diameter_px, diameter_px, width, dtype=np.float32)
    return np.broadcast_to(line, (height, width)).copy()


def _contenders() -> dict[tuple[str, int], Blur]:
    """By name of the shape and order."""
    bokehs = {
        ("box", 1): Bokeh("box", 1),
        ("box", 2): Bokeh("box", 2),
        ("box", 3): Bokeh("box", 3),
        ("disc", 1): Bokeh(),
        ("6 blades", 1): Bokeh(aperture=Aperture(6)),
    }

    def spreading(bokeh: Bokeh) -> Blur:
        return lambda rgba, coc, control: spread(rgba, coc, bokeh, LAYERS, control)

    found: dict[tuple[str, int], Blur] = {key: spreading(bokeh) for key, bokeh in bokehs.items()}
    return found | {("gather", 1): gather}


def _costs(size: tuple[int, int], rounds: int, steps: Steps, control: Control) -> list[LensCost]:
    width, height = size
    rng = np.random.default_rng(SEED)
    rgba = rng.random((height, width, 4)).astype(np.float32) ** 3
    rgba[..., 3] = 1.0
    quiet, contenders = control.quiet(), _contenders()
    seconds: dict[tuple[int, str, int], list[float]] = {}
    # All take turns in every round, so that a busy moment of the machine harms none alone.
    for number in range(rounds + 1):
        for diameter in DIAMETERS_PX:
            steps.next("blurring")
            coc = ramp(diameter, width, height)
            for (shape, order), blur in contenders.items():
                start = time.perf_counter()
                blur(rgba, coc, quiet)
                if number > 0:
                    taken = seconds.setdefault((diameter, shape, order), [])
                    taken.append(time.perf_counter() - start)
    return [
        LensCost(
            diameter,
            order,
            shape,
            0 if shape == "gather" else LAYERS,
            width,
            height,
            control.threads,
            float(np.median(taken)),
            float(np.subtract(*np.percentile(taken, [75, 25]))),
        )
        for (diameter, shape, order), taken in seconds.items()
    ]


def _truths(
    name: str,
    subject: LensSubject,
    samples: int,
    steps: Steps,
    control: Control,
    show: Callable[[str, PictureDifference], None] | None,
) -> list[LensTruth]:
    quiet, settings = control.quiet(), subject.settings

    def rendered(view: View, changes: dict[str, Any]) -> Frame:
        return render(
            subject.scene,
            subject.environment,
            view,
            settings.model_copy(update=changes),
            control=quiet,
        )

    accumulated = {"lens": "accumulate", "lens_samples": samples}
    reference = reference_settings(settings, samples).model_dump()
    pinhole = subject.view.model_copy(update={"aperture_radius": PINHOLE_M, "f_number": None})
    true: dict[tuple[str, bool], Floats] = {}
    for against, changes in (("accumulated", accumulated), ("reference", reference)):
        for sharp, view in ((False, subject.view), (True, pinhole)):
            steps.next(f"sampling {name}")
            true[against, sharp] = rendered(view, changes).layers["beauty"]
    found = []

    def compare(lens: str, against: str, picture: Floats, largest_px: float, spent: float) -> None:
        difference = picture_difference(
            picture,
            true[against, lens == "none"],
            settings.tone_map,
            settings.exposure_stops,
            quiet,
        )
        if show is not None:
            show(f"{name}_{lens}_{against}", difference)
        found.append(
            LensTruth(
                name,
                against,
                lens,
                largest_px,
                samples,
                ssim(difference.picture, difference.reference),
                difference.figures.flip,
                spent,
            )
        )

    for lens, differs in FRAMES.items():
        steps.next(f"rendering {name}")
        frame = rendered(subject.view, dict(differs))
        stages = {stage.name: stage.seconds for stage in frame.statistics.stages}
        spent, largest_px = stages["lens"] + stages["peel"], frame.statistics.max_coc_px
        for against in ("accumulated", "reference"):
            compare(lens, against, frame.layers["beauty"], largest_px, spent)
    alone = spread(true["accumulated", True], frame.layers["coc"], settings.bokeh, control=quiet)
    compare("alone", "accumulated", alone, largest_px, 0.0)
    return found
