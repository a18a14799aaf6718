"""What a probe costs, kept and rebuilt: `python -m bench.probe [--rounds N] [--json OUT]`.

Prints a Markdown table. Frames of a scene take turns: with reflected rays, with a probe that is
kept from the frame before, with one that moves and is captured anew in every frame, and with a
scene that moves too, so that trees are refitted before that. The median over the rounds counts.
"""

import argparse
import json
import statistics
import sys
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

import raysvc
from raysvc.compare.machine import machine
from raysvc.frame.statistics import Statistics
from raysvc.scene import Scene
from raysvc.version import VERSION

VIEW = {"gltf_camera": "default", "width": 640, "height": 360}
THINGS = {"builtin:shiny": 1, "builtin:torus_park": 0}
"""Number of the object in whose middle the probe is, and which it leaves out."""
SIZES = (64, 128, 256)
STEP_M = 1e-3
"""By which a probe moves from frame to frame."""

Kind = tuple[str, int | None]
"""What shows reflections, and a probe's size."""
Make = Callable[[], Statistics]


@dataclass(frozen=True, slots=True)
class Point:
    """A frame and what it took."""

    scene: str
    reflections: str
    size: int | None
    seconds: float
    """Median of whole frames."""
    capture_seconds: float
    tables_seconds: float
    reflections_seconds: float
    """Of the stages that show what is reflected: probe, reflections, light and edges."""


def main() -> None:
    """Measure, print, and write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    points = [point for name in THINGS for point in measured(name, arguments.rounds)]
    lines = [
        "| scene | reflections | size | frame s | capture ms | tables ms | stages s |",
        "|---|---|--:|--:|--:|--:|--:|",
    ]
    lines += [
        f"| `{p.scene}` | {p.reflections} | {p.size or '-'} | {p.seconds:.2f} | "
        f"{1e3 * p.capture_seconds:.0f} | {1e3 * p.tables_seconds:.0f} | "
        f"{p.reflections_seconds:.2f} |"
        for p in points
    ]
    sys.stdout.write("\n".join(lines) + "\n")
    if arguments.json:
        results = [asdict(point) for point in points]
        text = {"machine": machine(), "version": VERSION, "results": results}
        arguments.json.write_text(json.dumps(text, indent=2) + "\n", encoding="utf-8")


def measured(name: str, rounds: int) -> list[Point]:
    """Render all kinds of frames of one scene, once and then in every round."""
    scene = raysvc.load(name)
    thing = scene.triangles[scene.object_of_triangle == THINGS[name]]
    corners = scene.positions[thing].reshape(-1, 3)
    middle = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
    turn = 0

    def probe(size: int, shift_m: float = 0.0) -> dict[str, Any]:
        at = [float(middle[0]) + shift_m, float(middle[1]), float(middle[2])]
        return {"probe_at": at, "size": size, "without": [THINGS[name]]}

    def swollen() -> Scene:
        positions = scene.positions.copy()
        vertices = np.unique(thing)
        positions[vertices] = middle + (positions[vertices] - middle) * (1.0 + 1e-3 * turn)
        return scene.deformed(positions)

    def rays() -> Statistics:
        return _frame(scene, None)

    def kept(size: int) -> Make:
        return lambda: _frame(scene, probe(size))

    def rebuilt(size: int) -> Make:
        return lambda: _frame(scene, probe(size, STEP_M * turn))

    def moving(size: int) -> Make:
        return lambda: _frame(swollen(), probe(size, STEP_M * turn))

    # Only a few probes of a scene are kept: each size has its own turns.
    groups: list[dict[Kind, Make]] = [{("rays", None): rays}]
    for size in SIZES:
        groups.append({("probe, kept", size): kept(size), ("probe, rebuilt", size): rebuilt(size)})
    groups.append({("probe and scene, rebuilt", 128): moving(128)})
    points = []
    for kinds in groups:
        frames: dict[Kind, list[Statistics]] = {key: [] for key in kinds}
        for number in range(rounds + 1):
            turn += 1
            for key, render in kinds.items():
                frame = render()
                if number:
                    frames[key].append(frame)
        points += [_point(name, *key, seen) for key, seen in frames.items()]
    return points


def _frame(scene: Scene, environment: Mapping[str, Any] | None) -> Statistics:
    return raysvc.render(scene, environment, VIEW).statistics


def _point(scene: str, kind: str, size: int | None, frames: list[Statistics]) -> Point:
    for frame in frames:
        cost = frame.probe
        assert (cost is None) == (size is None)
        assert cost is None or cost.rebuilt == ("rebuilt" in kind)

    def median(value: Callable[[Statistics], float]) -> float:
        return statistics.median(value(frame) for frame in frames)

    shown = ("probe", "reflections", "light", "edges")
    return Point(
        scene,
        kind,
        size,
        median(lambda frame: frame.total_seconds),
        median(lambda frame: frame.probe.capture_seconds if frame.probe else 0.0),
        median(lambda frame: frame.probe.tables_seconds if frame.probe else 0.0),
        median(lambda frame: sum(s.seconds for s in frame.stages if s.name in shown)),
    )


if __name__ == "__main__":
    main()
