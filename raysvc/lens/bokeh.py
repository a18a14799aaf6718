"""What a point out of focus becomes: an aperture's shape, or a box of order 1 to 3."""

import math
from dataclasses import dataclass
from typing import Literal

from raysvc.lens.aperture import DISC, Aperture, Stamps, stamps
from raysvc.lens.aperture_kernels import draw_apertures
from raysvc.lens.box_kernels import SIDE_PER_DIAMETER, draw_boxes, draw_smooth_boxes
from raysvc.lens.sources import Sources
from raysvc.lens.sum_kernels import sum_along_columns, sum_along_rows
from raysvc.types import Doubles, Longs


@dataclass(frozen=True, slots=True)
class Bokeh:
    """The filter of a lens."""

    shape: Literal["aperture", "box"] = "aperture"
    order: int = 1
    """Of a box: 1 is even, 2 and 3 are smoother; all of the variance of the disc."""
    aperture: Aperture = DISC

    @property
    def half_per_diameter(self) -> float:
        """How far a point reaches, in diameters of its circle of confusion."""
        if self.shape == "aperture":
            return 0.5
        return 0.5 * SIDE_PER_DIAMETER * math.sqrt(self.order)

    def pen(self, largest_px: float) -> "Pen":
        """Return what draws diameters up to `largest_px`."""
        reach = math.ceil(self.half_per_diameter * largest_px) + 1 + self.order
        table = None
        if self.shape == "aperture":
            table = stamps(self.aperture, math.ceil(largest_px) + 1)
        return Pen(self, reach, table)


@dataclass(frozen=True, slots=True)
class Pen:
    """Draws points as a bokeh, up to a size."""

    bokeh: Bokeh
    reach: int
    """Pixels that a shape may go from the pixel of its centre."""
    table: Stamps | None

    def rows(self, first: int, last: int, height: int) -> tuple[int, int]:
        """Which rows, some beyond a picture of `height`, must be drawn for its rows first..last."""
        apron = 2 * self.reach if self.bokeh.shape == "box" and self.bokeh.order > 1 else 0
        top = -self.reach if first < self.reach else first
        bottom = height + self.reach if last > height - self.reach else last
        return top - apron, bottom + apron

    def draw(
        self, sources: Sources, scale: Doubles, top: int, bottom: int, left: int, deltas: Longs
    ) -> None:
        """Draw what sources spread over rows top..bottom, as sums in fixed point.

        scale: (CHANNELS,) steps per unit. deltas: (bottom - top + 2, columns, CHANNELS) int64
        zeros, from column `left` of the picture on.
        """
        where = self.reach, left, top, bottom, deltas
        if self.table is not None:
            draw_apertures(sources, self.table, scale, *where)
            sum_along_rows(deltas)
        elif self.bokeh.order == 1:
            draw_boxes(sources, scale, *where)
            sum_along_rows(deltas)
            sum_along_columns(deltas)
        else:
            draw_smooth_boxes(sources, self.bokeh.order, scale, *where)
            for _ in range(self.bokeh.order):
                sum_along_rows(deltas)
                sum_along_columns(deltas)
