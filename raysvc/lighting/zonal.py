"""Maps of the sphere without fine detail, filtered by kernels that are round.

A kernel that depends on the angle alone is one number per degree of the spherical harmonics (Funk
and Hecke): filtering multiplies by it. Nothing of this knows poles, seams or directions. The
harmonics are those of the quantum mechanics books, orthonormal over the sphere, with +Y as axis
and the azimuth of `lat_long`; the transform is a Fourier transform along each row and a sum over
rows for each order (Driscoll and Healy 1994, without their fast Legendre transform).
"""

import math
from collections.abc import Callable
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from raysvc.lighting.lat_long import texel_solid_angles
from raysvc.types import Doubles, Floats

POINTS = 8192
"""At which kernels are summed."""

Complexes = npt.NDArray[np.complex128]


class ZonalMap:
    """Harmonics of a map up to a degree."""

    def __init__(self, mean: Doubles, orders: list[Doubles]) -> None:
        self._mean, self._orders = mean, orders

    @property
    def degree(self) -> int:
        """Highest degree."""
        return len(self._orders) - 1

    @staticmethod
    def of(radiance: Floats | Doubles, degree: int) -> "ZonalMap":
        """Analyse a lat-long map (H, W, 3) of at least degree + 1 rows and 2 degree + 1 columns."""
        height, width, _ = radiance.shape
        angles = texel_solid_angles(height, width)
        # The mean apart, or the sum over rows would leave ripples in constant maps
        mean = angles @ radiance.sum(axis=1, dtype=np.float64) / (4.0 * math.pi)
        across = np.fft.rfft(radiance - mean, axis=1)[:, : degree + 1] * angles[:, None, None]
        # Texels are seen from their centres, half a column to the right of the transform's
        across *= np.exp(-1j * math.pi / width * np.arange(degree + 1))[None, :, None]
        by_order = _as_reals(np.ascontiguousarray(across.transpose(1, 0, 2)))
        rows = legendre_rows(degree, height)
        return ZonalMap(mean, [rows[m] @ by_order[m] for m in range(degree + 1)])

    def filtered(self, zonal: Doubles, height: int, width: int) -> Doubles:
        """Lat-long maps (K, height, width, 3) of this one under K kernels.

        zonal (K, L + 1) holds the kernels' coefficients as `zonal_coefficients` gives them, for
        degrees from 0 on; harmonics of further degrees are left out.
        """
        count, degree = len(zonal), min(zonal.shape[1] - 1, self.degree, width // 2)
        rows = legendre_rows(self.degree, height)
        across = np.zeros((width // 2 + 1, height, count * 3), np.complex128)
        for m in range(degree + 1):
            kept = slice(0, degree + 1 - m)
            weighted = self._orders[m][kept, None, :] * zonal[:, m : degree + 1].T[:, :, None]
            across[m] = (rows[m][kept].T @ weighted.reshape(-1, count * 6)).view(np.complex128)
        across *= np.exp(1j * math.pi / width * np.arange(width // 2 + 1))[:, None, None]
        maps = np.fft.irfft(across, n=width, axis=0) * width
        maps = maps.reshape(width, height, count, 3).transpose(2, 1, 0, 3)
        result: Doubles = maps + self._mean
        return result


def _as_reals(values: Complexes) -> Doubles:
    """Complex numbers (..., 3) as their parts (..., 6): products with reals are cheaper so."""
    return values.view(np.float64)


@lru_cache(maxsize=8)
def legendre_rows(degree: int, height: int) -> list[Doubles]:
    """Associated Legendre functions at the centres of a lat-long map's rows.

    One array (degree + 1 - m, height) for each order m, orthonormal with the azimuth's factor.
    Computed by the three-term recurrence in the degree, which is stable (Press et al., Numerical
    Recipes, 6.7).
    """
    polar = (np.arange(height) + 0.5) * (math.pi / height)
    cosine, sine = np.cos(polar), np.sin(polar)
    diagonal = np.full(height, math.sqrt(0.25 / math.pi))
    orders = []
    for m in range(degree + 1):
        if m > 0:
            diagonal = diagonal * sine * -math.sqrt((2 * m + 1) / (2 * m))
        rows = np.empty((degree + 1 - m, height))
        rows[0] = diagonal
        if m < degree:
            rows[1] = cosine * math.sqrt(2 * m + 3) * diagonal
        for n in range(m + 2, degree + 1):
            scale = math.sqrt((4 * n * n - 1) / (n * n - m * m))
            last = math.sqrt(((n - 1) ** 2 - m * m) / (4 * (n - 1) ** 2 - 1))
            rows[n - m] = scale * (cosine * rows[n - m - 1] - last * rows[n - m - 2])
        rows.setflags(write=False)
        orders.append(rows)
    return orders


def zonal_coefficients(kernel: Callable[[Doubles], Doubles], degree: int) -> Doubles:
    """Coefficients (degree + 1,) of a kernel that is scaled to leave constant maps as they are.

    kernel gives values (K,), in any unit, for cosines (K,) of the angle from its middle.
    """
    # Midpoints are dense towards the middle of narrow kernels, where 1 - cosine goes as t^4
    t = (np.arange(POINTS) + 0.5) / POINTS
    cosines = 1.0 - 2.0 * t**4
    values = kernel(cosines) * t**3
    values /= values.sum()
    below, here = np.ones_like(cosines), cosines
    result = np.empty(degree + 1)
    result[0] = 1.0
    for n in range(1, degree + 1):
        result[n] = values @ here
        below, here = here, ((2 * n + 1) * cosines * here - n * below) / (n + 1)
    return result
