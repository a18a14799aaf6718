"""Everything that a service offers, at one address."""

import json
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import httpx

from raysvc.client.comparisons import Comparisons
from raysvc.client.connection import Connection
from raysvc.client.renders import Renders
from raysvc.client.scene_files import main_among, scene_files
from raysvc.client.stored import Environments, Scenes
from raysvc.loading.scene_file import BUILTIN_PREFIX


class Client:
    """A service; close it when done, or use it in a `with`.

    Parameters
    ----------
    url
        where the service is, such as `http://127.0.0.1:8000`
    key
        an API key, if the service wants one
    timeout_s
        how long the service may be silent
    patience_s
        how long a request that may be repeated is repeated while the service is busy or away
    transport
        what carries requests; by default the network
    """

    def __init__(
        self,
        url: str,
        key: str | None = None,
        *,
        timeout_s: float = 60.0,
        patience_s: float = 60.0,
        transport: httpx.BaseTransport | None = None,
    ) -> None:
        self._connection = Connection(
            url, key, timeout_s=timeout_s, patience_s=patience_s, transport=transport
        )
        self.scenes = Scenes(self._connection, "/v1/scenes")
        self.environments = Environments(self._connection, "/v1/environments")
        self.renders = Renders(self._connection, "/v1/renders")
        self.comparisons = Comparisons(self._connection, "/v1/comparisons")

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Let go of the network."""
        self._connection.close()

    def alive(self) -> bool:
        """Whether the service's process lives. Raises Unreachable where nothing answers."""
        return self._connection.send("GET", "/healthz", accepted=(503,)).is_success

    def ready(self) -> bool:
        """Whether work may come. Raises Unreachable where nothing answers."""
        return self._connection.send("GET", "/readyz", accepted=(503,)).is_success

    def structures(self) -> list[dict[str, Any]]:
        """The acceleration structures that there are, with their parameters."""
        answer: dict[str, Any] = self._connection.send("GET", "/v1/structures").json()
        structures: list[dict[str, Any]] = answer["structures"]
        return structures

    def metrics(self) -> str:
        """What Prometheus would read."""
        return self._connection.send("GET", "/metrics").text

    def render(
        self,
        scene: str | Path,
        environment: str | None = None,
        camera: Mapping[str, Any] | None = None,
        settings: Mapping[str, Any] | None = None,
        format: str = "png",
    ) -> bytes:
        """A picture in one request: a scene's file or name and what else there is to say.

        Not repeated when its answer is lost: `scenes.add` and `renders.make` are for what matters.
        """
        texts = {
            name: json.dumps(dict(part))
            for name, part in (("camera", camera), ("settings", settings))
            if part is not None
        }
        if environment is not None:
            texts["environment"] = environment
        files: dict[str, Path] = {}
        if isinstance(scene, str) and scene.startswith(BUILTIN_PREFIX):
            texts["scene"] = scene
        else:
            files = scene_files(Path(scene))
            main = main_among(list(files))
            texts |= {} if main is None else {"main": main}

        def parts(stack: ExitStack) -> list[tuple[str, Any]]:
            opened = [
                ("scene", (name, stack.enter_context(path.open("rb"))))
                for name, path in files.items()
            ]
            # Texts without a file name: a form of texts alone would not be multipart otherwise.
            return opened + [(name, (None, text)) for name, text in texts.items()]

        params = {"format": format}
        return self._connection.send("POST", "/v1/render", files=parts, params=params).content

    def lens(
        self,
        picture: Path,
        camera: Mapping[str, Any],
        depth: Path | None = None,
        settings: Mapping[str, Any] | None = None,
        depth_scale_m: float | None = None,
        format: str = "png",
    ) -> bytes:
        """A picture of any renderer with depth of field, as a file."""
        texts = {"camera": json.dumps(dict(camera)), "settings": json.dumps(dict(settings or {}))}
        if depth_scale_m is not None:
            texts["depth_scale_m"] = repr(depth_scale_m)

        def parts(stack: ExitStack) -> list[tuple[str, Any]]:
            named = [("picture", picture), *([] if depth is None else [("depth", depth)])]
            opened: list[tuple[str, Any]] = [
                (field, (path.name, stack.enter_context(path.open("rb")))) for field, path in named
            ]
            return opened + [(name, (None, text)) for name, text in texts.items()]

        params = {"format": format}
        # It makes nothing that stays, so that it may be asked twice.
        answer = self._connection.send(
            "POST", "/v1/lens", files=parts, params=params, repeatable=True
        )
        return answer.content
