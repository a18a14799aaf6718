"""What part of an area light's light arrives at the points of a picture.

A ray from every point goes to another place of the light than its neighbours'. Only where rays
about a point disagree is there a penumbra, and only there do the others of its rays go out, and
points take a mean over neighbours that show the same surface: over as many pixels as the penumbra
is wide, so that a sharp edge stays as sharp as it is (compare Mehta et al. 2012, "Axis-Aligned
Filtering for Interactive Sampled Soft Shadows", where a filter's width follows the distance of what
casts the shadow).
"""

import numpy as np

from raysvc.frame.direct_light import DirectLight, unshadowed
from raysvc.frame.points import Points
from raysvc.frame.primary import CHUNK
from raysvc.lighting.area_light import AreaLight
from raysvc.parallel import Control, for_chunks
from raysvc.tracing.neighbours import BESIDE, Neighbours
from raysvc.tracing.tile_pattern import RAYS, dealt_points, place_in_tile
from raysvc.types import Doubles, Floats, Longs


def _tent(*weights: float) -> Floats:
    """Weights of pixels so many rows and columns away, wherever in a block of pixels."""
    return np.tile(np.outer(weights, weights).astype(np.float32), (4, 1, 1))


MEANS = ((3, _tent(1.0, 0.75, 0.5, 0.25)), (1, _tent(1.0, 0.5)))
"""Wide and narrow mean over neighbours: how far it reaches, and weights. Every place of a 4 x 4, or
2 x 2, tile counts the same in it."""
WHOLE = 0.95
"""Span of the values within a mean's reach at which all of a penumbra is there: it is too wide."""
PENUMBRA, LEAST_DIFFERENCE = 3, 1.0 / 16.0
"""Within how many pixels rays that differ by how much make a penumbra."""
AGREEING = 0.5
"""Span of the values about a point up to which it takes the word of its neighbours."""


class AreaShadow:
    """The shadow of one area light in a picture."""

    def __init__(
        self,
        direct: DirectLight,
        light: AreaLight,
        points: Points,
        neighbours: Neighbours,
        seed: int,
    ) -> None:
        """`neighbours` are those of `points`, told apart by their geometric normals."""
        self._direct, self._light = direct, light
        self._points, self._neighbours, self._samples = points, neighbours, dealt_points(seed)
        self._part = np.full((len(points.pixel), 1), np.nan, np.float32)
        """(N, 1) part of the light that arrives; NaN where there is none."""

    def fallen(self, control: Control) -> Floats:
        """(N, 3) radiance that the points return of the light."""
        points, part = self._points, self._part
        radiance = np.empty((len(points.pixel), 3), np.float32)

        def light_up(begin: int, end: int) -> None:
            radiance[begin:end] = unshadowed(self._light, points.surface.rows(begin, end))

        for_chunks(len(radiance), CHUNK, light_up, control)
        lit = radiance.any(axis=1)
        in_front = self._neighbours.is_shown()
        shared, alone = np.flatnonzero(lit & in_front), np.flatnonzero(lit & ~in_front)

        def first(begin: int, end: int) -> None:
            part[shared[begin:end]] = self._rays(shared[begin:end], range(1))

        for_chunks(len(shared), CHUNK, first, control)
        torn = self._torn(shared, control)
        seen = part[torn]

        def others(begin: int, end: int) -> None:
            rest = self._rays(torn[begin:end], range(1, RAYS))
            seen[begin:end] += rest * np.float32(RAYS - 1)

        for_chunks(len(torn), CHUNK // 4, others, control)
        part[torn] = seen / np.float32(RAYS)
        soft = np.empty_like(seen)

        def mean(begin: int, end: int) -> None:
            soft[begin:end] = self._around(torn[begin:end])

        for_chunks(len(torn), CHUNK, mean, control)
        part[torn] = soft

        def lonely(begin: int, end: int) -> None:
            some = alone[begin:end]
            part[some, 0] = self._direct.alone(self._light, points.surface, some)

        for_chunks(len(alone), CHUNK, lonely, control)
        radiance[lit] *= part[lit]
        return radiance

    def _rays(self, index: Longs, rays: range) -> Floats:
        """(M, 1) mean of some of the RAYS from points `index` (M,)."""
        pixel, width = self._points.pixel[index], self._neighbours.width
        samples = self._samples[place_in_tile(pixel, width) % len(self._samples)]
        parts = [
            self._direct.part(self._light, self._points.surface, index, samples[:, ray])
            for ray in rays
        ]
        mean: Floats = np.mean(parts, axis=0, dtype=np.float32)
        return mean[:, None]

    def _torn(self, index: Longs, control: Control) -> Longs:
        """Those of points `index` (M,) about which rays from pixels do not say the same."""
        differs = self._neighbours.differs(self._part[:, 0], PENUMBRA, LEAST_DIFFERENCE)
        near = index[differs[self._points.pixel[index]]]
        span = np.empty(len(near), np.float32)

        def some(begin: int, end: int) -> None:
            where = self._where(near[begin:end])
            span[begin:end] = self._neighbours.span(self._part[:, 0], PENUMBRA, *where)

        for_chunks(len(near), CHUNK, some, control)
        return near[span > LEAST_DIFFERENCE]

    def _around(self, index: Longs) -> Floats:
        """(M, 1) means over the pixels about points `index` (M,)."""
        mean = self._part[index]
        left = np.arange(len(index))
        for reach, weights in MEANS:
            where = self._where(index[left])
            narrow = self._neighbours.span(self._part[:, 0], reach, *where) >= WHOLE
            wide = left[~narrow]
            mean[wide] = self._neighbours.mean(self._part, weights, *self._where(index[wide]))
            left = left[narrow]
        return mean

    def _where(self, index: Longs) -> tuple[Longs, Floats, Floats]:
        """Pixels, depths and geometric normals of points `index` (M,)."""
        points = self._points
        return points.pixel[index], points.depth[index], points.surface.geometric_normal[index]

    def at(self, points: Points, samples: Doubles) -> Floats:
        """(N, 3) radiance that other points in the picture's pixels return of the light.

        They take their neighbours' word if those agree. The others ask for themselves, by a ray
        each to the place of the light that samples (N, 2) in 0..1 name: it is for several points in
        a pixel to ask for different places.
        """
        radiance = unshadowed(self._light, points.surface)
        lit = np.flatnonzero(radiance.any(axis=1))
        where = points.pixel[lit], points.depth[lit], points.surface.geometric_normal[lit]
        part = self._neighbours.mean(self._part, BESIDE, *where)
        agree = self._neighbours.span(self._part[:, 0], 1, *where) <= AGREEING
        unsure = np.flatnonzero(~agree | np.isnan(part[:, 0]))
        asking = lit[unsure]
        part[unsure, 0] = self._direct.part(self._light, points.surface, asking, samples[asking])
        radiance[lit] *= part
        return radiance
