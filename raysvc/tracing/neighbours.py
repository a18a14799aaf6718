"""What pixels lend each other: means over those about a point that show its surface.

Neighbours take different samples (interleaved sampling: Keller and Heidrich 2001), and a mean over
a whole tile of them is as smooth as all their samples together. A pixel takes part only if its
depth and its normal say that it shows the same surface: nothing is blurred across an edge (joint
bilateral filter: Petschnigg et al. 2004, Eisemann and Durand 2004).
"""

import numpy as np

from raysvc.tracing.neighbours_kernels import Shown, spans_about, weighted_means
from raysvc.types import Bools, Floats, Longs

BESIDE = np.ones((4, 2, 2), np.float32)
"""Weights of the 3 x 3 pixels about one."""


class Neighbours:
    """What the pixels of a picture know about each other's points.

    Values (M, C) are those of the points that pixels show; a row of NaN knows nothing. They are
    asked for N points anywhere in pixels (N,), at depths (N,), with normals (N, 3).
    """

    def __init__(self, shown: Shown) -> None:
        self._shown = shown

    @property
    def width(self) -> int:
        """Pixels across."""
        return int(self._shown.point_of.shape[1])

    def is_shown(self) -> Bools:
        """(M,) bool: which of the points are a pixel's."""
        found = np.zeros(len(self._shown.depth), np.bool_)
        found[self._shown.point_of[self._shown.point_of >= 0]] = True
        return found

    def mean(
        self, values: Floats, weights: Floats, pixel: Longs, depth: Floats, normal: Floats
    ) -> Floats:
        """Means (N, C) of what is known about points; NaN where no pixel shows their surface.

        Parameters
        ----------
        values
            (M, C) float32
        weights
            (4, R + 1, R + 1) float32: of pixels by how many rows and columns they are away, one
            table for each of the four places of a pixel in a 2 x 2 block (row by row)
        """
        mean = np.empty((len(pixel), values.shape[1]), np.float32)
        weighted_means(self._shown, values, weights, pixel, depth, normal, mean)
        return mean

    def span(
        self, values: Floats, reach: int, pixel: Longs, depth: Floats, normal: Floats
    ) -> Floats:
        """(N,) greatest less least of the values (M,) that are known up to `reach` pixels away.

        It is -inf where no pixel knows anything about the point.
        """
        span = np.empty(len(pixel), np.float32)
        spans_about(self._shown, values, reach, pixel, depth, normal, span)
        return span

    def differs(self, values: Floats, reach: int, least: float) -> Bools:
        """(H * W,) bool: values (M,) of pixels up to `reach` away have a span of more than `least`.

        Whatever surfaces they show: a quick first look.
        """
        known = np.append(values, np.float32(np.nan))[self._shown.point_of]
        blank = np.isnan(known)
        greatest = np.where(blank, -np.float32(np.inf), known)
        least_of = np.where(blank, np.float32(np.inf), known)
        for axis in (0, 1):
            greatest = _running(np.maximum, greatest, reach, axis)
            least_of = _running(np.minimum, least_of, reach, axis)
        found: Bools = (greatest - least_of > least).reshape(-1)
        return found


def _running(pick: np.ufunc, values: Floats, reach: int, axis: int) -> Floats:
    """Greatest or least of the values up to `reach` places away along an axis."""
    along = np.moveaxis(values, axis, 0)
    found = along.copy()
    for away in range(1, min(reach, len(along) - 1) + 1):
        pick(found[away:], along[:-away], out=found[away:])
        pick(found[:-away], along[away:], out=found[:-away])
    return np.moveaxis(found, 0, axis)
