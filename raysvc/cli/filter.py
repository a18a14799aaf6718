"""`raysvc filter`: only the filtered maps of an environment, its harmonics, its irradiance."""

import dataclasses
import json
from pathlib import Path
from typing import Annotated, Final

import typer

from raysvc.cli.arguments import output_format, size_of, writable
from raysvc.cli.progress import progress_bar
from raysvc.errors import InvalidInput, InvalidSetting
from raysvc.lighting.filtered_map import MAX_HEIGHT, MAX_WIDTH
from raysvc.lighting.filtered_set import FORMATS, MAX_MAPS, FilteredMaps, filtered_maps
from raysvc.lighting.spherical_harmonics import sh9
from raysvc.limits import DEFAULT_LIMITS
from raysvc.loading import load_environment
from raysvc.parallel import Control

STANDARD_OUTPUT: Final = Path("-")
UNSHARED: Final = dataclasses.replace(
    DEFAULT_LIMITS, max_filtered_texels=MAX_WIDTH * MAX_HEIGHT * MAX_MAPS
)
"""Nobody else waits for this machine."""
SIZE: Final = "512x256"
OPTIONS: Final = {"width": "--size", "height": "--size", "roughness": "--roughness"}


def filter_environment(
    environment: Annotated[str, typer.Argument(help="An .hdr or .exr file, or builtin:NAME.")],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="The map: .exr .hdr .npz or .png."),
    ] = None,
    roughness: Annotated[
        list[float] | None,
        typer.Option("--roughness", "-r", help="0 to 1; may be repeated."),
    ] = None,
    irradiance: Annotated[
        bool, typer.Option("--irradiance", help="Also the irradiance, not divided by pi.")
    ] = False,
    size: Annotated[
        str | None,
        typer.Option("--size", help=f"WIDTHxHEIGHT of the maps in texels; {SIZE} by default."),
    ] = None,
    yaw: Annotated[
        float,
        typer.Option(
            "--yaw",
            min=-36000,
            max=36000,
            help="Degrees that turn it counter-clockwise seen from above.",
        ),
    ] = 0.0,
    strength: Annotated[
        float, typer.Option("--strength", min=0, max=1e6, help="Multiplies its light.")
    ] = 1.0,
    harmonics: Annotated[
        Path | None,
        typer.Option("--sh9", help="A .json file for nine harmonics; - prints them."),
    ] = None,
) -> None:
    """Write an environment filtered for roughnesses, its irradiance, its spherical harmonics."""
    asked = tuple(roughness or ())
    if output is None and harmonics is None:
        raise InvalidSetting("say --output, or --sh9", field="--output")
    if output is None and (asked or irradiance or size is not None):
        raise InvalidSetting("says where the maps go", field="--output")
    if output is not None:
        output_format(writable(output, "--output"), "--output", FORMATS)
    if harmonics is not None and harmonics != STANDARD_OUTPUT:
        output_format(writable(harmonics, "--sh9"), "--sh9", ("json",))
    width_height = size_of(size or SIZE)

    with progress_bar(environment) as report:
        report("loading", 0.0)
        light = load_environment(environment)
        filtered, nine = None, None
        try:
            if harmonics is not None:
                nine = sh9(light, yaw, strength)
            if output is not None:
                filtered = filtered_maps(
                    light,
                    asked,
                    irradiance,
                    width_height,
                    yaw_deg=yaw,
                    strength=strength,
                    limits=UNSHARED,
                    control=Control(on_progress=report),
                )
        except InvalidInput as error:
            error.field = OPTIONS.get(error.field or "", error.field)
            raise
    if filtered is not None and output is not None:
        for path, part in _files(output, filtered):
            path.write_bytes(part.encode(path.suffix.lower().lstrip(".")))
            typer.echo(f"{path}: {width_height[0]}x{width_height[1]}", err=True)
    if harmonics is not None and nine is not None:
        text = json.dumps(nine.to_dict(), indent=2) + "\n"
        if harmonics == STANDARD_OUTPUT:
            typer.echo(text, nl=False)
        else:
            harmonics.write_text(text, encoding="utf-8")


def _files(output: Path, filtered: FilteredMaps) -> list[tuple[Path, FilteredMaps]]:
    """What goes where: one map, or an .npz of all, as it was asked for; else a file for each."""
    if len(filtered.maps) == 1 or output.suffix.lower() == ".npz":
        return [(output, filtered)]
    return [
        (output.with_name(f"{output.stem}_{name}{output.suffix}"), FilteredMaps({name: picture}))
        for name, picture in filtered.maps.items()
    ]
