"""Box sums texel by texel."""

import numpy as np


def box_sum(image, top, left, bottom, right):
    """Sum of image (H, W, C) over a box; a texel counts by the part of its area that is inside."""
    height, width, channels = image.shape
    total = np.zeros(channels)
    for row in range(height):
        for column in range(width):
            tall = max(min(bottom, row + 1) - max(top, row), 0.0)
            wide = max(min(right, column + 1) - max(left, column), 0.0)
            total += image[row, column].astype(np.float64) * tall * wide
    return total
