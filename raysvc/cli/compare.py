"""`raysvc compare`: structures measured on a scene, or a picture of it beside its reference."""

from pathlib import Path
from typing import Annotated, Any

import typer

from raysvc.cli.arguments import (
    ProbeSize,
    ProbeWithout,
    camera_mapping,
    output_format,
    probe_mapping,
    writable,
)
from raysvc.cli.compare_pictures import show_difference
from raysvc.cli.progress import progress_bar
from raysvc.cli.tables import comparison_table, show
from raysvc.compare.compare import compare as compare_structures
from raysvc.compare.settings import candidates, comparison_settings
from raysvc.compare.tables import TABLE_FORMATS, table
from raysvc.errors import InvalidSetting
from raysvc.loading import load_scene
from raysvc.parallel import Control


def compare(
    scene: Annotated[str, typer.Argument(help="A scene file, or builtin:NAME.")],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="The figures: .json .csv or .md; of pictures .json."),
    ] = None,
    rays: Annotated[
        str | None,
        typer.Option("--rays", help="random, primary, reflection, diffuse or shadow."),
    ] = None,
    count: Annotated[int | None, typer.Option("--count", help="How many rays.")] = None,
    seed: Annotated[int | None, typer.Option("--seed", help="Seeds the rays.")] = None,
    structures: Annotated[
        str | None,
        typer.Option("--structures", help="Names, commas between, as in bvh,kd,bvh:max_leaf=4."),
    ] = None,
    trees: Annotated[
        str | None, typer.Option("--trees", help="one, per_material, or both.")
    ] = None,
    camera: Annotated[
        Path | None, typer.Option("--camera", help="A JSON file; by default the scene is framed.")
    ] = None,
    size: Annotated[
        str | None,
        typer.Option("--size", help="WIDTHxHEIGHT of heat maps or pictures, in pixels."),
    ] = None,
    rounds: Annotated[int | None, typer.Option("--rounds", help="Timed rounds.")] = None,
    scaling: Annotated[
        bool, typer.Option("--scaling", help="Also with parts of the triangles, fewer threads.")
    ] = False,
    chart: Annotated[Path | None, typer.Option("--chart", help="A chart: .svg or .png.")] = None,
    heat_map: Annotated[
        Path | None,
        typer.Option("--heat-map", help="Costs by pixel: .png, or .exr with the counts."),
    ] = None,
    pictures: Annotated[
        Path | None,
        typer.Option(
            "--pictures",
            help="Not structures but pictures: a .png of the hybrid one, the path-traced one, "
            "and their difference.",
        ),
    ] = None,
    environment: Annotated[
        str | None,
        typer.Option("--environment", "-e", help="Of pictures: .hdr, .exr or builtin:NAME."),
    ] = None,
    probe_at: Annotated[
        str | None,
        typer.Option(
            "--probe-at", help="Of pictures: X,Y,Z from where glossy surfaces see the scene."
        ),
    ] = None,
    probe_size: ProbeSize = None,
    probe_without: ProbeWithout = None,
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", help="Of pictures: KEY=VALUE of a setting; may be repeated."),
    ] = None,
    samples: Annotated[
        int | None, typer.Option("--samples", help="Of pictures: paths per pixel of the reference.")
    ] = None,
) -> None:
    """Measure acceleration structures on a scene, or a picture of it against its reference."""
    only_structures = {
        "--rays": rays,
        "--count": count,
        "--seed": seed,
        "--structures": structures,
        "--trees": trees,
        "--rounds": rounds,
        "--scaling": scaling or None,
        "--chart": chart,
        "--heat-map": heat_map,
    }
    only_pictures = {
        "--environment": environment,
        "--probe-at": probe_at,
        "--probe-size": probe_size,
        "--probe-without": probe_without,
        "--set": set_,
        "--samples": samples,
    }
    refused = only_pictures if pictures is None else only_structures
    for option, value in refused.items():
        if value is not None:
            other = "needs" if pictures is None else "cannot be given together with"
            raise InvalidSetting(f"{other} --pictures", field=option)
    if pictures is not None:
        view = camera_mapping(camera, size)
        probe = probe_mapping(probe_at, probe_size, probe_without)
        show_difference(scene, environment, probe, view, set_ or [], samples, pictures, output)
        return
    for path, option, formats in (
        (output, "--output", TABLE_FORMATS),
        (chart, "--chart", ("svg", "png")),
        (heat_map, "--heat-map", ("png", "exr")),
    ):
        if path is not None:
            output_format(writable(path, option), option, formats)
    given: dict[str, Any] = {
        "rays": rays,
        "count": count,
        "seed": seed,
        "structures": None if structures is None else tuple(structures.split(",")),
        "trees": trees,
        "rounds": rounds,
    }
    values = {key: value for key, value in given.items() if value is not None}
    settings = comparison_settings(
        {
            **values,
            "camera": camera_mapping(camera, size),
            "scaling": scaling,
            "heat_map": heat_map is not None,
        }
    )
    candidates(settings)
    with progress_bar(scene) as report:
        report("loading", 0.0)
        measured = compare_structures(
            load_scene(scene), settings, source=scene, control=Control(on_progress=report)
        )
    if output is not None:
        text = table(measured, output_format(output, "--output", TABLE_FORMATS))
        output.write_text(text, encoding="utf-8")
    # Matplotlib takes longer to import than the rest of the command line.
    if chart is not None:
        from raysvc.compare.charts import chart as drawn

        chart.write_bytes(drawn(measured, output_format(chart, "--chart", ("svg", "png"))))
    if heat_map is not None:
        from raysvc.compare.heat_map_files import heat_maps_exr, heat_maps_png

        if not measured.heat_maps:
            raise InvalidSetting("no structure that was asked shows its steps", "--heat-map")
        encoders = {"png": heat_maps_png, "exr": heat_maps_exr}
        format = output_format(heat_map, "--heat-map", ("png", "exr"))
        heat_map.write_bytes(encoders[format](measured.heat_maps))
    show(comparison_table(measured))
