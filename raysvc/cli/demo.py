"""`raysvc demo`: the service started, asked over HTTP, stopped; leaves a picture and timings."""

import json
import tempfile
from pathlib import Path
from typing import Annotated

import typer

from raysvc.cli.arguments import camera_mapping
from raysvc.cli.progress import progress_bar
from raysvc.cli.service_process import running_service
from raysvc.cli.tables import show, stage_table
from raysvc.client import Client
from raysvc.loading.scene_file import BUILTIN_PREFIX

READY_WITHIN_S = 600.0


def demo(
    folder: Annotated[Path, typer.Option("--output", "-o", help="Where the files go.")] = Path(
        "demo"
    ),
    scene: Annotated[str, typer.Option("--scene", help="A built-in scene.")] = "torus_park",
    size: Annotated[str, typer.Option("--size", help="WIDTHxHEIGHT in pixels.")] = "1280x720",
) -> None:
    """Start the service, post a scene to it over HTTP, and leave pictures and timings."""
    camera = camera_mapping(None, size)
    folder.mkdir(parents=True, exist_ok=True)
    with (
        tempfile.TemporaryDirectory(prefix="raysvc-demo-") as data_dir,
        running_service(Path(data_dir)) as service,
        Client(service.url, timeout_s=120.0) as client,
        progress_bar("demo") as report,
    ):
        typer.echo("starting the service; the first time it compiles its kernels", err=True)
        report("getting ready", 0.0)
        service.wait_until(client.ready, READY_WITHIN_S)
        typer.echo(f"posting {scene} to {service.url}/v1/scenes", err=True)
        stored = client.scenes.add(f"{BUILTIN_PREFIX}{scene}")
        if stored.resource["cameras"]:
            camera["gltf_camera"] = 0
        render = client.renders.make(stored.id, camera=camera, on_progress=report)
        for format in ("png", "exr"):
            picture = client.renders.image(render.id, format)
            (folder / f"picture.{format}").write_bytes(picture)
    statistics = render.statistics
    text = json.dumps(dict(statistics), indent=2) + "\n"
    (folder / "stats.json").write_text(text, encoding="utf-8")
    show(stage_table(statistics))
    typer.echo(f"{folder / 'picture.png'}, picture.exr and stats.json are written")
