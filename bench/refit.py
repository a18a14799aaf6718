"""What refitting costs and saves: `python -m bench.refit [--count N] [--rounds N] [--json OUT]`.

The park with the torus is twisted, or its torus alone made to swell, more and more; for every
structure, the trees that were built for the shape at rest are refitted and others built anew, and
both are asked the same rays, in turns. Prints a Markdown table. `breaks even` is the number of rays
after which a build would have been paid back, on one thread: its time in excess of the refit's over
what each ray then takes less.
"""

import argparse
import json
import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

import raysvc
from raysvc.accel.base import Accelerator, Rays, Triangles
from raysvc.accel.registry import STRUCTURES, build
from raysvc.compare.contenders import Contender
from raysvc.compare.measure import paces
from raysvc.compare.ray_sets import ray_set
from raysvc.compare.settings import Candidate
from raysvc.frame.view import View, camera_from
from raysvc.parallel import Control
from raysvc.scene import Scene
from raysvc.types import Doubles, Floats

SCENE = "builtin:torus_park"
TORUS = 0
"""Number of the object."""
TIMES = 3
"""Refits and builds that are timed; the median counts."""


@dataclass(frozen=True, slots=True)
class Result:
    """One structure around one shape."""

    structure: str
    deformation: str
    refits: bool
    refit_s: float
    build_s: float
    sah_ratio: float | None
    """Surface area cost of the refitted tree to that of the tree around the shape at rest."""
    node_steps_ratio: float | None
    """Node steps per ray of the refitted tree to those of the one built there."""
    mrays_per_s_refitted: float
    mrays_per_s_built: float
    breaks_even_mrays: float | None
    """None where no number of rays pays a build back."""


def twist(scene: Scene, turns: float) -> Doubles:
    """Turn everything about +Y, the more the farther out; `turns` of it at the rim."""
    x, y, z = scene.positions.astype(np.float64).T
    angle = 2.0 * np.pi * turns * np.hypot(x, z) / float(np.abs(scene.bounds()).max())
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.stack([cosine * x + sine * z, y, cosine * z - sine * x], axis=1)


def swell(scene: Scene, amount: float) -> Doubles:
    """Let waves of a part of its size go around the torus, and leave the park alone."""
    positions = scene.positions.astype(np.float64)
    torus = np.unique(scene.triangles[scene.object_of_triangle == TORUS])
    out = positions[torus] - positions[torus].mean(axis=0)
    around = np.arctan2(out[:, 1], out[:, 0])
    positions[torus] += amount * np.sin(5.0 * around)[:, None] * out
    return positions


DEFORMATIONS: dict[str, Callable[[Scene], Doubles | Floats]] = {
    "none": lambda scene: scene.positions,
    "torus swells by 0.3": lambda scene: swell(scene, 0.3),
    **{
        f"twist of {turns:g} turns": lambda scene, turns=turns: twist(scene, turns)
        for turns in (0.01, 0.03, 0.06, 0.1, 0.25, 1.0)
    },
}

ENDS = ("none", "twist of 1 turns")
"""The shapes at which structures that do not refit are looked at."""


def main() -> None:
    """Measure, and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--count", type=int, default=50_000, help="rays")
    parser.add_argument("--rounds", type=int, default=5, help="timed rounds, the median counts")
    parser.add_argument("--json", type=Path, help="a file for the results")
    arguments = parser.parse_args()
    results = measured(raysvc.load(SCENE), arguments.count, arguments.rounds)
    if arguments.json:
        rows = [asdict(result) for result in results]
        arguments.json.write_text(json.dumps({"results": rows}, indent=2) + "\n", encoding="utf-8")
    sys.stdout.write(table(results))


def measured(scene: Scene, count: int, rounds: int) -> list[Result]:
    """Measure every structure but `brute` around every shape, with diffuse rays of that shape."""
    names = [name for name in STRUCTURES if name != "brute" and STRUCTURES[name].why_not() is None]
    at_rest = {name: build(name, Triangles(scene.positions, scene.triangles)) for name in names}
    camera = camera_from(View(gltf_camera="default"), scene)
    results: list[Result] = []
    for deformation, move in DEFORMATIONS.items():
        shape = scene.deformed(move(scene))
        rays = ray_set("diffuse", shape, camera, count, seed=0).rays
        triangles = Triangles(shape.positions, shape.triangles)
        results += [
            _measured(name, at_rest[name], deformation, triangles, rays, rounds)
            for name in names
            if at_rest[name].refits or deformation in ENDS
        ]
    return sorted(results, key=lambda result: names.index(result.structure))


def _measured(
    name: str,
    at_rest: Accelerator,
    deformation: str,
    triangles: Triangles,
    rays: Rays,
    rounds: int,
) -> Result:
    refit_s, refitted = _timed(lambda: at_rest.refitted(triangles.positions))
    build_s, built = _timed(lambda: build(name, triangles))
    candidate = Candidate(name, name, {})
    pair = [Contender(candidate, "one", triangles, each) for each in (refitted, built)]
    speeds = paces(pair, rays, "nearest", [1], rounds, Control(1), lambda stage: None)
    slow, fast = (speeds[place, 1].median for place in (0, 1))
    lost = 1.0 / slow - 1.0 / fast
    steps = [
        counted.node_steps.sum()
        for counted in (each.counted(rays, "nearest") for each in (refitted, built))
        if counted is not None
    ]
    before, after = at_rest.report.sah_cost, refitted.report.sah_cost
    return Result(
        structure=name,
        deformation=deformation,
        refits=at_rest.refits,
        refit_s=refit_s,
        build_s=build_s,
        sah_ratio=None if before is None or after is None else after / before,
        node_steps_ratio=float(steps[0] / steps[1]) if steps else None,
        mrays_per_s_refitted=slow,
        mrays_per_s_built=fast,
        breaks_even_mrays=max(build_s - refit_s, 0.0) / lost if lost > 0.0 else None,
    )


def table(results: list[Result]) -> str:
    """Lay results out in Markdown."""
    lines = [
        "| structure | deformation | refit s | build s | SAH ratio | steps ratio "
        "| Mrays/s refitted | built | time ratio | breaks even, Mrays |",
        "|---|---|--:|--:|--:|--:|--:|--:|--:|--:|",
    ]
    for one in results:
        even = one.breaks_even_mrays if one.refits else None
        cells = (
            f"`{one.structure}`",
            one.deformation,
            f"{one.refit_s:.3f}" if one.refits else "builds",
            f"{one.build_s:.3f}",
            _number(one.sah_ratio),
            _number(one.node_steps_ratio),
            _number(one.mrays_per_s_refitted),
            _number(one.mrays_per_s_built),
            _number(one.mrays_per_s_built / one.mrays_per_s_refitted if one.refits else None),
            _number(even),
        )
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}"


def _timed(make: Callable[[], Accelerator]) -> tuple[float, Accelerator]:
    seconds: list[float] = []
    for _ in range(TIMES):
        start = time.perf_counter()
        made = make()
        seconds.append(time.perf_counter() - start)
    return statistics.median(seconds), made


if __name__ == "__main__":
    main()
