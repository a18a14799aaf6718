"""Scenes and environments that the service keeps."""

from contextlib import ExitStack
from pathlib import Path
from typing import Any, Final
from urllib.parse import quote

import httpx

from raysvc.client.connection import Connection
from raysvc.client.resources import Stored
from raysvc.client.scene_files import main_among, scene_files
from raysvc.limits import DEFAULT_LIMITS
from raysvc.loading.files import read_regular
from raysvc.loading.scene_file import BUILTIN_PREFIX

NPY: Final = "application/x-npy"


class Collection:
    """Immutable things, named by their content: adding one twice is one thing."""

    def __init__(self, connection: Connection, path: str) -> None:
        self._connection = connection
        self._path = path

    def get(self, id: str) -> Stored:
        """What is known about one. Raises NotFound."""
        return Stored.of(self._connection.send("GET", self._of(id)).json())

    def delete(self, id: str) -> None:
        """Forget one and its files; needs a key for `admin`. Raises NotFound."""
        self._connection.send("DELETE", self._of(id))

    def _of(self, id: str) -> str:
        return f"{self._path}/{quote(id, safe=':')}"

    def _add_builtin(self, name: str) -> Stored:
        body = {"builtin": name.removeprefix(BUILTIN_PREFIX)}
        answer = self._connection.send("POST", self._path, json=body, repeatable=True)
        return Stored.of(answer.json())

    def _add_files(self, files: dict[str, Path], main: str | None) -> Stored:
        """Send files; doing it twice is harmless, since their content names them."""

        def opened(stack: ExitStack) -> list[tuple[str, Any]]:
            return [
                ("file", (name, stack.enter_context(path.open("rb"))))
                for name, path in files.items()
            ]

        data = {} if main is None else {"main": main}
        answer = self._connection.send("POST", self._path, files=opened, data=data, repeatable=True)
        return Stored.of(answer.json())


class Scenes(Collection):
    """The service's scenes."""

    def add(self, source: str | Path) -> Stored:
        """Send a scene's file with those that it refers to, or name one as `builtin:NAME`.

        Raises InvalidScene, Unsupported, LimitExceeded.
        """
        if isinstance(source, str) and source.startswith(BUILTIN_PREFIX):
            return self._add_builtin(source)
        files = scene_files(Path(source))
        return self._add_files(files, main_among(list(files)))

    def list(self) -> list[Stored]:
        """All of them, newest first."""
        answer = self._connection.send("GET", self._path).json()
        return [Stored.of(resource) for resource in answer["scenes"]]

    def positions(self, id: str) -> bytes:
        """Where a scene's vertices are: an .npy of (V, 3) float32, in metres."""
        return self._connection.send("GET", f"{self._of(id)}/positions").content

    def move(self, id: str, positions: bytes) -> Stored:
        """The scene that is this one with its vertices elsewhere: .npy, .npz or bare float32."""
        answer = self._connection.send(
            "PUT",
            f"{self._of(id)}/positions",
            content=positions,
            headers={"Content-Type": "application/octet-stream"},
        )
        return Stored.of(answer.json())


class Environments(Collection):
    """The service's environments."""

    def add(self, source: str | Path) -> Stored:
        """Send an .hdr or .exr file, or name an environment as `builtin:NAME`."""
        if isinstance(source, str) and source.startswith(BUILTIN_PREFIX):
            return self._add_builtin(source)
        path = Path(source)
        read_regular(path, DEFAULT_LIMITS.max_file_bytes, path.name)
        return self._add_files({path.name: path}, None)

    def list(self) -> list[Stored]:
        """All of them, newest first."""
        answer = self._connection.send("GET", self._path).json()
        return [Stored.of(resource) for resource in answer["environments"]]

    def filtered(self, id: str, format: str = "exr", **asked: Any) -> bytes:
        """Its filtered maps as a file; `asked` are `roughness`, `irradiance`, `width`, ..."""
        return self._filter(id, format, asked).content

    def sh9(self, id: str, **asked: Any) -> dict[str, Any]:
        """Its nine spherical harmonics of radiance and of irradiance."""
        harmonics: dict[str, Any] = self._filter(id, "json", asked).json()
        return harmonics

    def _filter(self, id: str, format: str, asked: dict[str, Any]) -> httpx.Response:
        # It makes nothing that stays, so that it may be asked twice.
        return self._connection.send(
            "POST", f"{self._of(id)}/filtered", json={**asked, "format": format}, repeatable=True
        )
