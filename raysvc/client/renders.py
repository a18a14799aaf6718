"""Renders: asked for, followed, looked at."""

from collections.abc import Mapping
from typing import Any

from raysvc.client.following import OnProgress
from raysvc.client.jobs import Jobs
from raysvc.client.resources import Job


class Renders(Jobs):
    """The service's renders."""

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
        return self._submit(body)

    def make(
        self,
        scene: str,
        environment: str | Mapping[str, Any] | None = None,
        camera: Mapping[str, Any] | None = None,
        settings: Mapping[str, Any] | None = None,
        on_progress: OnProgress | None = None,
    ) -> Job:
        """Ask for a picture and wait for it. Raises what makes it fail, and Cancelled."""
        return self._done(self.submit(scene, environment, camera, settings), on_progress)

    def image(self, id: str, format: str = "png", layer: str | None = None) -> bytes:
        """A finished render's picture as a file. Raises NotFinished, Gone, InvalidSetting."""
        params = {"format": format} | ({} if layer is None else {"layer": layer})
        return self._connection.send("GET", f"{self._of(id)}/image", params=params).content
