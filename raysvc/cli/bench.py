"""`raysvc bench`: how fast the parts of raysvc are on this machine."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from raysvc.cli.arguments import camera_mapping, output_format, settings_mapping, writable
from raysvc.cli.bench_service import service
from raysvc.cli.progress import progress_bar
from raysvc.cli.tables import bench_table, frame_tables, sat_tables, show
from raysvc.compare.benchmark import bench_structures
from raysvc.compare.frame_scaling import SERIES, bench_frame
from raysvc.compare.lens_benchmark import bench_lens
from raysvc.compare.lens_subjects import lens_subjects
from raysvc.compare.light_errors import DIRECTIONS
from raysvc.compare.picture_comparison import difference_png
from raysvc.compare.picture_difference import PictureDifference
from raysvc.compare.sat_benchmark import SIZE, bench_sat
from raysvc.frame.settings import checked, settings_from
from raysvc.frame.view import View
from raysvc.loading import load_environment, load_scene
from raysvc.parallel import Control
from raysvc.scene import Scene

DEFAULT_SCENE = "builtin:torus_park"
DEFAULT_ENVIRONMENT = "builtin:studio"

bench = typer.Typer(name="bench")

Output = Annotated[Path | None, typer.Option("--json", help="A file for the results.")]
Scenes = Annotated[
    list[str] | None,
    typer.Option("--scene", help="A scene file, or builtin:NAME; may be repeated."),
]
Rounds = Annotated[int, typer.Option("--rounds", min=1, max=100, help="Timed rounds.")]


@bench.callback(invoke_without_command=True)
def _group(context: typer.Context) -> None:
    """Measure how fast the parts of raysvc are on this machine."""
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())
        raise typer.Exit(2)


@bench.command()
def structures(
    output: Output = None,
    scene: Scenes = None,
    count: Annotated[
        int, typer.Option("--count", min=1, max=10_000_000, help="Rays of each kind.")
    ] = 100_000,
    rounds: Rounds = 5,
) -> None:
    """Measure every structure on five kinds of rays, against Embree."""
    _check(output)
    with progress_bar("bench structures") as report:
        measured = bench_structures(
            _loaded(scene), count, rounds, control=Control(on_progress=report)
        )
    _write(output, measured)
    show(bench_table(measured["results"]))


@bench.command()
def frame(
    output: Output = None,
    series: Annotated[
        str, typer.Option("--series", help=f"Some of {', '.join(SERIES)}, commas between.")
    ] = ",".join(SERIES),
    scene: Scenes = None,
    size: Annotated[
        str | None, typer.Option("--size", help="WIDTHxHEIGHT of the picture in pixels.")
    ] = None,
    set_: Annotated[
        list[str] | None, typer.Option("--set", help="KEY=VALUE of a setting; may be repeated.")
    ] = None,
    rounds: Rounds = 5,
    chart: Annotated[Path | None, typer.Option("--chart", help="A chart: .svg or .png.")] = None,
) -> None:
    """Measure a warm frame, and how it scales with bounces, pixels, triangles and threads."""
    _check(output)
    if chart is not None:
        output_format(writable(chart, "--chart"), "--chart", ("svg", "png"))
    settings = settings_from(settings_mapping(set_ or []))
    view = checked(View, camera_mapping(None, size), "camera")
    with progress_bar("bench frame") as report:
        control = Control(on_progress=report)
        measured = bench_frame(_loaded(scene), series.split(","), view, settings, rounds, control)
    _write(output, measured)
    # Matplotlib takes longer to import than the rest of the command line.
    if chart is not None:
        from raysvc.compare.frame_charts import frame_chart

        drawn = frame_chart(measured, output_format(chart, "--chart", ("svg", "png")))
        chart.write_bytes(drawn)
    for each in frame_tables(measured["results"]):
        show(each)


@bench.command()
def sat(
    output: Output = None,
    size: Annotated[
        str, typer.Option("--size", help="WIDTHxHEIGHT of the map in texels.")
    ] = f"{SIZE[0]}x{SIZE[1]}",
    environment: Annotated[
        list[str] | None,
        typer.Option("--environment", "-e", help="An .hdr or .exr, or builtin:NAME; repeatable."),
    ] = None,
    directions: Annotated[
        int, typer.Option("--directions", min=1, max=100_000, help="In which errors are measured.")
    ] = DIRECTIONS,
    rounds: Rounds = 5,
) -> None:
    """Measure summed-area tables, and how fast and how exact the light is that they give."""
    _check(output)
    texels = camera_mapping(None, size)
    maps = {name: load_environment(name) for name in environment or [DEFAULT_ENVIRONMENT]}
    with progress_bar("bench sat") as report:
        control = Control(on_progress=report)
        measured = bench_sat(
            texels["width"],
            texels["height"],
            rounds,
            control=control,
            maps=maps,
            directions=directions,
        )
    _write(output, measured)
    for each in sat_tables(measured["results"]):
        show(each)


@bench.command()
def lens(
    output: Output = None,
    samples: Annotated[
        int, typer.Option("--samples", min=0, max=65536, help="Of the lens; 0 for none.")
    ] = 0,
    scene: Annotated[
        str | None, typer.Option("--scene", help="One more scene file: DepthOfFieldExample.glb.")
    ] = None,
    environment: Annotated[
        str | None, typer.Option("--environment", "-e", help="What lights it, and shiny too.")
    ] = None,
    pictures: Annotated[
        Path | None, typer.Option("--pictures", help="A folder for pictures.")
    ] = None,
    size: Annotated[
        str, typer.Option("--size", help="WIDTHxHEIGHT of the pictures for the truth.")
    ] = "640x360",
    rounds: Rounds = 5,
) -> None:
    """Measure what the lens costs, and how near it is to a sampled one."""
    _check(output)
    if pictures is not None:
        writable(pictures, "--pictures")
    camera = camera_mapping(None, size)
    light = None if environment is None else load_environment(environment)
    subjects = lens_subjects(camera, scene, light) if samples > 0 else {}

    def keep(name: str, difference: PictureDifference) -> None:
        if pictures is not None:
            pictures.mkdir(exist_ok=True)
            (pictures / f"{name}.png").write_bytes(difference_png(difference))

    with progress_bar("bench lens") as report:
        control = Control(on_progress=report)
        measured = bench_lens(subjects, samples, rounds=rounds, control=control, show=keep)
    _write(output, measured)
    show(bench_table(measured["results"]))
    if measured["truth"]:
        show(bench_table(measured["truth"]))


bench.command()(service)


def _check(output: Path | None) -> None:
    if output is not None:
        writable(output, "--json")


def _loaded(sources: list[str] | None) -> dict[str, Scene]:
    return {source: load_scene(source) for source in sources or [DEFAULT_SCENE]}


def _write(output: Path | None, measured: Mapping[str, Any]) -> None:
    if output is not None:
        output.write_text(json.dumps(measured, indent=2) + "\n", encoding="utf-8")
