"""A lat-long map in another size: texels are areas of constant radiance, and so are the new ones.

Every new texel is the mean of what it covers, by solid angle, so that a map keeps its light in any
size and however it is turned.
"""

import math

import numpy as np

from raysvc.types import Doubles, Floats


def resampled(radiance: Floats | Doubles, height: int, width: int, yaw_deg: float = 0.0) -> Doubles:
    """Return a map's means over the texels of another map.

    Parameters
    ----------
    radiance
        (H, W, 3)
    height, width
        of the result
    yaw_deg
        turns the map counter-clockwise seen from above

    Returns
    -------
    (height, width, 3) float64
    """
    shift = (yaw_deg / 360.0 % 1.0) * radiance.shape[1]
    return _columns(_rows(radiance, height), width, shift)


def _rows(radiance: Floats | Doubles, height: int) -> Doubles:
    """Means (height, W, 3) of bands between parallels."""
    rows = len(radiance)
    if height == rows:
        return radiance.astype(np.float64)
    # What counts is the height on the sphere, which is solid angle
    levels = np.cos(np.arange(rows + 1) * (math.pi / rows))
    edges = np.cos(np.arange(height + 1) * (math.pi / height))
    result = np.empty((height, *radiance.shape[1:]))
    for row in range(height):
        first = min(row * rows // height, rows - 1)
        last = min(-(-(row + 1) * rows // height), rows)
        above = np.minimum(levels[first:last], edges[row])
        below = np.maximum(levels[first + 1 : last + 1], edges[row + 1])
        weights = np.maximum(above - below, 0.0)
        weights /= weights.sum()
        result[row] = np.einsum("k,kwc->wc", weights, radiance[first:last])
    return result


def _columns(radiance: Doubles, width: int, shift: float) -> Doubles:
    """Means (H, width, 3) of even parts of every row, the first of which begins at `shift`."""
    columns = radiance.shape[1]
    if width == columns and shift == round(shift):
        turned: Doubles = np.roll(radiance, -round(shift), axis=1)
        return turned
    edges = shift + np.arange(width + 1) * (columns / width)
    around = np.floor(edges)
    texel = around.astype(np.int64)
    # Integral from 0 to each edge, once around the map and on
    sums = np.zeros((len(radiance), columns + 1, 3))
    np.cumsum(radiance, axis=1, out=sums[:, 1:])
    turns, texel = np.divmod(texel, columns)
    integral = sums[:, texel] + (edges - around)[:, None] * radiance[:, texel]
    integral += turns[:, None] * sums[:, -1:]
    means: Doubles = np.maximum(np.diff(integral, axis=1) * (width / columns), 0.0)
    return means
