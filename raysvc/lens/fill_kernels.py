"""Kernels of filling holes by push and pull over a pyramid (Gortler et al. 1996, section 4)."""

from raysvc.jit import kernel
from raysvc.types import Floats


@kernel
def push(colour: Floats, known: Floats, coarse_colour: Floats, coarse_known: Floats) -> None:
    """Halve: (H, W, C) and (H, W) float32 to half the size, rounded up, averaging what is known."""
    height, width, channels = colour.shape
    coarse_height, coarse_width = coarse_known.shape
    for y in range(coarse_height):
        for x in range(coarse_width):
            total = 0.0
            for c in range(channels):
                coarse_colour[y, x, c] = 0.0
            for j in range(2 * y, min(2 * y + 2, height)):
                for i in range(2 * x, min(2 * x + 2, width)):
                    total += known[j, i]
                    for c in range(channels):
                        coarse_colour[y, x, c] += known[j, i] * colour[j, i, c]
            if total > 0.0:
                for c in range(channels):
                    coarse_colour[y, x, c] /= total
            coarse_known[y, x] = min(total, 1.0)


@kernel
def pull(coarse_colour: Floats, known: Floats, colour: Floats) -> None:
    """Complete colour (H, W, C) by what its coarser level, complete, shows there; bilinear."""
    height, width, channels = colour.shape
    last_row, last_col = coarse_colour.shape[0] - 1, coarse_colour.shape[1] - 1
    for y in range(height):
        # A pixel's centre lies a quarter of a coarse pixel off the nearest coarse centre.
        near_row = y >> 1
        far_row = min(max(near_row + (1 if y & 1 else -1), 0), last_row)
        for x in range(width):
            missing = 1.0 - known[y, x]
            if missing <= 0.0:
                continue
            near_col = x >> 1
            far_col = min(max(near_col + (1 if x & 1 else -1), 0), last_col)
            for c in range(channels):
                near = (
                    0.75 * coarse_colour[near_row, near_col, c]
                    + 0.25 * coarse_colour[near_row, far_col, c]
                )
                far = (
                    0.75 * coarse_colour[far_row, near_col, c]
                    + 0.25 * coarse_colour[far_row, far_col, c]
                )
                colour[y, x, c] = known[y, x] * colour[y, x, c] + missing * (
                    0.75 * near + 0.25 * far
                )
