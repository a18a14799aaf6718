"""The table of round lobes whose sums are GGX lobes; `bench.fit_lobes` makes it."""

from functools import lru_cache
from pathlib import Path

import numpy as np

from raysvc.types import Floats

FILE = Path(__file__).with_name("lobe_fit.npz")
LOOKUPS = (1, 2, 4)
"""Numbers of round lobes for which there are fits."""
ALPHA_NODES = 21
"""From alpha 2^-10 to 1, a factor of the square root of two apart."""
NODES = 12
"""Of N.V, evenly in its square root from 0 to 1."""


@lru_cache(maxsize=len(LOOKUPS))
def fitted_lobes(lookups: int) -> Floats:
    """Round lobes of each alpha and N.V: read-only (ALPHA_NODES, NODES, lookups, 4) float32.

    Each is its place between N (0) and R (1) on the line through both, the level of its width less
    that of the GGX lobe, and its weights for light times 1 - x and times x, where x is Schlick's
    Fresnel weight.
    """
    with np.load(FILE) as tables:
        table: Floats = np.ascontiguousarray(tables[f"lookups_{lookups}"])
    table.setflags(write=False)
    return table


@lru_cache(maxsize=1)
def split_sum_lobes() -> Floats:
    """One round lobe about R, as if every surface were seen from straight above (Karis 2013)."""
    table = np.zeros((ALPHA_NODES, NODES, 1, 4), np.float32)
    table[:] = (1.0, 0.0, 1.0, 1.0)
    table.setflags(write=False)
    return table
