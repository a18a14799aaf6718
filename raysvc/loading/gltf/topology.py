"""Triangles of lists, strips and fans (specification, section 3.7.2.1)."""

import numpy as np

from raysvc.types import Longs

LIST, STRIP, FAN = 4, 5, 6
MODES = (LIST, STRIP, FAN)
NAMES = {0: "points", 1: "lines", 2: "a line loop", 3: "a line strip"}


def triangle_count(mode: int, indices: int) -> int:
    """Return how many triangles `indices` vertices make; 0 for points and lines."""
    if mode == LIST:
        return indices // 3
    return max(indices - 2, 0) if mode in (STRIP, FAN) else 0


def triangles_of(mode: int, indices: Longs) -> Longs:
    """Return the triangles that a primitive draws, all wound the same way.

    Parameters
    ----------
    mode
        LIST, STRIP or FAN
    indices
        (N,) int64 vertices in drawing order

    Returns
    -------
    (F, 3) int64 vertices
    """
    count = triangle_count(mode, len(indices))
    if mode == LIST:
        return indices[: 3 * count].reshape(-1, 3)
    first = np.arange(count)
    if mode == STRIP:
        odd = first % 2
        corners = np.stack([first, first + 1 + odd, first + 2 - odd], axis=1)
    else:
        corners = np.stack([first + 1, first + 2, np.zeros_like(first)], axis=1)
    return indices[corners]
