"""Requests as the text that outlives the process: everything that was asked for, and no more."""

import json
from typing import Any

from pydantic import BaseModel, ValidationError

from raysvc.compare.settings import ComparisonSettings
from raysvc.frame.probe import Probe
from raysvc.frame.settings import Settings
from raysvc.frame.view import View
from raysvc.jobs.requests import ComparisonRequest, RenderRequest, Request


def request_text(request: Request) -> str:
    """Return JSON, without the fields that were left to their defaults."""
    if isinstance(request, RenderRequest):
        values: dict[str, Any] = {
            "scene": request.scene,
            "environment": request.environment,
            "camera": _asked(request.camera),
            "settings": _asked(request.settings),
            "probe": None if request.probe is None else _asked(request.probe),
        }
    elif isinstance(request, ComparisonRequest):
        values = {
            "scene": request.scene,
            "settings": _asked(request.settings),
            "occasion": request.occasion,
        }
    else:
        raise TypeError(f"a {request.kind} cannot be kept")
    return json.dumps({"kind": request.kind, **values}, separators=(",", ":"))


def request_from(text: str) -> Request:
    """Return the request that a text was made of.

    Raises ValueError for one of another version that can no longer be asked for.
    """
    values = json.loads(text)
    try:
        if values["kind"] == ComparisonRequest.kind:
            return ComparisonRequest(
                values["scene"],
                ComparisonSettings.model_validate(values["settings"]),
                values["occasion"],
            )
        probe = values["probe"]
        return RenderRequest(
            values["scene"],
            values["environment"],
            View.model_validate(values["camera"]),
            Settings.model_validate(values["settings"]),
            None if probe is None else Probe.model_validate(probe),
        )
    except (KeyError, ValidationError) as error:
        raise ValueError(f"a request of another version: {error}") from None


def _asked(model: BaseModel) -> dict[str, Any]:
    return model.model_dump(mode="json", exclude_unset=True)
