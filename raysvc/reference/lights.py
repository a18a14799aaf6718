"""What a way of drawing light says about N points: where each could get light from."""

from dataclasses import dataclass

import numpy as np

from raysvc.types import Doubles, Floats


@dataclass(frozen=True, slots=True, eq=False)
class LightSamples:
    """One direction of light for each of N points.

    Attributes
    ----------
    to_light
        (N, 3) float32 unit
    distance
        (N,) float32 metres that must be free, up to what shines; inf if that is nowhere
    radiance
        (N, 3) float32: radiance over density; for a light without size, irradiance
    density
        (N,) float64 per steradian, inf for a light without size
    """

    to_light: Floats
    distance: Floats
    radiance: Floats
    density: Doubles

    @staticmethod
    def empty(count: int) -> "LightSamples":
        """Return room for samples, to be filled."""
        return LightSamples(
            np.empty((count, 3), np.float32),
            np.empty(count, np.float32),
            np.empty((count, 3), np.float32),
            np.empty(count),
        )
