"""Path-traced pictures kept in a folder: they take minutes, and what is measured by them changes.

A picture's file is named by a hash of everything that it shows: scene, light, camera, settings. It
is not named by the renderer's own sources, which change all the time: after a change to reference
mode itself, empty the folder.
"""

import dataclasses
import hashlib
from pathlib import Path
from types import NoneType
from typing import Any

import numpy as np

import raysvc
from raysvc.frame.view import camera_from
from raysvc.types import Floats

DECIDES_NOTHING = {"threads", "deadline_s"}
SAYS_NOTHING = {"name", "warnings", "cameras", "rest"}
"""Fields of scenes and what they hold; the camera that is taken is hashed as it is."""
PLAIN = (str, int, float, bool, NoneType)
"""What is hashed as it is written: never an object, whose name is where it is in memory."""


def reference_picture(
    folder: Path | None,
    scene: raysvc.Scene,
    environment: raysvc.Environment,
    view: raysvc.View,
    settings: raysvc.Settings,
) -> tuple[Floats, float]:
    """Beauty (H, W, 4) of a frame, and the seconds that it took, now or when it was made."""
    path = None
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / f"{name_of(scene, environment, view, settings)}.npz"
        if path.is_file():
            with np.load(path) as kept:
                return kept["beauty"], float(kept["seconds"])
    frame = raysvc.render(scene, environment, view, settings)
    beauty, seconds = frame.layers["beauty"], frame.statistics.total_seconds
    if path is not None:
        # Written aside and renamed, so that what is there is whole.
        part = path.with_suffix(".part.npz")
        np.savez(part, beauty=beauty, seconds=seconds)
        part.replace(path)
    return beauty, seconds


def name_of(
    scene: raysvc.Scene,
    environment: raysvc.Environment,
    view: raysvc.View,
    settings: raysvc.Settings,
) -> str:
    """SHA-256 in hex of what decides a picture."""
    digest = hashlib.sha256()
    _take(digest, (scene, environment, camera_from(view, scene), view.focus_pixel))
    digest.update(settings.model_dump_json(exclude=DECIDES_NOTHING).encode())
    return digest.hexdigest()


def _take(digest: Any, value: object) -> None:
    """Add a value with everything that it holds, but for what only people read."""
    digest.update(f"\0{type(value).__name__}\0".encode())
    if isinstance(value, np.ndarray):
        digest.update(f"{value.dtype}{value.shape}".encode())
        digest.update(np.ascontiguousarray(value).tobytes())
    elif dataclasses.is_dataclass(value):
        for field in dataclasses.fields(value):
            if field.name not in SAYS_NOTHING:
                _take(digest, getattr(value, field.name))
    elif isinstance(value, tuple):
        for each in value:
            _take(digest, each)
    elif isinstance(value, PLAIN):
        digest.update(repr(value).encode())
    else:
        raise TypeError(f"cannot tell one {type(value).__name__} from another")
