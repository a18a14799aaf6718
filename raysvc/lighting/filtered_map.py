"""An environment filtered for a roughness, as a map: for renderers that look it up once a pixel.

Along d it holds the mean of radiance over the GGX lobe of a surface that is seen from straight
above, normal = view = reflection = d, weighted by N.L (Karis 2013, "Real Shading in Unreal Engine
4", PrefilterEnvMap):

    integral of L(l) D(h) N.L dl / integral of D(h) N.L dl         D / 4 is the density of l

The lobe is the same all around, so that between two parallels of a map it is a circular convolution
(as in Driscoll and Healy 1994): every texel counts with its exact weight, for the price of one
Fourier transform per pair of parallels. A sun is a term in closed form of its own.
"""

import math
from typing import Final

import numpy as np

from raysvc.errors import InvalidSetting, LimitExceeded
from raysvc.lighting.area_resampling import resampled
from raysvc.lighting.brdf import MIRROR_ROUGHNESS, ggx_alpha
from raysvc.lighting.lat_long import check_turned, texel_directions, texel_solid_angles
from raysvc.lighting.lobe_filter_kernels import add_products, add_sun, parallel_lobes
from raysvc.lighting.sun import SunLight, extract_suns
from raysvc.parallel import Control, for_chunks
from raysvc.scene import Environment
from raysvc.types import Doubles, Floats

MAX_WIDTH: Final = 4096
MAX_HEIGHT: Final = 1024
"""Of a filtered map; time goes as the cube of the height."""

ROWS_PER_LOBE: Final = 6.0
"""Rows of the map that is read, times alpha: lobes are then 5 texels wide at half their height, and
a wave that such a map cannot hold is damped to e^-12."""
FEWEST_ROWS: Final = 64
"""That the map that is read has at least, for the kink of N.L at the horizon."""
FEWEST_ROWS_OF_TEXELS: Final = 16
"""That it has where lobes are narrower than texels."""
CHEAP_ROWS: Final = 256
"""That it may have however small the result is."""
MOST_ROWS: Final = 640
"""That it ever has, for its time's sake; enough for roughness 0.1."""
ROWS_OF_CHUNK: Final = 4


def filtered_map(
    environment: Environment,
    roughness: float,
    width: int = 512,
    height: int = 256,
    *,
    yaw_deg: float = 0.0,
    strength: float = 1.0,
    control: Control | None = None,
) -> Floats:
    """Return the mean of an environment over the GGX lobe of every direction, weighted by N.L.

    Parameters
    ----------
    environment
        what is filtered, its sun included
    roughness
        0 to 1, glTF's: GGX's alpha is its square. Up to MIRROR_ROUGHNESS it is the map itself, in
        the size that is asked for; 1 is the cosine lobe, irradiance / pi. Narrow lobes
        are averaged over texels of the result: under 3 of its rows, or of any up to 0.096.
    width, height
        of the result in texels, at most MAX_WIDTH and MAX_HEIGHT; not taller than wide
    yaw_deg, strength
        turn the environment counter-clockwise seen from above, and scale it
    control
        threads and deadline

    Returns
    -------
    (height, width, 3) float32, lat-long like `Environment`

    Raises
    ------
    InvalidSetting, LimitExceeded
        naming `roughness`, `width`, `height`, `yaw_deg` or `strength`
    """
    if not 0.0 <= roughness <= 1.0:
        raise InvalidSetting(f"must be 0 to 1, is {roughness}", field="roughness")
    check_size(width, height)
    check_turned(yaw_deg, strength)
    control = control or Control()
    if roughness <= MIRROR_ROUGHNESS:
        control.check()
        picture = strength * resampled(environment.radiance, height, width, yaw_deg)
        return picture.astype(np.float32)

    alpha = ggx_alpha(roughness)
    rows = math.ceil(ROWS_PER_LOBE / alpha)
    limit = max(2 * height, min(4 * height, CHEAP_ROWS), FEWEST_ROWS_OF_TEXELS)
    if rows <= min(limit, MOST_ROWS):
        rows = max(rows, FEWEST_ROWS)
        suns, rest = extract_suns(environment.radiance)
        filtered = _convolved(
            resampled(rest, rows, 2 * rows, yaw_deg), alpha, height, width, control
        )
        for sun in suns:
            _add_sun(sun, alpha, yaw_deg, filtered)
    else:
        # The lobe is narrow for the result, or for MOST_ROWS: means over its texels, and the sun
        # is one of them
        finer = -(-FEWEST_ROWS_OF_TEXELS // height)
        texels = resampled(environment.radiance, finer * height, finer * width, yaw_deg)
        filtered = _convolved(texels, alpha, finer * height, finer * width, control)
        if finer > 1:
            filtered = resampled(filtered, height, width).astype(np.float32)
    filtered *= np.float32(strength)
    return filtered


def irradiance_map(
    environment: Environment,
    width: int = 512,
    height: int = 256,
    *,
    yaw_deg: float = 0.0,
    strength: float = 1.0,
    control: Control | None = None,
) -> Floats:
    """Return the irradiance of a surface that faces every direction: integral of L max(N.L, 0).

    It is not divided by pi: a white diffuser shows irradiance / pi. Parameters, result and errors
    are those of `filtered_map`, whose lobe at roughness 1 is the cosine.
    """
    cosine = filtered_map(
        environment, 1.0, width, height, yaw_deg=yaw_deg, strength=strength, control=control
    )
    cosine *= np.float32(math.pi)
    return cosine


def check_size(width: int, height: int) -> None:
    """Raise InvalidSetting or LimitExceeded for a size that a filtered map cannot have."""
    for field, side, limit in (("width", width, MAX_WIDTH), ("height", height, MAX_HEIGHT)):
        if side < 1:
            raise InvalidSetting(f"must be at least 1, is {side}", field=field)
        if side > limit:
            raise LimitExceeded(f"must be at most {limit:,}, is {side:,}", field=field)
    if height > width:
        raise InvalidSetting(f"must be at most the width, {width:,}, is {height:,}", field="height")


def lobe_integral(alpha: float) -> float:
    """Integral of D(h) N.L over the light's directions, where normal = view."""
    a2 = alpha * alpha
    b = 1.0 - a2
    if b < 1e-3:
        return (1.0 - b) * (1.0 + 5.0 / 3.0 * b)
    return 4.0 * a2 / b**2 * (b / a2 - 2.0 * math.log((1.0 + a2) / (2.0 * a2)))


def _convolved(source: Doubles, alpha: float, height: int, width: int, control: Control) -> Floats:
    """Means (height, width, 3) of a map (H, W, 3) over lobes around every direction."""
    rows, columns, _ = source.shape
    polars = (np.arange(rows) + 0.5) * (math.pi / rows)
    solid_angles = texel_solid_angles(rows, columns)
    count = columns // 2 + 1
    half_sines2 = np.sin(np.arange(count) * (math.pi / columns)) ** 2
    waves = np.fft.rfft(source.transpose(0, 2, 1), axis=2)
    real, imaginary = np.ascontiguousarray(waves.real), np.ascontiguousarray(waves.imag)

    # Back to as many columns as hold all waves and of which the result's are some
    stride = -(-columns // width)
    fine = stride * width
    moved = np.exp(1j * math.pi * np.arange(count) * (1.0 / width - 1.0 / columns))
    # The last wave of an even number stands for itself and its mirror image
    if fine > columns and columns % 2 == 0:
        moved[-1] *= 0.5
    moved *= fine / columns
    result = np.empty((height, width, 3), np.float32)

    def pictured(row: int, spectrum: Doubles, total: float) -> None:
        waves = (spectrum[0] + 1j * spectrum[1]) * (moved / total)
        picture = np.fft.irfft(waves, fine, axis=1)[:, ::stride]
        # Ringing is far below what is asked of a lobe, but light is never negative
        result[row] = np.maximum(picture.T, 0.0)

    def work(begin: int, end: int) -> None:
        for row in range(begin, end):
            polar = (row + 0.5) * (math.pi / height)
            # Rows of which anything is over the horizon
            first = max(int((polar / math.pi - 0.5) * rows) - 2, 0)
            last = min(int((polar / math.pi + 0.5) * rows) + 3, rows)
            lobes = np.empty((last - first, count))
            seen = slice(first, last)
            total = parallel_lobes(
                polar, polars[seen], solid_angles[seen], half_sines2, columns, alpha, lobes
            )
            # Lobes are the same to both sides: their waves are real
            lobes = np.fft.hfft(lobes, columns, axis=1)[:, :count]
            spectrum = np.zeros((2, 3, count))
            add_products(lobes, real[seen], imaginary[seen], spectrum)
            pictured(row, spectrum, total)
            # The parallel on the other side of the equator sees the same, upside down
            if row != height - 1 - row:
                seen = slice(rows - last, rows - first)
                spectrum = np.zeros((2, 3, count))
                add_products(lobes[::-1], real[seen], imaginary[seen], spectrum)
                pictured(height - 1 - row, spectrum, total)

    for_chunks(-(-height // 2), ROWS_OF_CHUNK, work, control)
    return result


def _add_sun(sun: SunLight, alpha: float, yaw_deg: float, picture: Floats) -> None:
    """Add the lobes of a turned sun to a map (H, W, 3)."""
    height, width, _ = picture.shape
    rows, columns = np.mgrid[0:height, 0:width] + 0.5
    directions = texel_directions(rows, columns, height, width).reshape(-1, 3)
    yaw = math.radians(yaw_deg)
    towards = np.array(sun.turned(math.cos(yaw), math.sin(yaw)).direction)
    light = np.array(sun.irradiance) / lobe_integral(alpha)
    add_sun(directions, towards, light, alpha, sun.angular_radius_rad, picture.reshape(-1, 3))
