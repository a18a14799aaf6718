"""Real spherical harmonics: of maps, of the irradiance under them, and along directions.

Convention (Ramamoorthi and Hanrahan 2001, "An Efficient Representation for Irradiance Environment
Maps"; Sloan 2008, "Stupid Spherical Harmonics Tricks"): orthonormal, real, without the
Condon-Shortley phase, in the world's x, y, z with z in the place of their polar axis. Y_lm is
number l (l + 1) + m of the list, m from -l to l. The first nine:

    0.282095
    0.488603 y                0.488603 z                0.488603 x
    1.092548 x y              1.092548 y z              0.315392 (3 z^2 - 1)
    1.092548 x z              0.546274 (x^2 - y^2)

A coefficient is the integral of radiance x Y_lm over all directions. The irradiance of a surface
that faces n is the sum of A_l L_lm Y_lm(n), with A_l the clamped cosine's: pi, 2 pi / 3, pi / 4, 0,
-pi / 24 ... It is not divided by pi: a white diffuser shows irradiance / pi.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Final

import numpy as np

from raysvc.errors import InvalidSetting
from raysvc.lighting.lat_long import check_turned
from raysvc.lighting.spherical_harmonics_kernels import row_waves
from raysvc.scene import Environment
from raysvc.types import Doubles, Floats

MAX_DEGREE: Final = 32
"""Far more than smooth light needs; a map is better than so many numbers."""

BASIS: Final = (
    "0.282095",
    "0.488603 y",
    "0.488603 z",
    "0.488603 x",
    "1.092548 x y",
    "1.092548 y z",
    "0.315392 (3 z^2 - 1)",
    "1.092548 x z",
    "0.546274 (x^2 - y^2)",
)


def harmonics(directions: Floats | Doubles, degree: int) -> Doubles:
    """Y_lm along directions.

    Parameters
    ----------
    directions
        (N, 3), unit
    degree
        0 to MAX_DEGREE, or InvalidSetting

    Returns
    -------
    (N, (degree + 1)^2) float64
    """
    _check(degree)
    x, y, z = np.asarray(directions, np.float64).T
    values = np.empty((len(x), (degree + 1) ** 2))
    # cos and sin of m times the azimuth, each times sin^m of the polar angle
    cosine, sine = np.ones_like(x), np.zeros_like(x)
    diagonal = math.sqrt(0.25 / math.pi)  # normalised P_mm / sin^m
    for m in range(degree + 1):
        below, here = np.zeros_like(z), np.full_like(z, diagonal)
        for order in range(m, degree + 1):  # the harmonic's degree, l
            scale = 1.0 if m == 0 else math.sqrt(2.0)
            values[:, order * (order + 1) + m] = scale * here * cosine
            if m > 0:
                values[:, order * (order + 1) - m] = scale * here * sine
            above = math.sqrt((2 * order + 1) * (2 * order + 3) / ((order + 1) ** 2 - m * m))
            back = math.sqrt((order * order - m * m) / (4 * order * order - 1)) if order else 0.0
            below, here = here, above * (z * here - back * below)
        diagonal *= math.sqrt((2 * m + 3) / (2 * m + 2))
        cosine, sine = x * cosine - y * sine, x * sine + y * cosine
    return values


def evaluate(coefficients: Doubles, directions: Floats | Doubles) -> Doubles:
    """Sum of harmonics along unit directions (N, 3): (N, C) float64.

    coefficients is ((degree + 1)^2, C).
    """
    degree = math.isqrt(len(coefficients)) - 1
    if (degree + 1) ** 2 != len(coefficients):
        raise InvalidSetting(f"{len(coefficients)} is no square", field="coefficients")
    return harmonics(directions, degree) @ coefficients


def projected(radiance: Floats, degree: int, yaw_deg: float = 0.0) -> Doubles:
    """Coefficients of a lat-long map whose texels are areas of constant radiance.

    Every harmonic is integrated over every texel: a constant map has one coefficient that is not
    zero, whatever its size.

    Parameters
    ----------
    radiance
        (H, W, 3) float32, as `Environment` holds it
    degree
        0 to MAX_DEGREE, or InvalidSetting
    yaw_deg
        turns the map counter-clockwise seen from above

    Returns
    -------
    ((degree + 1)^2, 3) float64
    """
    _check(degree)
    height, width, _ = radiance.shape
    waves = np.zeros((height, 3, 2 * degree + 1))
    row_waves(radiance, _column_waves(width, degree, math.radians(yaw_deg)), waves)

    # Around Y the integrals part into rows and columns: (z, x, y) for (x, y, z)
    along_y = np.empty(((degree + 1) ** 2, 3))
    latitudes = _row_integrals(height, degree)
    for order in range(degree + 1):
        for m in range(-order, order + 1):
            column = latitudes[:, order * (order + 1) + abs(m)]
            along_y[order * (order + 1) + m] = column @ waves[:, :, degree + m]
    coefficients = np.empty_like(along_y)
    for order, turn in enumerate(_turns(degree)):
        part = slice(order * order, (order + 1) ** 2)
        coefficients[part] = turn @ along_y[part]
    return coefficients


def cosine_factors(degree: int) -> Doubles:
    """A_l of every coefficient: ((degree + 1)^2,) float64 (Ramamoorthi and Hanrahan, eq. 8)."""
    _check(degree)
    by_degree = np.zeros(degree + 1)
    for order in range(degree + 1):
        if order == 1:
            by_degree[order] = math.tau / 3.0
        elif order % 2 == 0:
            half = order // 2
            ratio = math.comb(order, half) / 2.0**order
            by_degree[order] = math.tau * (-1) ** (half - 1) * ratio / ((order + 2) * (order - 1))
    return np.repeat(by_degree, 2 * np.arange(degree + 1) + 1)


@dataclass(frozen=True, slots=True, eq=False)
class Sh9:
    """Nine harmonics of light; their order and signs are this module's."""

    radiance: Doubles
    """(9, 3) linear RGB of the environment."""
    irradiance: Doubles
    """(9, 3) linear RGB of a surface that faces a direction, not divided by pi."""

    def to_dict(self) -> dict[str, Any]:
        """Return lists for JSON, with the convention in words."""
        return {
            "convention": "L_lm is the integral of radiance Y_lm, orthonormal, real, without the "
            "Condon-Shortley phase; x right, y up, -z the map's centre; linear Rec.709. "
            "irradiance(n) = sum of irradiance_lm Y_lm(n), not divided by pi.",
            "basis": list(BASIS),
            "radiance": self.radiance.tolist(),
            "irradiance": self.irradiance.tolist(),
        }


def sh9(environment: Environment, yaw_deg: float = 0.0, strength: float = 1.0) -> Sh9:
    """Return the nine harmonics of an environment, sun included, turned and scaled.

    Raises InvalidSetting naming `yaw_deg` or `strength`.
    """
    check_turned(yaw_deg, strength)
    radiance = strength * projected(environment.radiance, 2, yaw_deg)
    return Sh9(radiance, radiance * cosine_factors(2)[:, None])


def _check(degree: int) -> None:
    if not 0 <= degree <= MAX_DEGREE:
        raise InvalidSetting(f"must be 0 to {MAX_DEGREE}, is {degree}", field="degree")


def _column_waves(width: int, degree: int, yaw: float) -> Doubles:
    """(W, 2 degree + 1): column integrals of sin(m a) for m < 0, of cos(m a) else.

    a is the azimuth from +Z towards +X, which stands for the one from x towards y around Y.
    """
    half = math.pi / width
    azimuth = math.pi - ((np.arange(width) + 0.5) * (2.0 * half) - math.pi - yaw)
    waves = np.empty((width, 2 * degree + 1))
    waves[:, degree] = 2.0 * half
    for m in range(1, degree + 1):
        over_column = 2.0 * math.sin(m * half) / m
        waves[:, degree + m] = over_column * np.cos(m * azimuth)
        waves[:, degree - m] = over_column * np.sin(m * azimuth)
    return waves


@lru_cache(maxsize=8)
def _row_integrals(height: int, degree: int) -> Doubles:
    """(H, (degree + 1)^2): integrals over rows of Y_lm at azimuth 0, for m >= 0."""
    places, weights = np.polynomial.legendre.leggauss(8 + 2 * MAX_DEGREE // height)
    step = math.pi / height
    polar = (np.arange(height)[:, None] + 0.5 * (1.0 + places)) * step
    sine = np.sin(polar)
    directions = np.stack([sine, np.zeros_like(sine), np.cos(polar)], axis=-1)
    values = harmonics(directions.reshape(-1, 3), degree).reshape(*polar.shape, -1)
    integrals: Doubles = np.einsum("hp,hpk->hk", sine * weights * (0.5 * step), values)
    integrals.setflags(write=False)
    return integrals


@lru_cache(maxsize=8)
def _turns(degree: int) -> tuple[Doubles, ...]:
    """By degree, (2 l + 1, 2 l + 1): from harmonics of (z, x, y), around Y, to (x, y, z)."""
    # Gauss points of the sphere, on which products of two harmonics are summed exactly
    cosine, weight = np.polynomial.legendre.leggauss(degree + 1)
    azimuth = math.tau * np.arange(2 * degree + 1) / (2 * degree + 1)
    sine = np.sqrt(1.0 - cosine**2)
    points = np.stack(
        [
            np.outer(sine, np.cos(azimuth)),
            np.outer(sine, np.sin(azimuth)),
            np.outer(cosine, np.ones_like(azimuth)),
        ],
        axis=-1,
    ).reshape(-1, 3)
    weights = np.repeat(weight * math.tau / len(azimuth), len(azimuth))
    here = harmonics(points, degree) * weights[:, None]
    there = harmonics(points[:, [2, 0, 1]], degree)
    parts = [slice(order * order, (order + 1) ** 2) for order in range(degree + 1)]
    return tuple(here[:, part].T @ there[:, part] for part in parts)
