"""The nearest triangle of each ray while several structures are asked in turn.

It is the distance buffer of the talk's multi-pass renderer: each structure is asked only up to what
is known, and what is nearer is kept. The answer is that of one structure over everything.
"""

import numpy as np

from raysvc.accel.base import Hits, Rays, Triangles, hits_on
from raysvc.accel.nearest_kernels import keep_nearer
from raysvc.types import Doubles, Ints


class NearestSoFar:
    """The nearest triangle of each ray so far; `rays` reach just as far as it."""

    def __init__(self, triangles: Triangles, rays: Rays) -> None:
        self._triangles, self._asked = triangles, rays
        self.triangle: Ints = np.full(len(rays), -1, np.int32)
        """(R,) the nearest so far, the lowest number where several tie, or -1."""
        self._t: Doubles = np.full(len(rays), np.inf)
        self.rays = Rays(rays.origins, rays.directions, rays.t_max.copy())

    def take(self, found: Ints) -> None:
        """Compare with what another structure has found: (R,) triangles or -1."""
        keep_nearer(
            self.rays.origins,
            self.rays.directions,
            self._triangles.positions,
            self._triangles.indices,
            found,
            self.triangle,
            self._t,
            self.rays.t_max,
        )

    def hits(self) -> Hits:
        """Where the rays meet the nearest triangles so far."""
        return hits_on(self._triangles, self.triangle, self._asked)
