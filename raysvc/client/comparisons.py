"""Comparisons of acceleration structures: asked for, followed, read."""

from typing import Any
from urllib.parse import quote

from raysvc.client.following import OnProgress
from raysvc.client.jobs import Jobs
from raysvc.client.resources import Job


class Comparisons(Jobs):
    """The service's comparisons."""

    def submit(self, scene: str, **asked: Any) -> Job:
        """Ask for a measurement and return at once; `asked` are `rays`, `count`, ..."""
        return self._submit({"scene": scene, **asked})

    def make(self, scene: str, on_progress: OnProgress | None = None, **asked: Any) -> Job:
        """Ask for a measurement and wait for it; its `resource` holds the figures."""
        return self._done(self.submit(scene, **asked), on_progress)

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
        return self._connection.send("GET", f"{self._of(id)}/{quote(name, safe='')}").content
