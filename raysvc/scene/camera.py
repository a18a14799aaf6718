"""Cameras: as a scene file describes one, and as a frame uses one."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from raysvc.types import Doubles, Floats, Longs


@dataclass(frozen=True, slots=True, eq=False)
class SceneCamera:
    """A camera that a scene file holds. Exactly one of `fov_y_deg` and `height_m` is set."""

    world_from_camera: Doubles
    """(4, 4) rigid: the camera looks along its -Z with +Y up."""
    fov_y_deg: float | None = None
    """Perspective: full vertical field of view."""
    height_m: float | None = None
    """Orthographic: height of what is seen (twice glTF's ymag)."""
    aspect_ratio: float | None = None
    """Width over height that the file asks for, if it does."""
    name: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Camera:
    """A camera ready to use. Pixel (row, col) has its centre at (row + 0.5, col + 0.5), row 0 at
    the top."""

    world_from_camera: Doubles
    """(4, 4) rigid: the camera looks along its -Z with +Y up."""
    width: int
    height: int
    projection: Literal["perspective", "orthographic"] = "perspective"
    half_height: float = 0.36
    """Perspective: tangent of half the vertical field of view. Orthographic: half the height in
    metres."""
    aperture_radius: float = 0.0
    """Radius of the lens in metres; 0 is a pinhole."""
    focus_distance: float = 1.0
    """Distance along the view axis, in metres, of what is sharp."""

    offset_px: tuple[float, float] = (0.0, 0.0)
    """Where in the pixel a sample is, from the centre (x to the right, y down)."""

    slant: tuple[float, float] = (0.0, 0.0)
    """Orthographic: how far rays go to the right and up on their way along the axis."""

    def through_lens(self, right: float, up: float) -> "Camera":
        """Return the pinhole at a place of the lens, from its middle and in its radii.

        It shows what is in the plane of focus where this camera does.
        """
        place = self.aperture_radius * np.array([right, up])
        moved = self.world_from_camera.copy()
        moved[:3, 3] += moved[:3, :2] @ place
        through = replace(self, world_from_camera=moved, aperture_radius=0.0)
        along = place / self.focus_distance
        if self.projection == "orthographic":
            return replace(through, slant=(self.slant[0] - along[0], self.slant[1] - along[1]))
        along /= self.metres_per_pixel_at_unit_depth
        return through.shifted(-along[0], along[1])

    def shifted(self, dx_px: float, dy_px: float) -> "Camera":
        """Return the camera whose pixel centres lie (dx, dy) pixels to the right and below this
        one's."""
        return replace(self, offset_px=(self.offset_px[0] + dx_px, self.offset_px[1] + dy_px))

    @property
    def eye(self) -> Doubles:
        """(3,) position in world space."""
        return self.world_from_camera[:3, 3]

    @property
    def forward(self) -> Doubles:
        """(3,) unit view direction in world space."""
        return -self.world_from_camera[:3, 2]

    @property
    def metres_per_pixel_at_unit_depth(self) -> float:
        """Height of a pixel at view depth 1 (perspective) or anywhere (orthographic)."""
        return 2.0 * self.half_height / self.height

    def pixel_width_m(self, depth: Floats) -> Floats:
        """Return how wide a pixel is at view depths (...), across the view axis, in metres."""
        width = np.float32(self.metres_per_pixel_at_unit_depth)
        return depth * width if self.projection == "perspective" else np.full_like(depth, width)

    def rays(self, pixels: Longs, within: Doubles | None = None) -> tuple[Floats, Floats]:
        """Origins and unit directions of rays through pixels.

        Parameters
        ----------
        pixels
            (N,) int64 flat indices, row * width + col
        within
            (N, 2) where in its pixel each ray goes, from the centre (x to the right, y down), in
            addition to the camera's own offset; the centre by default

        Returns
        -------
        (N, 3) float32 origins and (N, 3) float32 unit directions, world space
        """
        rows, cols = np.divmod(pixels, self.width)
        scale = self.metres_per_pixel_at_unit_depth
        dx, dy = self.offset_px if within is None else (within + self.offset_px).T
        x = (cols + (0.5 - 0.5 * self.width) + dx) * scale
        y = ((0.5 * self.height - 0.5) - rows - dy) * scale
        right, up, forward = (
            self.world_from_camera[:3, 0],
            self.world_from_camera[:3, 1],
            self.forward,
        )
        across = x[:, None] * right + y[:, None] * up
        if self.projection == "orthographic":
            origins = self.eye + across
            slanted = forward
            if self.slant != (0.0, 0.0):
                slanted = forward + self.slant[0] * right + self.slant[1] * up
                slanted /= np.linalg.norm(slanted)
            directions = np.broadcast_to(slanted, origins.shape)
        else:
            directions = across + forward
            directions /= np.sqrt(np.einsum("nk,nk->n", directions, directions))[:, None]
            origins = np.broadcast_to(self.eye, directions.shape)
        return (
            np.ascontiguousarray(origins, np.float32),
            np.ascontiguousarray(directions, np.float32),
        )
