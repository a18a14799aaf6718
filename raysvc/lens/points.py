"""What a lens is given: points of pixels, each with a colour and a circle of confusion."""

from dataclasses import dataclass

import numpy as np

from raysvc.errors import InvalidInput
from raysvc.lens.point_kernels import Columns, merge_by_pixel
from raysvc.types import Floats, Longs


@dataclass(frozen=True, slots=True, eq=False)
class LensPoints:
    """N points that the pixels of a picture (H, W) show or hide.

    Those of one pixel follow each other from near to far. What hides nothing of what is behind it
    covers nothing; a pixel whose points do not cover it wholly shows what its neighbours know.
    """

    shape: tuple[int, int]
    """H, W."""
    pixel: Longs
    """(N,) row * W + column, ascending."""
    coc_px: Floats
    """(N,) signed diameter of the circle of confusion, negative nearer than the focus."""
    rgba: Floats
    """(N, 4) linear, multiplied by `cover`."""
    cover: Floats
    """(N,) part of what is behind that the point hides, 0..1. Alpha is what the picture gets; a
    point of an empty background covers all, with alpha 0."""

    @staticmethod
    def of_picture(rgba: Floats, coc_px: Floats) -> "LensPoints":
        """Return the points of a premultiplied picture (H, W, 4), one per pixel, that hide all.

        Raises InvalidInput if the shapes do not match or a circle of confusion is not finite.
        """
        if rgba.ndim != 3 or rgba.shape[2] != 4 or coc_px.shape != rgba.shape[:2]:
            message = f"(H, W, 4) needs (H, W), got {rgba.shape} and {coc_px.shape}"
            raise InvalidInput(message, field="coc_px")
        if not np.isfinite(coc_px).all():
            raise InvalidInput("must be finite", field="coc_px")
        height, width = coc_px.shape
        return LensPoints(
            (height, width),
            np.arange(height * width),
            np.ascontiguousarray(coc_px, np.float32).reshape(-1),
            np.ascontiguousarray(rgba, np.float32).reshape(-1, 4),
            np.ones(height * width, np.float32),
        )

    def behind(self, hidden: "LensPoints") -> "LensPoints":
        """Return these points with others behind those of the same pixel."""
        count = len(self.pixel) + len(hidden.pixel)
        both = Columns(
            np.empty(count, np.int64),
            np.empty(count, np.float32),
            np.empty((count, 4), np.float32),
            np.empty(count, np.float32),
        )
        merge_by_pixel(self._columns(), hidden._columns(), both)
        return LensPoints(self.shape, *both)

    def _columns(self) -> Columns:
        return Columns(
            np.ascontiguousarray(self.pixel),
            np.ascontiguousarray(self.coc_px),
            np.ascontiguousarray(self.rgba),
            np.ascontiguousarray(self.cover),
        )
