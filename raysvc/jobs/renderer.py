"""What a service asks for pictures: the contract, and a renderer that only paints a pattern."""

import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from raysvc.jobs.kept_picture import KeptPicture, KeptStatistics
from raysvc.jobs.requests import RenderRequest
from raysvc.parallel import Control
from raysvc.version import VERSION


class Statistics(Protocol):
    """How a picture came about."""

    def to_dict(self) -> dict[str, Any]:
        """Ready for JSON."""


class Picture(Protocol):
    """What a render leaves: `raysvc.frame.frame.Frame` is one."""

    @property
    def layers(self) -> Mapping[str, NDArray[Any]]:
        """Arrays of (H, W) or (H, W, channels) by name."""

    @property
    def statistics(self) -> Statistics:
        """How the picture came about."""

    def encode(self, format: str, layer: str | None = None) -> bytes:
        """Return a file. Raises InvalidSetting for a format or layer that there is not."""


class Renderer(Protocol):
    """Makes pictures; used by one thread at a time."""

    def warm_up(self) -> None:
        """Do what would make the first picture slow."""

    def render(self, request: RenderRequest, control: Control) -> Picture:
        """Make a picture, with `control.check()` often and `control.progress()` now and then."""


@dataclass(frozen=True, slots=True)
class PatternRenderer:
    """Paints red growing to the right and green growing downwards, at a given pace, without looking
    at the scene.

    For trying out a client, a queue or a deployment without spending processors on it.
    """

    seconds: float = 0.0
    """How long a picture takes."""
    fault: Exception | None = None
    """Raised instead of making a picture."""
    steps: int = field(default=20)

    def warm_up(self) -> None:
        """There is nothing to warm up."""

    def render(self, request: RenderRequest, control: Control) -> KeptPicture:
        """Wait, then paint; stops when told to."""
        for step in range(self.steps):
            control.check()
            control.progress("pattern", step / self.steps)
            time.sleep(self.seconds / self.steps)
        if self.fault is not None:
            raise self.fault
        height, width = request.camera.height, request.camera.width
        beauty = np.ones((height, width, 4), np.float32)
        beauty[..., 0] = np.linspace(0, 1, width, dtype=np.float32)
        beauty[..., 1] = np.linspace(0, 1, height, dtype=np.float32)[:, None]
        beauty[..., 2] = 0.25
        statistics = {
            "width": width,
            "height": height,
            "stages": [{"name": "pattern", "seconds": self.seconds}],
            "total_seconds": self.seconds,
            "rays": {},
            "warnings": [],
            "renderer_version": VERSION,
        }
        return KeptPicture({"beauty": beauty}, KeptStatistics(statistics), request.settings)
