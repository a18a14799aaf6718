"""What the service answers with. `resource` is all of it, by the names of the HTTP interface."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final, Self

from raysvc.client.problems import error_from
from raysvc.errors import Cancelled, RaysvcError

UNFINISHED: Final = ("queued", "running")


@dataclass(frozen=True, slots=True)
class Stored:
    """A scene or an environment that the service keeps."""

    id: str
    """SHA-256 of its content."""
    name: str
    warnings: tuple[str, ...]
    """What is in the file but not supported."""
    resource: Mapping[str, Any]

    @classmethod
    def of(cls, resource: Mapping[str, Any]) -> Self:
        """From a body."""
        return cls(resource["id"], resource["name"], tuple(resource["warnings"]), resource)


@dataclass(frozen=True, slots=True)
class Job:
    """A render or a comparison: how far it is, and what came of it."""

    id: str
    state: str
    """`queued`, `running`, `done`, `failed` or `cancelled`."""
    stage: str | None
    """What runs now."""
    progress: float
    """0..1."""
    position: int | None
    """Jobs that run before this one, while it waits."""
    error: RaysvcError | None
    """Why it failed."""
    resource: Mapping[str, Any]

    @classmethod
    def of(cls, resource: Mapping[str, Any]) -> Self:
        """From a body."""
        problem = resource["error"]
        return cls(
            id=resource["id"],
            state=resource["state"],
            stage=resource["stage"],
            progress=resource["progress"],
            position=resource["position"],
            error=None if problem is None else error_from(problem),
            resource=resource,
        )

    @property
    def ended(self) -> bool:
        """Whether nothing more will happen to it."""
        return self.state not in UNFINISHED

    @property
    def statistics(self) -> Mapping[str, Any]:
        """What a finished render took; what a finished comparison measured is in `resource`."""
        return self.resource.get("statistics") or {}

    def check(self) -> None:
        """Raise what made it fail, or Cancelled."""
        if self.error is not None:
            raise self.error.with_traceback(None)
        if self.state == "cancelled":
            raise Cancelled("the job was cancelled")
