"""`raysvc render --server`: the same picture, made by a service."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from raysvc.client import Client
from raysvc.errors import InvalidSetting
from raysvc.frame.settings import Settings
from raysvc.frame.view import View


def render_remotely(
    client: Client,
    scene: str,
    environment: str | None,
    probe: Mapping[str, Any] | None,
    positions: Path | None,
    view: View,
    settings: Settings,
    format: str,
    report: Callable[[str, float], None],
) -> tuple[bytes, Mapping[str, Any]]:
    """Send what is not there yet, ask for the picture, wait; returns its file and statistics."""
    report("sending", 0.0)
    around: Any = None if environment is None else client.environments.add(environment).id
    shown = client.scenes.add(scene)
    if positions is not None:
        shown = client.scenes.move(shown.id, _bytes_of(positions))
    render = client.renders.make(
        shown.id,
        around if probe is None else {**probe, "environment": around},
        view.model_dump(mode="json", exclude_unset=True),
        settings.model_dump(mode="json", exclude_unset=True),
        report,
    )
    return client.renders.image(render.id, format), render.statistics


def _bytes_of(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise InvalidSetting(f"{path}: {error.strerror}", field="--positions") from None
