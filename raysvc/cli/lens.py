"""`raysvc lens`: a picture and its depth in, the picture through a lens out."""

import json
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from raysvc.cli.arguments import camera_mapping, checked_output, settings_mapping, writable
from raysvc.errors import InvalidInput
from raysvc.frame.refocus import linear, refocus
from raysvc.limits import DEFAULT_LIMITS
from raysvc.loading.files import read_regular
from raysvc.loading.picture_file import holds_depth, read_depth, read_picture
from raysvc.parallel import Control


def lens(
    picture: Annotated[Path, typer.Argument(help="A picture without a lens: .exr .npz or .png.")],
    output: Annotated[
        Path, typer.Option("--output", "-o", help="The picture: .png .jpg .webp .exr or .npz.")
    ],
    depth: Annotated[
        Path | None,
        typer.Argument(help="Its depth in metres: .exr .npz or .png; by default in PICTURE too."),
    ] = None,
    depth_scale_m: Annotated[
        float | None,
        typer.Option("--depth-scale-m", min=0, help="Metres of one step of grey, of a .png."),
    ] = None,
    camera: Annotated[
        Path | None, typer.Option("--camera", help="A JSON file that says what lens.")
    ] = None,
    camera_set: Annotated[
        list[str] | None,
        typer.Option("--lens", help="KEY=VALUE of the camera; may be repeated."),
    ] = None,
    set_: Annotated[
        list[str] | None, typer.Option("--set", help="KEY=VALUE of a setting; may be repeated.")
    ] = None,
    stats: Annotated[
        Path | None, typer.Option("--stats", help="A JSON file for time and largest blur.")
    ] = None,
) -> None:
    """Give a picture of any renderer depth of field."""
    checked_output(output)
    if stats is not None:
        writable(stats, "--stats")
    view = camera_mapping(camera, None) | settings_mapping(camera_set or [])
    settings = settings_mapping(set_ or [])
    shown = read_regular(picture, DEFAULT_LIMITS.max_file_bytes, "PICTURE")
    deep = shown
    if depth is not None:
        deep = read_regular(depth, DEFAULT_LIMITS.max_file_bytes, "DEPTH")
    elif not holds_depth(shown):
        raise InvalidInput("is missing, and the picture holds none", field="DEPTH")
    found = refocus(
        linear(read_picture(shown, field="PICTURE")),
        read_depth(deep, depth_scale_m=depth_scale_m, field="DEPTH"),
        view,
        settings,
        control=Control(),
    )
    found.save(output)
    statistics = found.statistics()
    if stats is not None:
        stats.write_text(json.dumps(statistics, indent=2) + "\n", encoding="utf-8")
    console = Console(stderr=True)
    for warning in found.warnings:
        console.print(f"warning: {warning}", markup=False, highlight=False)
    typer.echo(
        f"{output}: {statistics['width']}x{statistics['height']}, circles of confusion up to "
        f"{found.max_coc_px:.1f} px, in {found.seconds:.2f} s"
    )
