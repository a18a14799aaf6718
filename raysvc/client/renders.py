"""Renders: asked for, followed, looked at."""

import secrets
from collections.abc import Mapping
from typing import Any
from urllib.parse import quote

from raysvc.client.connection import Connection
from raysvc.client.following import OnProgress, follow
from raysvc.client.resources import Job

PATH = "/v1/renders"


class Renders:
    """The service's renders."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection

    def submit(
        self,
        scene: str,
        environment: str | Mapping[str, Any] | None = None,
        camera: Mapping[str, Any] | None = None,
        settings: Mapping[str, Any] | None = None,
    ) -> Job:
        """Ask for a picture and return at once; ids or `builtin:NAME`, or a probe's fields.

        Raises InvalidInput, NotFound, QueueFull.
        """
        body: dict[str, Any] = {"scene": scene}
        for name, part in (
            ("environment", environment),
            ("camera", camera),
            ("settings", settings),
        ):
            if part is not None:
                body[name] = part if isinstance(part, str) else dict(part)
        return submitted(self._connection, PATH, body)

    def make(
        self,
        scene: str,
        environment: str | Mapping[str, Any] | None = None,
        camera: Mapping[str, Any] | None = None,
        settings: Mapping[str, Any] | None = None,
        on_progress: OnProgress | None = None,
    ) -> Job:
        """Ask for a picture and wait for it. Raises what makes it fail, and Cancelled."""
        job = self.wait(self.submit(scene, environment, camera, settings), on_progress)
        job.check()
        return job

    def get(self, id: str) -> Job:
        """How far a render is. Raises NotFound."""
        return Job.of(self._connection.send("GET", _of(id)).json())

    def wait(
        self, job: Job, on_progress: OnProgress | None = None, timeout_s: float | None = None
    ) -> Job:
        """Wait for its end, however it ends. Raises DeadlineExceeded after `timeout_s`."""
        return follow(self._connection, _of(job.id), job, on_progress, timeout_s)

    def cancel(self, id: str) -> Job:
        """Ask for its end; one that has ended stays as it is."""
        return Job.of(self._connection.send("DELETE", _of(id)).json())

    def image(self, id: str, format: str = "png", layer: str | None = None) -> bytes:
        """A finished render's picture as a file. Raises NotFinished, Gone, InvalidSetting."""
        params = {"format": format} | ({} if layer is None else {"layer": layer})
        return self._connection.send("GET", f"{_of(id)}/image", params=params).content


def submitted(connection: Connection, path: str, body: Mapping[str, Any]) -> Job:
    """Ask for a job, under a key by which the service knows a repeated request again."""
    headers = {"Idempotency-Key": secrets.token_hex(16)}
    answer = connection.send("POST", path, json=body, headers=headers, repeatable=True)
    return Job.of(answer.json())


def _of(id: str) -> str:
    return f"{PATH}/{quote(id, safe='')}"
