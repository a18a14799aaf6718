"""Fixed, stratified lookups of lobes: the same at every point, so that neighbours differ smoothly.

A lobe is the unit disc of its uniform numbers (turn, u = squared radius). Lookups sit on a
sunflower (Vogel 1979), and each is given a solid angle in units of 1 / density at its place. With
few lookups it pays to pull them towards the middle and to let their boxes overlap, the outer ones
more: they stand for the lobe's tail. How far is fitted: the numbers below minimise the error of
`bench.image_light`.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from raysvc.types import Doubles

GOLDEN_ANGLE = math.pi * (3.0 - math.sqrt(5.0))


@dataclass(frozen=True, slots=True)
class _Spread:
    """At quantile q in 0..1: u = pull q^power, size = width q^inner / (1 - q)^outer / samples."""

    pull: float
    power: float
    width: float
    inner: float
    outer: float


# Fitted for these numbers of lookups; between them linear in the logarithm of their number
_FITTED = (1, 2, 4, 8, 16, 64)
_NARROW = (
    _Spread(0.00, 2.73, 1.77, 1.02, 1.78),
    _Spread(0.02, 1.11, 2.37, 0.56, 1.34),
    _Spread(0.61, 0.89, 1.88, 0.07, 0.76),
    _Spread(0.73, 0.69, 1.48, 0.03, 1.02),
    _Spread(0.80, 0.69, 1.41, 0.27, 1.03),
    _Spread(0.89, 0.81, 2.07, 0.01, 0.95),
)
_WIDE = (
    _Spread(0.03, 6.64, 0.92, 1.21, 0.29),
    _Spread(0.19, 1.19, 1.31, 0.25, 0.04),
    _Spread(0.79, 1.73, 2.33, 0.11, 0.02),
    _Spread(0.75, 1.19, 2.58, 0.03, 0.02),
    _Spread(0.74, 0.94, 1.06, 0.04, 0.16),
    _Spread(0.84, 0.98, 1.76, 0.24, 0.01),
)
_COSINE = (
    _Spread(0.01, 3.75, 1.34, 0.12, 0.42),
    _Spread(0.22, 0.45, 1.76, 0.05, 0.01),
    _Spread(0.59, 0.32, 1.79, 0.00, 0.00),
    _Spread(0.50, 0.18, 2.87, 0.02, 0.09),
    _Spread(0.59, 0.30, 5.32, 0.00, 0.11),
    _Spread(1.00, 0.95, 3.00, 0.03, 0.01),
)


@lru_cache(maxsize=64)
def cosine_pattern(samples: int) -> Doubles:
    """Lookups of the cosine lobe: (samples, 4) float64 of cosine and sine of the turn, u, size."""
    # A star polygon: its lookups balance around the normal, as those of a spiral do not
    coprime = [m for m in range(1, samples + 1) if math.gcd(m, samples) == 1]
    step = min(coprime, key=lambda m: abs(m - samples * GOLDEN_ANGLE / math.tau))
    return _frozen([*_turns(samples, math.tau * step / samples), *_places(_COSINE, samples)])


@lru_cache(maxsize=64)
def visible_normal_pattern(samples: int) -> Doubles:
    """Lookups of the visible normals: (samples, 6) float64.

    Cosine and sine of the turn, u, size, u, size: the first pair of u and size is for narrow
    lobes, the second one for alpha 1; mix them by alpha.
    """
    turns = _turns(samples, GOLDEN_ANGLE)
    return _frozen([*turns, *_places(_NARROW, samples), *_places(_WIDE, samples)])


def _turns(samples: int, step: float) -> tuple[Doubles, Doubles]:
    """Cosines and sines of turns that begin on the diagonal of the boxes."""
    turns = step * np.arange(samples) + 0.25 * math.pi
    return np.cos(turns), np.sin(turns)


def _places(fitted: tuple[_Spread, ...], samples: int) -> tuple[Doubles, Doubles]:
    """Each lookup's u and size."""

    def fitted_at(name: str) -> float:
        known = [getattr(spread, name) for spread in fitted]
        return float(np.interp(math.log2(samples), np.log2(_FITTED), known))

    q = (np.arange(samples) + 0.5) / samples
    u = fitted_at("pull") * q ** fitted_at("power")
    size = fitted_at("width") * q ** fitted_at("inner") / (1.0 - q) ** fitted_at("outer") / samples
    return u, size


def _frozen(columns: list[Doubles]) -> Doubles:
    pattern = np.stack(columns, axis=1)
    pattern.setflags(write=False)
    return pattern
