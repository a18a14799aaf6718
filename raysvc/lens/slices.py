"""What is spread together: points cut into slices by signed circle of confusion.

What is far behind the focus must not wash over what is nearer, so slices are spread apart and laid
over each other. A slice holds blurs of about the same size, for what overlaps within a slice is
mixed. Next to each other slices are soft: the memberships of a point sum to one, so that a surface
that recedes has no seam.
"""

import math
from dataclasses import dataclass

import numpy as np

from raysvc.types import Floats

SHARP_PX = 1.0
"""A point whose diameter is no larger than a pixel is in focus: it spreads nothing."""
SMALL_PX = 4.0
"""By default the first slice on either side goes up to this diameter, and each next one to twice
the diameter of the last."""
FADE = 2.0**0.2
"""Two slices share the diameters from their bound divided by this to the bound times this."""
MOST_LAYERS = 16


@dataclass(frozen=True, slots=True, eq=False)
class Slices:
    """S slices from the nearest to the farthest."""

    fade_begin: Floats
    """(S - 1,) signed diameter at which a point begins to pass from a slice to the next ..."""
    fade_end: Floats
    """(S - 1,) ... and at which it has; equal on both sides of the focus."""
    sharp: int
    """Which slice is in focus."""

    @property
    def count(self) -> int:
        """S."""
        return len(self.fade_end) + 1

    def beyond(self, coc_px: Floats) -> Floats:
        """Return diameters from which on a point is in no slice of another's, which has (...).

        inf for what is in the last.
        """
        last = np.searchsorted(self.fade_begin, coc_px, side="left")
        ends = np.append(self.fade_end, np.float32(np.inf))
        bound: Floats = ends[last].astype(np.float32)
        return bound


def slices_for(least_px: float, largest_px: float, layers: int | None = None) -> Slices:
    """Cut diameters from `least_px` to `largest_px`, signed, into slices.

    Parameters
    ----------
    layers
        how many slices there are out of focus; by default as many as it takes for none to hold
        blurs of which one is more than twice as large as another, but for small ones. There is at
        least one on either side of the focus on which there is anything.
    """
    sides = [max(-least_px, SHARP_PX), max(largest_px, SHARP_PX)]
    counts = [_count(side) for side in sides]
    if layers is not None:
        counts = _shared_out(layers, sides)
    near, far = (
        _bounds(side, count, layers is None) for side, count in zip(sides, counts, strict=True)
    )
    fades = [_fade(bounds) for bounds in (near, far)]
    begin = [-b * fades[0] for b in reversed(near[1:])]
    end = [-b / fades[0] for b in reversed(near[1:])]
    for bounds, focus in ((near, -SHARP_PX), (far, SHARP_PX)):
        if bounds:
            begin.append(focus)
            end.append(focus)
    begin += [b / fades[1] for b in far[1:]]
    end += [b * fades[1] for b in far[1:]]
    return Slices(np.array(begin, np.float32), np.array(end, np.float32), len(near))


def _count(side_px: float) -> int:
    if side_px <= SHARP_PX:
        return 0
    return min(1 + max(0, math.ceil(math.log2(side_px / SMALL_PX))), MOST_LAYERS)


def _bounds(side_px: float, count: int, doubling: bool) -> list[float]:
    """Where slices on one side of the focus begin."""
    if doubling:
        return [SHARP_PX, *(SMALL_PX * 2.0**k for k in range(count - 1))][:count]
    return [side_px ** (k / count) for k in range(count)]


def _fade(bounds: list[float]) -> float:
    """FADE, or less where slices are so thin that their fades would meet."""
    return min(FADE, math.sqrt(bounds[1] / bounds[0])) if len(bounds) > 1 else FADE


def _shared_out(layers: int, sides: list[float]) -> list[int]:
    """How many of the slices are before, and how many behind the focus: by octaves of blur."""
    octaves = [math.log2(side) for side in sides]
    if 0.0 in octaves:
        return [layers if side > 0.0 else 0 for side in octaves]
    near = round(layers * octaves[0] / sum(octaves))
    near = min(max(near, 1), max(layers - 1, 1))
    return [near, max(layers - near, 1)]
