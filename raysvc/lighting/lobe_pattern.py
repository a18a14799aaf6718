"""Fixed, stratified directions of lobes: the same at every point, so that neighbours differ smoothly."""

import math
from functools import lru_cache

import numpy as np

from raysvc.types import Doubles

GOLDEN_ANGLE = math.pi * (3.0 - math.sqrt(5.0))


@lru_cache(maxsize=64)
def lobe_pattern(samples: int) -> Doubles:
    """(samples, 3) float64: cosine and sine of a turn, and a number u in 0..1, of equally likely parts.

    Points of a sunflower on the unit disc, at squared radius u (Vogel 1979).
    """
    k = np.arange(samples)
    u = (k + 0.5) / samples
    turn = GOLDEN_ANGLE * k + 0.25 * math.pi
    pattern = np.stack([np.cos(turn), np.sin(turn), u], axis=1)
    pattern.setflags(write=False)
    return pattern
