"""Summed-area tables: the mean of any box of an image for the cost of four reads (Crow 1984)."""

import numpy as np

from raysvc.imaging.sat_kernels import accumulate, sum_boxes
from raysvc.types import Doubles, Floats


def summed_area_table(image: Floats | Doubles) -> Doubles:
    """Sums of everything above and left of every texel's corner.

    Parameters
    ----------
    image
        (H, W, C) float32 or float64

    Returns
    -------
    (H+1, W+1, C) float64; entry (i, j) sums rows 0..i and columns 0..j exclusive, so that row 0
    and column 0 are zero and no box needs a special case at an edge
    """
    height, width, channels = image.shape
    table = np.zeros((height + 1, width + 1, channels))
    accumulate(image, table)
    return table


def box_sums(table: Doubles, boxes: Doubles) -> Doubles:
    """Sums of an image over boxes with fractional edges.

    Parameters
    ----------
    table
        (H+1, W+1, C) as `summed_area_table` returns it
    boxes
        (N, 4) top, left, bottom, right in texels from the image's corner; what lies outside the
        image is zero

    Returns
    -------
    (N, C) float64, exact for an image of constant texels
    """
    sums = np.empty((len(boxes), table.shape[2]))
    sum_boxes(table, np.ascontiguousarray(boxes, np.float64), sums)
    return sums
