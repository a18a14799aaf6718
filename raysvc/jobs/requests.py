"""What a job may be asked for. A scene and an environment are named as in their stores."""

import hashlib
import json
import secrets
from dataclasses import dataclass, field
from typing import Any, ClassVar, Protocol

from raysvc.compare.settings import ComparisonSettings
from raysvc.frame.probe import Probe
from raysvc.frame.settings import Settings
from raysvc.frame.view import View
from raysvc.version import VERSION


class Request(Protocol):
    """What the queue and the worker must know of any request."""

    kind: ClassVar[str]
    """What people call it."""

    @property
    def name(self) -> str:
        """SHA-256 in hex: requests of one name have one result."""

    @property
    def threads(self) -> int | None:
        """How many threads it may use; None is all."""

    @property
    def deadline_s(self) -> float | None:
        """How long it may run; None is the service's default."""


@dataclass(frozen=True, slots=True)
class RenderRequest:
    """Everything that a picture depends on."""

    kind: ClassVar[str] = "render"

    scene: str
    environment: str | None
    """None is the built-in sky."""
    camera: View
    settings: Settings
    probe: Probe | None = None
    """From where the scene is captured, before that environment, for glossy surfaces."""

    @property
    def name(self) -> str:
        """SHA-256 in hex of what decides the picture: not of threads, nor of patience."""
        return _digest(
            {
                "scene": self.scene,
                "environment": self.environment,
                "probe": None if self.probe is None else self.probe.model_dump(mode="json"),
                "camera": self.camera.model_dump(mode="json"),
                "settings": self.settings.model_dump(
                    mode="json", exclude={"threads", "deadline_s"}
                ),
            }
        )

    @property
    def threads(self) -> int | None:
        """Threads that the settings allow."""
        return self.settings.threads

    @property
    def deadline_s(self) -> float | None:
        """Seconds that the settings allow."""
        return self.settings.deadline_s


@dataclass(frozen=True, slots=True)
class ComparisonRequest:
    """What to measure."""

    kind: ClassVar[str] = "comparison"

    scene: str
    settings: ComparisonSettings
    occasion: str = field(default_factory=lambda: secrets.token_hex(16))
    """Every measurement is a new one: times are never those of an earlier request."""

    @property
    def name(self) -> str:
        """SHA-256 in hex of what is measured, and of the occasion."""
        return _digest(
            {
                "scene": self.scene,
                "comparison": self.settings.model_dump(mode="json"),
                "occasion": self.occasion,
            }
        )

    @property
    def threads(self) -> int | None:
        """Threads that the settings allow."""
        return self.settings.threads

    @property
    def deadline_s(self) -> float | None:
        """Seconds that the settings allow."""
        return self.settings.deadline_s


def _digest(decisive: dict[str, Any]) -> str:
    """Name what decides a result, in this version."""
    text = json.dumps({"version": VERSION, **decisive}, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()
