"""Depth of field by averaging about each pixel: quick to write, known for its faults.

Every pixel becomes the mean of a square as large as its own blur, read from a summed-area table
(Hensley et al. 2005, "Fast Summed-Area Table Generation and its Applications"). Where all blurs are
alike that is what spreading gives. Elsewhere it is not: what is sharp in front bleeds into the
blurred background beside it, and a blurred foreground ends at its silhouette as if it were cut out.
"""

import numpy as np

from raysvc.imaging.sat import box_sums, summed_area_table
from raysvc.lens.box_kernels import half_side_px
from raysvc.lens.points import LensPoints
from raysvc.lens.slices import SHARP_PX
from raysvc.parallel import Control, for_chunks
from raysvc.types import Doubles, Floats

ROWS = 16


def gather(rgba: Floats, coc_px: Floats, control: Control | None = None) -> Floats:
    """Blur a picture, (H, W, 4) float32 premultiplied, by circles of confusion (H, W) float32.

    Squares have the variance of the discs. Beyond its border the picture is mirrored. Pixels in
    focus keep their bits. Raises InvalidInput as `spread` does.
    """
    control = control or Control()
    points = LensPoints.of_picture(rgba, coc_px)
    height, width = points.shape
    blurred = np.abs(points.coc_px) >= SHARP_PX
    picture = points.rgba.copy()
    table = summed_area_table(np.ascontiguousarray(rgba, np.float32))
    largest = float(min(points.shape))

    def work(first: int, last: int) -> None:
        pixel = first * width + np.flatnonzero(blurred[first * width : last * width])
        half = np.minimum(half_side_px(points.coc_px[pixel]), largest)
        y, x = np.divmod(pixel, width)
        total = np.zeros((len(pixel), 4))
        for i in range(3):
            top, bottom = _piece(y + 0.5 - half, y + 0.5 + half, height, i)
            for j in range(3):
                left, right = _piece(x + 0.5 - half, x + 0.5 + half, width, j)
                some = np.flatnonzero((top < bottom) & (left < right))
                boxes = np.stack([top[some], left[some], bottom[some], right[some]], axis=1)
                total[some] += box_sums(table, boxes)
        picture[pixel] = total / (4.0 * half * half)[:, None]

    for_chunks(height, ROWS, work, control)
    return picture.reshape(height, width, 4)


def _piece(begin: Doubles, end: Doubles, size: int, which: int) -> tuple[Doubles, Doubles]:
    """Part of [begin, end) within 0..size: 0 directly, 1 mirrored at 0, 2 mirrored at size."""
    if which == 0:
        return np.maximum(begin, 0.0), np.minimum(end, size)
    if which == 1:
        return np.zeros_like(begin), -begin
    return 2.0 * size - end, np.full_like(end, size)
