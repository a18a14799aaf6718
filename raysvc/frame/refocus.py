"""A lens for a finished picture: picture and depth in, picture out, whoever has rendered it."""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from raysvc.errors import InvalidInput, InvalidSetting
from raysvc.frame.frame import encode_layers, save_layers
from raysvc.frame.settings import Settings, checked
from raysvc.frame.view import View, camera_of_picture
from raysvc.imaging.srgb import linear_from_srgb
from raysvc.lens.coc import coc_px
from raysvc.lens.gather import gather
from raysvc.lens.spread import spread
from raysvc.loading.picture_file import StoredPicture
from raysvc.parallel import Control
from raysvc.types import Floats

CAMERA_FIELDS: Final = (
    "fov_y_deg",
    "focal_length_mm",
    "sensor_height_mm",
    "aperture_radius",
    "f_number",
    "focus_distance",
    "focus_pixel",
)
"""What a picture's camera may say; the rest of a `View` needs a scene."""
SETTINGS_FIELDS: Final = (
    "lens",
    "lens_shape",
    "lens_order",
    "lens_layers",
    "aperture_blades",
    "aperture_rotation_deg",
    "exposure_stops",
    "tone_map",
    "threads",
    "deadline_s",
)
"""The settings that matter to a lens."""


@dataclass(frozen=True, slots=True, eq=False)
class Refocused:
    """A picture that was given a lens."""

    layers: Mapping[str, NDArray[Any]]
    """`beauty` (H, W, 4), `depth` (H, W), `coc` (H, W), as in a `Frame`."""
    settings: Settings
    max_coc_px: float
    seconds: float
    warnings: tuple[str, ...]

    def statistics(self) -> dict[str, Any]:
        """Return what it took, ready for JSON."""
        height, width = self.layers["depth"].shape
        return {
            "width": width,
            "height": height,
            "max_coc_px": self.max_coc_px,
            "total_seconds": self.seconds,
            "warnings": list(self.warnings),
        }

    def encode(self, format: str, layer: str | None = None) -> bytes:
        """Return a file, as `Frame.encode` does."""
        return encode_layers(self.layers, self.settings, format, layer)

    def save(self, path: str | Path) -> None:
        """Write a file, as `Frame.save` does."""
        save_layers(self.layers, self.settings, Path(path))


def linear(stored: StoredPicture) -> Floats:
    """(H, W, 4) float32 linear Rec.709, premultiplied, of a picture from a file."""
    if not stored.coded:
        return stored.rgba
    rgba = stored.rgba.copy()
    rgba[..., :3] = linear_from_srgb(rgba[..., :3]) * rgba[..., 3:]
    return rgba


def refocus(
    picture: Floats,
    depth: Floats,
    camera: Mapping[str, Any] | None = None,
    settings: Mapping[str, Any] | None = None,
    *,
    control: Control | None = None,
) -> Refocused:
    """Give a picture depth of field.

    Parameters
    ----------
    picture
        (H, W, 4) float32 linear, premultiplied, without a lens
    depth
        (H, W) float32 metres along the view axis, more than 0; inf for the background
    camera
        some of CAMERA_FIELDS: the lens must be given; the focus is by default on what the middle of
        the picture shows
    settings
        some of SETTINGS_FIELDS

    Raises InvalidSetting, InvalidInput, Cancelled, DeadlineExceeded.
    """
    view = checked(View, _known(camera or {}, CAMERA_FIELDS, "camera"), "camera")
    chosen = checked(Settings, _known(settings or {}, SETTINGS_FIELDS, "settings"), "settings")
    if chosen.lens == "accumulate":
        raise InvalidSetting("accumulate needs a scene", field="settings.lens")
    if picture.ndim != 3 or picture.shape[2] != 4 or depth.shape != picture.shape[:2]:
        raise InvalidInput(
            f"{depth.shape} does not belong to a picture of {picture.shape}", field="depth"
        )
    if not (depth > 0).all():
        raise InvalidInput("must be more than 0, or inf for the background", field="depth")
    start = time.perf_counter()
    seen = camera_of_picture(view, depth)
    if seen.aperture_radius == 0.0:
        raise InvalidSetting("is missing, or f_number", field="camera.aperture_radius")
    control = (control or Control()).limited(chosen.threads, chosen.deadline_s)
    coc = coc_px(seen, depth)
    warnings: list[str] = []
    if chosen.lens == "none":
        blurred = picture
    elif chosen.lens == "gather":
        blurred = gather(picture, coc, control)
    else:
        blurred = spread(picture, coc, chosen.bokeh, chosen.lens_layers, control, warnings)
    return Refocused(
        {"beauty": blurred, "depth": depth, "coc": coc},
        chosen,
        float(np.abs(coc).max()),
        time.perf_counter() - start,
        tuple(warnings),
    )


def _known(values: Mapping[str, Any], known: tuple[str, ...], where: str) -> Mapping[str, Any]:
    if isinstance(values, Mapping):
        for name in values:
            if name not in known:
                raise InvalidSetting(
                    f"is nothing that a picture's lens knows; known are {', '.join(known)}",
                    field=f"{where}.{name}"[:120],
                )
    return values
