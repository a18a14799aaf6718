"""From what a caller says of the camera to a camera that can be used."""

import math
from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from raysvc.errors import InvalidSetting
from raysvc.geometry.transform import framed_distance, look_at
from raysvc.limits import DEFAULT_LIMITS, Limits
from raysvc.scene import Camera, Scene, SceneCamera
from raysvc.types import Doubles

Vector = tuple[float, float, float]
Row = tuple[float, float, float, float]

DEFAULT_VIEW = (0.45, 0.35, 1.0)
"""From the scene towards a camera that was not given a place: a little right, a little above the front (+Z)."""
DEFAULT_FOV_Y_DEG = 40.0


class View(BaseModel):
    """A camera as a caller describes it; anything may be left out, and the scene's bounds are then framed."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    eye: Vector | None = Field(None, description="Where the camera is, in metres.")
    target: Vector | None = Field(None, description="What it looks at; the middle of the scene by default.")
    up: Vector = Field((0.0, 1.0, 0.0), description="What is up in the picture.")
    world_from_camera: tuple[Row, Row, Row, Row] | None = Field(
        None, description="4x4 rigid transform, rows first, instead of eye, target and up; the camera looks down -Z."
    )
    gltf_camera: int | str | None = Field(None, description="A camera of the scene file, by number or name.")
    fov_y_deg: float | None = Field(None, gt=0, lt=180, description="Vertical field of view; 40 by default.")
    focal_length_mm: float | None = Field(None, gt=0, le=10000, description="Instead of fov_y_deg.")
    sensor_height_mm: float = Field(24.0, gt=0, le=1000, description="Goes with focal_length_mm.")
    width: int = Field(1280, ge=1, description="Pixels across.")
    height: int = Field(720, ge=1, description="Pixels down.")
    aperture_radius: float | None = Field(None, ge=0, le=1e3, description="Radius of the lens in metres; 0 is sharp.")
    f_number: float | None = Field(None, gt=0, le=1000, description="With focal_length_mm, instead of aperture_radius.")
    focus_distance: float | None = Field(
        None, gt=0, description="Distance along the view axis that is sharp, in metres; that of target by default."
    )
    focus_point: Vector | None = Field(None, description="A point that is sharp, instead of focus_distance.")


def camera_from(view: View, scene: Scene, limits: Limits = DEFAULT_LIMITS) -> Camera:
    """Resolve a view against a scene. Raises InvalidSetting naming the field."""
    _check_size(view, limits)
    _check_alternatives(view)
    if view.gltf_camera is not None:
        chosen = _scene_camera(view.gltf_camera, scene)
        pose, projection = chosen.world_from_camera, _projection(view, chosen)
    else:
        projection = _projection(view, None)
        pose = _pose(view, scene, projection[1])
    return Camera(
        world_from_camera=pose,
        width=view.width,
        height=view.height,
        projection=projection[0],
        half_height=projection[1],
        aperture_radius=_aperture_radius(view),
        focus_distance=_focus_distance(view, pose, scene),
    )
