"""`raysvc demo`: the service started, asked over HTTP, stopped; leaves a picture and timings."""

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from raysvc.cli.arguments import camera_mapping
from raysvc.cli.progress import progress_bar
from raysvc.cli.tables import show, stage_table
from raysvc.client import Client
from raysvc.errors import RaysvcError
from raysvc.loading.scene_file import BUILTIN_PREFIX

READY_WITHIN_S = 600.0
LOOK_EVERY_S = 0.2


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
        _service(Path(data_dir)) as url,
        Client(url, timeout_s=120.0) as client,
        progress_bar("demo") as report,
    ):
        typer.echo("starting the service; the first time it compiles its kernels", err=True)
        report("getting ready", 0.0)
        _wait_until_ready(client)
        typer.echo(f"posting {scene} to {url}/v1/scenes", err=True)
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


@contextmanager
def _service(data_dir: Path) -> Iterator[str]:
    """Run the service on a free port; yields its address."""
    command = [sys.executable, "-m", "raysvc", "serve", "--port", "0", "--data-dir", str(data_dir)]
    log = data_dir / "log.txt"
    with (
        log.open("wb") as errors,
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=errors, text=True) as process,
    ):
        try:
            assert process.stdout is not None
            address = process.stdout.readline().rpartition(" ")[2].strip()
            if not address.startswith("http"):
                process.wait()
                raise RaysvcError(f"the service did not start: {log.read_text()[-2000:]}")
            yield address
        finally:
            process.terminate()


def _wait_until_ready(client: Client) -> None:
    end = time.monotonic() + READY_WITHIN_S
    while time.monotonic() < end:
        if client.ready():
            return
        time.sleep(LOOK_EVERY_S)
    raise RaysvcError(f"the service was not ready within {READY_WITHIN_S:.0f} s")
