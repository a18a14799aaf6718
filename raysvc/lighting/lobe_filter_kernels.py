"""The GGX lobe of a mirror direction, between one parallel of a map and all others."""

import math

from raysvc.jit import inlined, kernel
from raysvc.lighting.brdf import ggx_density_under_disc
from raysvc.types import Doubles, Floats


@inlined
def risen_cosine(cosine: float, radius: float) -> float:
    """N.L averaged over a small disc of light, of which only what is over the horizon counts.

    `radius` is in radians. Near the horizon the cosine falls evenly across the disc, whose chords
    are as long as a circle's.
    """
    if cosine >= radius:
        return cosine
    if cosine <= -radius:
        return 0.0
    u = cosine / radius
    root = math.sqrt(max(1.0 - u * u, 0.0))
    share = 0.25 * math.pi + 0.5 * (u * root + math.asin(u))
    return radius * (2.0 / math.pi) * (u * share + root * root * root / 3.0)


@inlined
def lobe_weight(half_sine2: float, alpha: float, radius: float) -> float:
    """D x N.L of light at an angle from normal = view, averaged over a small disc of light.

    Takes the squared sine of half the angle, which is that between N and H, and the radius of the
    disc in radians. The two factors are averaged apart: where one varies the other hardly does.
    """
    facing = risen_cosine(1.0 - 2.0 * half_sine2, radius)
    if facing <= 0.0:
        return 0.0
    # A disc of light is a disc of half vectors: d_omega_l = 4 V.H d_omega_h
    radius2 = radius * radius / (4.0 * math.sqrt(1.0 - half_sine2))
    return ggx_density_under_disc(half_sine2, alpha, radius2) * facing


@kernel
def parallel_lobes(
    polar: float,
    polars: Doubles,
    solid_angles: Doubles,
    half_sines2: Doubles,
    columns: int,
    alpha: float,
    lobes: Doubles,
) -> float:
    """Write what texels weigh for a direction at `polar`, and return the sum over all of them.

    Parameters
    ----------
    polars, solid_angles
        (R,) of the rows of texels
    half_sines2
        (W // 2 + 1,) squared sines of half the azimuth from the direction to texels
    columns
        W, of which all but the first and, if W is even, the last of those stand for two
    lobes
        (R, W // 2 + 1), written: weights with the solid angle in them
    """
    total = 0.0
    last = len(half_sines2) - 1
    alone = columns % 2 == 0
    for row in range(len(polars)):
        rise = math.sin(0.5 * (polars[row] - polar))
        rise *= rise
        around = math.sin(polars[row]) * math.sin(polar)
        radius = math.sqrt(solid_angles[row] / math.pi)
        for k in range(last + 1):
            # Haversines keep their digits where lobes are narrow
            weight = lobe_weight(min(rise + around * half_sines2[k], 1.0), alpha, radius)
            weight *= solid_angles[row]
            lobes[row, k] = weight
            total += weight if k == 0 or (k == last and alone) else 2.0 * weight
    return total


@kernel
def add_products(lobes: Doubles, real: Doubles, imaginary: Doubles, spectrum: Doubles) -> None:
    """Add lobes (R, M) x the waves of a map (R, 3, M), summed over rows, to spectrum (2, 3, M)."""
    rows, count = lobes.shape
    for row in range(rows):
        for c in range(3):
            for m in range(count):
                spectrum[0, c, m] += lobes[row, m] * real[row, c, m]
                spectrum[1, c, m] += lobes[row, m] * imaginary[row, c, m]


@kernel
def add_sun(
    directions: Doubles,
    towards: Doubles,
    light: Doubles,
    alpha: float,
    radius: float,
    result: Floats,
) -> None:
    """Add the lobes of a disc of `radius` radians to result (N, 3).

    `light` (3,) is its irradiance over the integral of D N.L.
    """
    for i in range(len(directions)):
        x, y, z = (
            directions[i, 0] - towards[0],
            directions[i, 1] - towards[1],
            directions[i, 2] - towards[2],
        )
        half_sine2 = min(0.25 * (x * x + y * y + z * z), 1.0)
        weight = lobe_weight(half_sine2, alpha, radius)
        for c in range(3):
            result[i, c] += weight * light[c]
