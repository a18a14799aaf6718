"""`raysvc render`: a scene file in, a picture file out."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from raysvc.cli.arguments import (
    ProbeSize,
    ProbeWithout,
    camera_mapping,
    checked_output,
    probe_mapping,
    settings_mapping,
    writable,
)
from raysvc.cli.progress import progress_bar
from raysvc.cli.render_remotely import render_remotely
from raysvc.cli.tables import stage_table
from raysvc.client import Client
from raysvc.frame.frame import format_of
from raysvc.frame.render import render as render_frame
from raysvc.frame.settings import checked, settings_from
from raysvc.frame.view import View
from raysvc.loading import load_environment, load_scene
from raysvc.loading.shape_file import load_shape
from raysvc.parallel import Control

PATIENCE_S = 60.0
"""How long a service may be busy or away."""


def render(
    scene: Annotated[str, typer.Argument(help="A scene file, or builtin:NAME.")],
    output: Annotated[
        Path, typer.Option("--output", "-o", help="The picture: .png .jpg .webp .exr or .npz.")
    ],
    environment: Annotated[
        str | None,
        typer.Option("--environment", "-e", help="An .hdr or .exr file, or builtin:NAME."),
    ] = None,
    probe_at: Annotated[
        str | None,
        typer.Option(
            "--probe-at", help="X,Y,Z from where glossy surfaces see the scene, instead of by rays."
        ),
    ] = None,
    probe_size: ProbeSize = None,
    probe_without: ProbeWithout = None,
    positions: Annotated[
        Path | None,
        typer.Option("--positions", help="An .npy file: where the scene's vertices are instead."),
    ] = None,
    camera: Annotated[
        Path | None, typer.Option("--camera", help="A JSON file; by default the scene is framed.")
    ] = None,
    size: Annotated[
        str | None, typer.Option("--size", help="WIDTHxHEIGHT of the picture in pixels.")
    ] = None,
    set_: Annotated[
        list[str] | None, typer.Option("--set", help="KEY=VALUE of a setting; may be repeated.")
    ] = None,
    stats: Annotated[
        Path | None, typer.Option("--stats", help="A JSON file for timings and counts.")
    ] = None,
    server: Annotated[
        str | None,
        typer.Option(
            "--server", envvar="RAYSVC_SERVER", help="URL of a service that does the work."
        ),
    ] = None,
    key: Annotated[
        str | None,
        typer.Option("--key", envvar="RAYSVC_KEY", help="A key, if the service wants one."),
    ] = None,
) -> None:
    """Render a scene to a picture file."""
    checked_output(output)
    if stats is not None:
        writable(stats, "--stats")
    settings = settings_from(settings_mapping(set_ or []))
    probe = probe_mapping(probe_at, probe_size, probe_without)
    view = checked(View, camera_mapping(camera, size), "camera")
    if server is not None:
        with Client(server, key, patience_s=PATIENCE_S) as client, progress_bar(scene) as report:
            data, statistics = render_remotely(
                client,
                scene,
                environment,
                probe,
                positions,
                view,
                settings,
                format_of(output),
                report,
            )
        output.write_bytes(data)
        _say(output, statistics, stats)
        return

    with progress_bar(scene) as report:
        report("loading", 0.0)
        light = None if environment is None else load_environment(environment)
        control = Control(settings.threads, settings.deadline_s, report)
        shown = load_scene(scene)
        if positions is not None:
            shape = load_shape(positions, len(shown.positions))
            shown = shown.deformed(shape.positions, shape.normals)
        around = light if probe is None else {**probe, "environment": light}
        frame = render_frame(shown, around, view, settings, control=control)
    frame.save(output)
    _say(output, frame.statistics.to_dict(), stats)


def _say(output: Path, statistics: Mapping[str, Any], stats: Path | None) -> None:
    """Tell what the picture took, and what is missing in it."""
    if stats is not None:
        stats.write_text(json.dumps(dict(statistics), indent=2) + "\n", encoding="utf-8")
    console = Console(stderr=True)
    for warning in statistics["warnings"]:
        console.print(f"warning: {warning}", markup=False, highlight=False)
    if console.is_terminal:
        console.print(stage_table(statistics))
    typer.echo(
        f"{output}: {statistics['width']}x{statistics['height']} in "
        f"{statistics['total_seconds']:.2f} s"
    )
