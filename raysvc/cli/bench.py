"""`raysvc bench`: how fast the parts of raysvc are on this machine."""

import json
from pathlib import Path
from typing import Annotated, Final

import typer

from raysvc.cli.arguments import writable
from raysvc.cli.progress import progress_bar
from raysvc.cli.tables import bench_table, show
from raysvc.compare.benchmark import bench_structures
from raysvc.errors import InvalidSetting
from raysvc.loading import load_scene
from raysvc.parallel import Control

BENCHES: Final = ("structures",)


def bench(
    name: Annotated[str, typer.Argument(help="What to measure: structures.")],
    output: Annotated[Path | None, typer.Option("--json", help="A file for the results.")] = None,
    scene: Annotated[
        list[str] | None,
        typer.Option("--scene", help="A scene file, or builtin:NAME; may be repeated."),
    ] = None,
    count: Annotated[
        int, typer.Option("--count", min=1, max=10_000_000, help="Rays of each kind.")
    ] = 100_000,
    rounds: Annotated[int, typer.Option("--rounds", min=1, max=100, help="Timed rounds.")] = 5,
) -> None:
    """Measure every structure on five kinds of rays, against Embree."""
    if name not in BENCHES:
        raise InvalidSetting(f"unknown benchmark {name!r}; there is {', '.join(BENCHES)}", "NAME")
    if output is not None:
        writable(output, "--json")
    with progress_bar(f"bench {name}") as report:
        scenes = {source: load_scene(source) for source in scene or ["builtin:torus_park"]}
        measured = bench_structures(scenes, count, rounds, control=Control(on_progress=report))
    if output is not None:
        output.write_text(json.dumps(measured, indent=2) + "\n", encoding="utf-8")
    show(bench_table(measured["results"]))
