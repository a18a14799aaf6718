"""Every structure on the five sets of rays, beside Embree, in one run."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Final

from raysvc.accel.registry import STRUCTURES
from raysvc.accel.report import Query
from raysvc.compare.contenders import Contender, contender
from raysvc.compare.machine import machine
from raysvc.compare.measure import Pace, Steps, alone, paces
from raysvc.compare.ray_sets import RAY_KINDS, RayKind, ray_set
from raysvc.compare.settings import ONLY_WHEN_NAMED, Candidate
from raysvc.frame.view import View, camera_from
from raysvc.parallel import Control
from raysvc.scene import Scene
from raysvc.version import VERSION

QUERIES: Final[tuple[Query, ...]] = ("nearest", "occluded")
EMBREE: Final = "embree"


@dataclass(frozen=True, slots=True)
class Result:
    """One structure's pace with one set of rays, one question and so many threads."""

    scene: str
    rays: RayKind
    query: Query
    structure: str
    robust: bool
    """Watertight: no ray slips between triangles that share an edge. All of ours are."""
    threads: int
    mrays_per_s: float
    """Median over the rounds."""
    iqr: float
    """Between the quartiles of the rounds, in Mrays/s."""
    ratio_to_embree: float | None
    """To Embree's pace with the same `robust`; None where Embree cannot run."""


def bench_structures(
    scenes: Mapping[str, Scene],
    count: int,
    rounds: int,
    seed: int = 0,
    control: Control | None = None,
) -> dict[str, Any]:
    """Measure; structures take turns within every round of each set of rays.

    Returns `machine`, `version`, `count`, `rounds`, `seed` and `results`, ready for JSON.
    """
    control = control or Control()
    entrants = _entrants()
    threads = tuple(sorted({1, control.threads}))
    turns = len(entrants) * len(threads) * (rounds + 1)
    steps = Steps(len(scenes) * (1 + len(RAY_KINDS) * len(QUERIES) * turns), control)
    results: list[Result] = []
    with alone(control):
        for name, scene in scenes.items():
            steps.next(f"building over {name}")
            built = [contender(scene, candidate, "one", slice(None)) for candidate, _ in entrants]
            camera = camera_from(_view(scene), scene)
            for kind in RAY_KINDS:
                rays = ray_set(kind, scene, camera, count, seed, control).rays
                for query in QUERIES:
                    speed = paces(built, rays, query, threads, rounds, control, steps.next)
                    results += _results(name, kind, query, entrants, built, speed)
    return {
        "machine": machine(),
        "version": VERSION,
        "count": count,
        "rounds": rounds,
        "seed": seed,
        "results": [asdict(result) for result in results],
    }


def _entrants() -> list[tuple[Candidate, bool]]:
    """Structures that run here, with whether they are watertight; Embree both ways."""
    entrants = []
    for name, entry in STRUCTURES.items():
        if name in ONLY_WHEN_NAMED or entry.why_not() is not None:
            continue
        if "robust" in entry.params.model_fields:
            for robust in (True, False):
                entrants.append((Candidate(name, name, {"robust": robust}), robust))
        else:
            entrants.append((Candidate(name, name, {}), True))
    return entrants


def _view(scene: Scene) -> View:
    """The scene's own camera if it has one."""
    return View(gltf_camera=0) if scene.cameras else View()


def _results(
    scene: str,
    kind: RayKind,
    query: Query,
    entrants: Sequence[tuple[Candidate, bool]],
    built: Sequence[Contender],
    speed: Mapping[tuple[int, int], Pace],
) -> list[Result]:
    embree = {
        (robust, threads): pace.median
        for (place, threads), pace in speed.items()
        for candidate, robust in [entrants[place]]
        if candidate.name == EMBREE
    }
    results = []
    for (place, threads), pace in speed.items():
        robust, theirs = entrants[place][1], embree.get((entrants[place][1], threads))
        results.append(
            Result(
                scene,
                kind,
                query,
                built[place].candidate.label,
                robust,
                threads,
                pace.median,
                pace.iqr,
                None if theirs is None else pace.median / theirs,
            )
        )
    return results
