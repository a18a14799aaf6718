"""A service to be killed: like `raysvc serve`, and it writes down what it begins to render.

    python -m bench.crash_service DATA_DIR pattern|scene

It says its address in the first line of its output.
"""

import socket
import sys
from pathlib import Path

import uvicorn

from api.app import create_app
from api.settings import ApiSettings
from raysvc.jobs import (
    ContentStore,
    PatternRenderer,
    Picture,
    Renderer,
    RenderRequest,
    SceneRenderer,
)
from raysvc.limits import Limits
from raysvc.parallel import Control
from raysvc.scene import Environment, Scene

BEGUN = "begun.txt"
"""In the data folder: the seeds of the requests that were begun, one a line."""
PATTERN_S = 0.1


class WatchedRenderer:
    """Another renderer, and a line in a file for each picture that it begins."""

    def __init__(self, renderer: Renderer, file: Path) -> None:
        self._renderer, self._file = renderer, file

    def warm_up(self) -> None:
        """As the renderer does."""
        self._renderer.warm_up()

    def render(self, request: RenderRequest, control: Control) -> Picture:
        """As the renderer does."""
        with self._file.open("a", encoding="ascii") as file:
            file.write(f"{request.settings.seed}\n")
        return self._renderer.render(request, control)


def main(folder: Path, kind: str) -> None:
    """Serve until killed."""

    def make_renderer(
        scenes: ContentStore[Scene], environments: ContentStore[Environment], limits: Limits
    ) -> Renderer:
        known: Renderer = PatternRenderer(PATTERN_S)
        if kind == "scene":
            known = SceneRenderer(scenes, environments, limits)
        return WatchedRenderer(known, folder / BEGUN)

    app = create_app(ApiSettings(data_dir=folder, queue_size=10_000, grace_s=0.5), make_renderer)
    listening = socket.create_server(("127.0.0.1", 0))
    sys.stdout.write(f"http://127.0.0.1:{listening.getsockname()[1]}\n")
    sys.stdout.flush()
    uvicorn.Server(uvicorn.Config(app, log_level="error")).run(sockets=[listening])


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2])
