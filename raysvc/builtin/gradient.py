"""Light without shape: brighter above, darker below."""

import numpy as np

from raysvc.builtin.lat_long import texel_directions
from raysvc.scene import Environment

WIDTH, HEIGHT = 256, 128
ABOVE = np.array([1.55, 1.62, 1.75])
BELOW = np.array([0.34, 0.32, 0.30])


def gradient() -> Environment:
    """Return the environment, (128, 256, 3): radiance rises smoothly with the direction."""
    above = 0.5 + 0.5 * texel_directions(HEIGHT, WIDTH)[..., 1:2]
    eased = above * above * (3.0 - 2.0 * above)
    return Environment((BELOW + eased * (ABOVE - BELOW)).astype(np.float32), name="gradient")
