"""Where the samples of a pixel lie."""

import math

import numpy as np

from raysvc.types import Doubles

GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0


def sample_offsets(count: int) -> Doubles:
    """(count, 2) places in a pixel, from its centre, in pixels to the right and down.

    Of a grid of count x count cells each column holds one sample and each row (Shirley 1991,
    "Discrepancy as a Quality Measure for Sample Distributions"): an edge that is almost upright or
    level passes them one by one, and their mean is the centre, so that sampling does not move the
    picture. From column to column the row goes by the golden ratio (Schretter et al. 2012, "Golden
    Ratio Sequences for Low-Discrepancy Sampling"), which keeps samples apart.
    """
    column = np.arange(count)
    row = np.argsort(np.argsort((column + 1) * GOLDEN % 1.0))
    offsets: Doubles = (np.stack([column, row], axis=1) + 0.5) / count - 0.5
    return offsets
