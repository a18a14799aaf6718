"""Comparisons of acceleration structures: asked for, followed, read."""

from typing import Any
from urllib.parse import quote

from raysvc.client.connection import Connection
from raysvc.client.following import OnProgress, follow
from raysvc.client.renders import submitted
from raysvc.client.resources import Job

PATH = "/v1/comparisons"


class Comparisons:
    """The service's comparisons."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection

    def submit(self, scene: str, **asked: Any) -> Job:
        """Ask for a measurement and return at once; `asked` are `rays`, `count`, ..."""
        return submitted(self._connection, PATH, {"scene": scene, **asked})

    def make(self, scene: str, on_progress: OnProgress | None = None, **asked: Any) -> Job:
        """Ask for a measurement and wait for it; its `resource` holds the figures."""
        job = self.wait(self.submit(scene, **asked), on_progress)
        job.check()
        return job

    def get(self, id: str) -> Job:
        """How far a comparison is, and what was measured. Raises NotFound."""
        return Job.of(self._connection.send("GET", _of(id)).json())

    def wait(
        self, job: Job, on_progress: OnProgress | None = None, timeout_s: float | None = None
    ) -> Job:
        """Wait for its end, however it ends. Raises DeadlineExceeded after `timeout_s`."""
        return follow(self._connection, _of(job.id), job, on_progress, timeout_s)

    def cancel(self, id: str) -> Job:
        """Ask for its end; one that has ended stays as it is."""
        return Job.of(self._connection.send("DELETE", _of(id)).json())

    def table(self, id: str, format: str = "csv") -> bytes:
        """The figures as `json`, `csv` or `md`."""
        return self._file(id, f"table.{format}")

    def chart(self, id: str, format: str = "svg") -> bytes:
        """The figures as a chart, `svg` or `png`."""
        return self._file(id, f"chart.{format}")

    def heat_map(self, id: str, format: str = "png") -> bytes:
        """Steps and tests by pixel, `png` or `exr`, where `heat_map` was asked for."""
        return self._file(id, f"heat_map.{format}")

    def _file(self, id: str, name: str) -> bytes:
        return self._connection.send("GET", f"{_of(id)}/{quote(name, safe='')}").content


def _of(id: str) -> str:
    return f"{PATH}/{quote(id, safe='')}"
