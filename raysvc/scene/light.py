"""Lights without size (KHR_lights_punctual)."""

import math
from dataclasses import dataclass
from typing import Literal

Vector = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class PunctualLight:
    """A directional, point or spot light in world space.

    `intensity` is linear RGB: irradiance at a facing surface for a directional light, and for
    point and spot lights radiant intensity, which falls with the square of the distance and ends
    smoothly at `range_m`.
    """

    kind: Literal["directional", "point", "spot"]
    intensity: Vector
    position: Vector = (0.0, 0.0, 0.0)
    """Where point and spot lights are."""
    direction: Vector = (0.0, 0.0, -1.0)
    """Unit, the way the light travels (directional, spot)."""
    range_m: float = math.inf
    inner_cone_rad: float = 0.0
    """Half angle within which a spot is at full strength."""
    outer_cone_rad: float = math.pi / 4
    """Half angle at which a spot has faded to nothing."""
    name: str = ""
