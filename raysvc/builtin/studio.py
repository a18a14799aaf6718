"""A photographer's studio: a dark grey room with softboxes."""

from dataclasses import dataclass

import numpy as np

from raysvc.builtin.lat_long import texel_directions
from raysvc.geometry.transform import look_at
from raysvc.scene import Environment
from raysvc.types import Doubles

WIDTH, HEIGHT = 1024, 512


@dataclass(frozen=True, slots=True)
class Softbox:
    """A rectangle of light at distance 1, upright, facing the middle of the room."""

    towards: tuple[float, float, float]
    """Where its centre is seen."""
    half_width: float
    half_height: float
    radiance: tuple[float, float, float]
    """At its centre; it falls to 70 % at the rim."""


SOFTBOXES = (
    Softbox((-0.75, 0.55, 0.75), 0.55, 0.42, (7.0, 6.7, 6.2)),  # key, from the front left
    Softbox((1.0, 0.25, 0.55), 0.32, 0.60, (1.7, 1.8, 2.0)),  # fill, opposite
    Softbox((0.75, 0.55, -0.9), 0.10, 0.75, (9.0, 9.2, 9.6)),  # rim strip, behind on the right
    Softbox((0.1, 1.0, -0.2), 0.50, 0.28, (2.6, 2.6, 2.6)),  # overhead
)


def studio() -> Environment:
    """Return the environment, (512, 1024, 3)."""
    directions = texel_directions(HEIGHT, WIDTH)
    up = directions[..., 1:2]
    # Walls a little brighter at eye level than the ceiling, over a darker floor.
    radiance = (0.10 + 0.05 * np.exp(-8.0 * up**2) - 0.04 * np.clip(-up * 4.0, 0.0, 1.0)) * np.ones(
        3
    )
    for softbox in SOFTBOXES:
        radiance += _brightness(softbox, directions) * np.array(softbox.radiance)
    return Environment(radiance.astype(np.float32), name="studio")


def _brightness(softbox: Softbox, directions: Doubles) -> Doubles:
    """(H, W, 1) relative radiance of a softbox with an edge about half a degree soft."""
    pose = look_at(np.zeros(3), np.array(softbox.towards), np.array([0.0, 1.0, 0.0]))
    local = directions @ pose[:3, :3]
    depth = np.maximum(-local[..., 2], 1e-6)
    x = np.abs(local[..., 0] / depth) / softbox.half_width
    y = np.abs(local[..., 1] / depth) / softbox.half_height
    inside = _fall(x, 0.01 / softbox.half_width) * _fall(y, 0.01 / softbox.half_height)
    bright = 1.0 - 0.15 * (np.minimum(x, 1.0) ** 2 + np.minimum(y, 1.0) ** 2)
    return np.asarray((inside * bright * (local[..., 2] < 0))[..., None])


def _fall(value: Doubles, width: float) -> Doubles:
    """From 1 to 0 about value = 1."""
    t = np.clip((1.0 + width - value) / (2.0 * width), 0.0, 1.0)
    return np.asarray(t * t * (3.0 - 2.0 * t))
