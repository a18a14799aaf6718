"""Jobs of one kind: asked for, followed, cancelled."""

import secrets
from collections.abc import Mapping
from typing import Any
from urllib.parse import quote

from raysvc.client.connection import Connection
from raysvc.client.following import OnProgress, follow
from raysvc.client.resources import Job


class Jobs:
    """What a service does one after the other; the kinds of it say what can be asked for."""

    def __init__(self, connection: Connection, path: str) -> None:
        self._connection = connection
        self._path = path

    def get(self, id: str) -> Job:
        """How far a job is, and what came of it. Raises NotFound."""
        return Job.of(self._connection.send("GET", self._of(id)).json())

    def wait(
        self, job: Job, on_progress: OnProgress | None = None, timeout_s: float | None = None
    ) -> Job:
        """Wait for its end, however it ends. Raises DeadlineExceeded after `timeout_s`."""
        return follow(self._connection, self._of(job.id), job, on_progress, timeout_s)

    def cancel(self, id: str) -> Job:
        """Ask for its end; one that has ended stays as it is."""
        return Job.of(self._connection.send("DELETE", self._of(id)).json())

    def _submit(self, body: Mapping[str, Any]) -> Job:
        """Ask for a job, under a key by which the service knows a repeated request again."""
        headers = {"Idempotency-Key": secrets.token_hex(16)}
        answer = self._connection.send(
            "POST", self._path, json=body, headers=headers, repeatable=True
        )
        return Job.of(answer.json())

    def _done(self, job: Job, on_progress: OnProgress | None) -> Job:
        """Wait for a job. Raises what makes it fail, and Cancelled."""
        job = self.wait(job, on_progress)
        job.check()
        return job

    def _of(self, id: str) -> str:
        return f"{self._path}/{quote(id, safe='')}"
