"""`raysvc inspect`: what is in a scene."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from raysvc.cli.arguments import writable
from raysvc.cli.tables import plain_table
from raysvc.jobs.summary import scene_summary
from raysvc.loading import load_scene
from raysvc.loading.shape_file import npy_of


def inspect(
    scene: Annotated[str, typer.Argument(help="A scene file, or builtin:NAME.")],
    as_json: Annotated[bool, typer.Option("--json", help="Say it in JSON.")] = False,
    positions: Annotated[
        Path | None,
        typer.Option("--positions", help="An .npy file for where the vertices are."),
    ] = None,
) -> None:
    """Say what is in a scene: counts, materials, textures, cameras, lights, bounds, warnings."""
    if positions is not None:
        writable(positions, "--positions")
    inspected = load_scene(scene)
    summary = scene_summary(inspected)
    if positions is not None:
        positions.write_bytes(npy_of(inspected.positions))
    if as_json:
        typer.echo(json.dumps(summary, indent=2))
    else:
        _show(summary)


def _show(summary: Mapping[str, Any]) -> None:
    console = Console(markup=False, highlight=False)
    bounds = summary["bounds"]
    size = [high - low for low, high in zip(bounds["min"], bounds["max"], strict=True)]
    console.print(
        plain_table(
            ("what", "how much"),
            [
                ("triangles", f"{summary['triangles']:,}"),
                ("vertices", f"{summary['vertices']:,}"),
                ("objects", f"{summary['objects']:,}"),
                ("bounds, from (m)", _vector(bounds["min"])),
                ("bounds, to (m)", _vector(bounds["max"])),
                ("size (m)", _vector(size)),
                ("textures", len(summary["textures"])),
                ("cameras", len(summary["cameras"])),
                ("lights", len(summary["lights"])),
            ],
            numbers=(1,),
        )
    )
    for title, columns in (
        ("materials", ("name", "triangles", "metallic", "roughness", "alpha_mode")),
        ("textures", ("name", "width", "height")),
        ("cameras", ("name", "fov_y_deg", "height_m")),
        ("lights", ("name", "kind", "intensity")),
    ):
        rows = [[entry[column] for column in columns] for entry in summary[title]]
        if rows:
            table = plain_table(columns, rows)
            table.title = title
            console.print(table)
    for warning in summary["warnings"]:
        console.print(f"warning: {warning}")


def _vector(values: list[float]) -> str:
    return "  ".join(f"{value:.4g}" for value in values)
