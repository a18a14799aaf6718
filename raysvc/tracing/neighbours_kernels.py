"""Loops over the pixels about a point that show its surface."""

from typing import NamedTuple

import numpy as np

from raysvc.jit import inlined, kernel
from raysvc.types import Floats, Longs

SAME_NORMAL = 0.9
"""Cosine between normals of pixels that are taken to be one surface."""


class Shown(NamedTuple):
    """What the pixels of a picture show: M points, and which of them is each pixel's."""

    point_of: Longs
    """(H, W) number of the point, -1 where there is none."""
    depth: Floats
    """(M,) metres along the view axis."""
    normal: Floats
    """(M, 3) unit."""
    depth_step: Floats
    """(M,) metres: how much depth may differ per pixel of distance on one surface."""


@inlined
def shows_surface(shown: Shown, k: int, far: int, depth: Floats, normal: Floats, n: int) -> bool:
    """Whether point k, `far` rows and columns away, is of the surface of point n of others."""
    same = (
        normal[n, 0] * shown.normal[k, 0]
        + normal[n, 1] * shown.normal[k, 1]
        + normal[n, 2] * shown.normal[k, 2]
    ) > SAME_NORMAL
    near = abs(shown.depth[k] - depth[n]) <= shown.depth_step[k] * (far + 1)
    return bool(same and near)


@kernel
def weighted_means(
    shown: Shown,
    values: Floats,
    weights: Floats,
    pixel: Longs,
    depth: Floats,
    normal: Floats,
    mean: Floats,
) -> None:
    """Fill mean (N, C) of points in pixels (N,) with what pixels about each say.

    A pixel that is y rows and x columns away takes part with weights[P, |y|, |x|] if it knows
    something (its values (M, C) are not NaN) and shows the point's surface. P is 0..3: whether the
    point's row and column are odd (2, 1). The mean of no pixels is NaN.
    """
    height, width = shown.point_of.shape
    channels = values.shape[1]
    reach = weights.shape[1] - 1
    total = np.empty(channels, np.float64)
    for n in range(len(pixel)):
        row, col = pixel[n] // width, pixel[n] % width
        parity = 2 * (row % 2) + col % 2
        total[:] = 0.0
        counted = 0.0
        for y in range(max(row - reach, 0), min(row + reach + 1, height)):
            for x in range(max(col - reach, 0), min(col + reach + 1, width)):
                away_y, away_x = abs(y - row), abs(x - col)
                w = weights[parity, away_y, away_x]
                k = shown.point_of[y, x]
                if w == 0.0 or k < 0 or np.isnan(values[k, 0]):
                    continue
                if shows_surface(shown, k, away_y + away_x, depth, normal, n):
                    for c in range(channels):
                        total[c] += w * values[k, c]
                    counted += w
        for c in range(channels):
            mean[n, c] = total[c] / counted if counted > 0.0 else np.nan


@kernel
def spans_about(
    shown: Shown,
    values: Floats,
    reach: int,
    pixel: Longs,
    depth: Floats,
    normal: Floats,
    span: Floats,
) -> None:
    """Fill span (N,): greatest less least of the values (M,) about points in pixels (N,).

    Pixels up to `reach` rows and columns away count that know something and show the point's
    surface. It is -inf where there are none.
    """
    height, width = shown.point_of.shape
    for n in range(len(pixel)):
        row, col = pixel[n] // width, pixel[n] % width
        least, greatest = np.inf, -np.inf
        for y in range(max(row - reach, 0), min(row + reach + 1, height)):
            for x in range(max(col - reach, 0), min(col + reach + 1, width)):
                k = shown.point_of[y, x]
                if k < 0 or np.isnan(values[k]):
                    continue
                # Surfaces are only compared where it matters
                if values[k] < least or values[k] > greatest:
                    far = abs(y - row) + abs(x - col)
                    if shows_surface(shown, k, far, depth, normal, n):
                        least, greatest = min(least, values[k]), max(greatest, values[k])
        span[n] = greatest - least
