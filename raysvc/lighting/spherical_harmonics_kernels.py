"""The only loop over all texels that harmonics need."""

from raysvc.jit import kernel
from raysvc.types import Doubles, Floats


@kernel
def row_waves(radiance: Floats, columns: Doubles, waves: Doubles) -> None:
    """Add rows' sums of radiance (H, W, 3) x columns (W, K) to waves (H, 3, K)."""
    height, width, _ = radiance.shape
    count = columns.shape[1]
    for row in range(height):
        for column in range(width):
            red = float(radiance[row, column, 0])
            green = float(radiance[row, column, 1])
            blue = float(radiance[row, column, 2])
            for k in range(count):
                wave = columns[column, k]
                waves[row, 0, k] += red * wave
                waves[row, 1, k] += green * wave
                waves[row, 2, k] += blue * wave
