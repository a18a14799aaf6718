"""From what a caller says of the camera to a camera that can be used."""

import math
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from raysvc.errors import InvalidSetting
from raysvc.geometry.transform import framed_distance, look_at
from raysvc.limits import DEFAULT_LIMITS, Limits
from raysvc.scene import Camera, Scene, SceneCamera
from raysvc.types import Doubles, Floats

Metres = Annotated[float, Field(ge=-1e9, le=1e9)]
Vector = tuple[Metres, Metres, Metres]
PixelPlace = Annotated[float, Field(ge=0, le=1e6)]
Row = tuple[Metres, Metres, Metres, Metres]

DEFAULT_VIEW = (0.45, 0.35, 1.0)
"""From the scene towards a camera that was not given a place: a little right, a little above the
front (+Z)."""
DEFAULT_FOV_Y_DEG = 40.0


class View(BaseModel):
    """A camera as a caller describes it; anything may be left out, and the scene's bounds are then
    framed."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    eye: Vector | None = Field(None, description="Where the camera is, in metres.")
    target: Vector | None = Field(
        None, description="What it looks at; the middle of the scene by default."
    )
    up: Vector = Field((0.0, 1.0, 0.0), description="What is up in the picture.")
    world_from_camera: tuple[Row, Row, Row, Row] | None = Field(
        None,
        description="4x4 rigid transform, rows first, instead of eye, target and up.",
    )
    gltf_camera: int | str | None = Field(
        None, description="A camera of the scene file, by number or name."
    )
    fov_y_deg: float | None = Field(
        None, ge=1e-3, lt=180, description="Vertical field of view; 40 by default."
    )
    focal_length_mm: float | None = Field(
        None, ge=1e-3, le=10000, description="Instead of fov_y_deg."
    )
    sensor_height_mm: float = Field(
        24.0, ge=1e-3, le=1000, description="Goes with focal_length_mm."
    )
    width: int = Field(1280, ge=1, description="Pixels across.")
    height: int = Field(720, ge=1, description="Pixels down.")
    aperture_radius: float | None = Field(
        None, ge=0, le=1e3, description="Radius of the lens in metres; 0 is sharp."
    )
    f_number: float | None = Field(
        None, gt=0, le=1000, description="With focal_length_mm, instead of aperture_radius."
    )
    focus_distance: float | None = Field(
        None,
        gt=0,
        le=1e9,
        description="Distance along the view that is sharp, in metres; the target's by default.",
    )
    focus_point: Vector | None = Field(
        None, description="A point that is sharp, instead of focus_distance."
    )
    focus_pixel: tuple[PixelPlace, PixelPlace] | None = Field(
        None,
        description="A place in the picture, [x, y] in pixels from its upper left corner: what it "
        "shows is sharp, instead of focus_distance.",
    )


def camera_from(view: View, scene: Scene, limits: Limits = DEFAULT_LIMITS) -> Camera:
    """Resolve a view against a scene. Raises InvalidSetting naming the field.

    What `focus_pixel` shows only a ray can tell (`raysvc.frame.focus`): until then the focus is as
    if it had not been given.
    """
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


def camera_of_picture(view: View, depth: Floats) -> Camera:
    """Return the camera of a finished picture with depth (H, W), of which only the lens matters.

    The focus is, unless it is given, on what the middle of the picture shows. Raises InvalidSetting
    naming the field.
    """
    height, width = depth.shape
    _check_alternatives(view.model_copy(update={"width": width, "height": height}))
    focus = view.focus_distance
    if focus is None:
        x, y = view.focus_pixel or (width / 2, height / 2)
        focus = float(depth[int(y), int(x)])
        if not math.isfinite(focus):
            raise InvalidSetting("shows nothing that could be in focus", field="camera.focus_pixel")
    return Camera(
        world_from_camera=np.eye(4),
        width=width,
        height=height,
        half_height=_projection(view, None)[1],
        aperture_radius=_aperture_radius(view),
        focus_distance=focus,
    )


def _check_size(view: View, limits: Limits) -> None:
    for name in ("width", "height"):
        if getattr(view, name) > limits.max_image_side:
            raise InvalidSetting(f"must be at most {limits.max_image_side}", field=f"camera.{name}")
    if view.width * view.height > limits.max_image_pixels:
        raise InvalidSetting(
            f"width x height must be at most {limits.max_image_pixels} pixels", field="camera.width"
        )


def _check_alternatives(view: View) -> None:
    """Refuse to guess which of two ways of saying the same thing was meant."""
    pose = [n for n in ("gltf_camera", "world_from_camera", "eye") if getattr(view, n) is not None]
    if len(pose) > 1:
        raise InvalidSetting(f"cannot be given together with {pose[1]}", field=f"camera.{pose[0]}")
    for first, second in (
        ("fov_y_deg", "focal_length_mm"),
        ("aperture_radius", "f_number"),
        ("focus_distance", "focus_point"),
        ("focus_distance", "focus_pixel"),
        ("focus_point", "focus_pixel"),
        ("target", "world_from_camera"),
        ("target", "gltf_camera"),
    ):
        if getattr(view, first) is not None and getattr(view, second) is not None:
            raise InvalidSetting(f"cannot be given together with {second}", field=f"camera.{first}")
    if view.focus_pixel is not None:
        for place, side in zip(view.focus_pixel, ("width", "height"), strict=True):
            if place >= getattr(view, side):
                raise InvalidSetting(
                    f"must lie in the picture, less than {side} {getattr(view, side)} "
                    f"(got {place:g})",
                    field="camera.focus_pixel",
                )
    if view.f_number is not None and view.focal_length_mm is None:
        raise InvalidSetting("needs focal_length_mm", field="camera.f_number")


def _scene_camera(wanted: int | str, scene: Scene) -> SceneCamera:
    if isinstance(wanted, int):
        if 0 <= wanted < len(scene.cameras):
            return scene.cameras[wanted]
        raise InvalidSetting(
            f"refers to camera {wanted}; there are {len(scene.cameras)}",
            field="camera.gltf_camera",
        )
    for camera in scene.cameras:
        if camera.name == wanted:
            return camera
    names = ", ".join(repr(c.name) for c in scene.cameras[:20]) or "none"
    raise InvalidSetting(
        f"no camera {wanted!r} in the scene; it has {names}", field="camera.gltf_camera"
    )


def _projection(
    view: View, camera: SceneCamera | None
) -> tuple[Literal["perspective", "orthographic"], float]:
    """Kind of projection, and tangent of half the field of view or half the height in metres."""
    if view.focal_length_mm is not None:
        return "perspective", 0.5 * view.sensor_height_mm / view.focal_length_mm
    if view.fov_y_deg is not None:
        return "perspective", math.tan(math.radians(view.fov_y_deg) / 2)
    if camera is not None and camera.height_m is not None:
        return "orthographic", camera.height_m / 2
    fov_y_deg = DEFAULT_FOV_Y_DEG
    if camera is not None and camera.fov_y_deg is not None:
        fov_y_deg = camera.fov_y_deg
    return "perspective", math.tan(math.radians(fov_y_deg) / 2)


def _pose(view: View, scene: Scene, tan_half_fov_y: float) -> Doubles:
    if view.world_from_camera is not None:
        return _rigid(np.array(view.world_from_camera, np.float64))
    up = np.array(view.up, np.float64)
    if not np.linalg.norm(up) > 1e-12:
        raise InvalidSetting("must not be the zero vector", field="camera.up")
    bounds = scene.bounds()
    target = np.array(view.target, np.float64) if view.target is not None else bounds.mean(axis=0)
    if view.eye is not None:
        eye = np.array(view.eye, np.float64)
        if np.linalg.norm(eye - target) < 1e-12 * max(1.0, float(np.abs(eye).max())):
            raise InvalidSetting("must not be where the target is", field="camera.eye")
        return look_at(eye, target, up)
    away = np.array(DEFAULT_VIEW) / np.linalg.norm(DEFAULT_VIEW)
    seen = scene.positions[np.unique(scene.triangles)].astype(np.float64)
    corners = seen if len(seen) else bounds
    tangents = (tan_half_fov_y * view.width / view.height, tan_half_fov_y)
    pose = look_at(target + away, target, up)
    pose[:3, 3] = target
    distance = max(framed_distance(corners, pose, tangents, margin=1.08), 1e-6)
    pose[:3, 3] = target + away * distance
    return pose


def _rigid(matrix: Doubles) -> Doubles:
    """Check a caller's pose: rotation and translation only."""
    axes = matrix[:3, :3]
    if not np.allclose(axes.T @ axes, np.eye(3), atol=1e-3) or np.linalg.det(axes) < 0:
        raise InvalidSetting(
            "must have perpendicular unit axes, right-handed", field="camera.world_from_camera"
        )
    if not np.allclose(matrix[3], [0, 0, 0, 1], atol=1e-9):
        raise InvalidSetting("must have 0 0 0 1 as its last row", field="camera.world_from_camera")
    return matrix


def _aperture_radius(view: View) -> float:
    if view.f_number is not None and view.focal_length_mm is not None:
        return 0.5e-3 * view.focal_length_mm / view.f_number
    return view.aperture_radius or 0.0


def _focus_distance(view: View, pose: Doubles, scene: Scene) -> float:
    """Distance along the view axis that is sharp: as asked, else that of the target or of the
    bounds' middle."""
    if view.focus_distance is not None:
        return view.focus_distance
    point = view.focus_point or view.target
    sharp = np.array(point) if point is not None else scene.bounds().mean(axis=0)
    distance = float((sharp - pose[:3, 3]) @ -pose[:3, 2])
    if distance > 0:
        return distance
    if point is not None and view.focus_point is not None:
        raise InvalidSetting("must be in front of the camera", field="camera.focus_point")
    return 1.0
