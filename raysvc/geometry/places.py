"""Which vertices are at the same place."""

import numpy as np

from raysvc.types import Doubles, Floats, Longs


def welded(positions: Doubles | Floats) -> Longs:
    """(V,) number of the place where each of (V, 3) vertices is, as float32 tells places apart."""
    rows = (positions.astype(np.float32) + np.float32(0.0)).view(np.uint32)  # -0 becomes +0
    order = np.lexsort(rows.T)
    changed = np.any(np.diff(rows[order], axis=0) != 0, axis=1)
    places = np.empty(len(rows), np.int64)
    places[order] = np.concatenate([[0], np.cumsum(changed)])[: len(rows)]
    return places
