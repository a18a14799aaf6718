"""Rays that go on behind what they have met."""

import numpy as np

from raysvc.accel.base import Hits, Rays
from raysvc.types import Bools, Floats, Longs

STEP = 2e-6
"""How far behind a hit a ray goes on, as a part of its coordinates: some 16 steps of float32."""


class March:
    """R rays on their way, each from hit to hit, until it stops.

    A ray goes on as a new one whose origin lies behind the last hit. Rounding may put that origin
    back before the triangle, above all where the ray grazes it. Since a ray meets a plane only
    once, the same triangle twice running is such a mistake and is not counted.
    """

    def __init__(self, rays: Rays, limit: Floats, active: Longs) -> None:
        """`limit` (R,) is the greatest t; only rays `active` (A,) set out."""
        self._rays, self._limit = rays, limit
        self.active = active
        """(A,) numbers of the rays that are still on their way."""
        self._begin = np.zeros(len(rays), np.float32)
        self._last = np.full(len(rays), -1, np.int32)

    def ahead(self) -> Rays:
        """(A) rays from where the active ones are now."""
        if len(self.active) == len(self._rays) and not self._begin.any():
            return Rays(self._rays.origins, self._rays.directions, self._limit)
        begin = self._begin[self.active]
        return Rays(
            self._rays.origins[self.active] + self._rays.directions[self.active] * begin[:, None],
            self._rays.directions[self.active],
            self._limit[self.active] - begin,
        )

    def distance(self, hits: Hits) -> Floats:
        """(A,) t from where the active rays once began, of hits along `ahead()`."""
        t: Floats = self._begin[self.active] + hits.t
        return t

    def is_new(self, hits: Hits) -> Bools:
        """(A,) bool: something was met that was not met just before."""
        new: Bools = (hits.triangle >= 0) & (hits.triangle != self._last[self.active])
        return new

    def go_on(self, hits: Hits, onward: Bools) -> None:
        """Let those of the active rays go on that are `onward` (A,) bool, behind their hits."""
        rest = self.active[onward]
        t = self._begin[rest] + hits.t[onward]
        directions = np.abs(self._rays.directions[rest])
        reach = (np.abs(self._rays.origins[rest]) + directions * t[:, None]).max(axis=1)
        step = np.float32(STEP) * reach / directions.max(axis=1)
        self._begin[rest] = t + np.maximum(step, np.float32(STEP) * t)
        self._last[rest] = hits.triangle[onward]
        self.active = rest
