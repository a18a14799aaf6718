"""The mean of a periodic image under a B-spline, texel by texel."""

import math


def reach(order, z):
    """Integral from minus infinity to z of the centred B-spline of unit boxes, by its pieces."""
    if order == 1:
        return min(max(z + 0.5, 0.0), 1.0)
    if z > 0.0:
        return 1.0 - reach(order, -z)
    if order == 2:
        return 0.5 * max(z + 1.0, 0.0) ** 2
    assert order == 3
    if z < -1.5:
        return 0.0
    if z < -0.5:
        return (z + 1.5) ** 3 / 6.0
    return 1.0 / 6.0 + (0.75 * z - z**3 / 3.0) - (0.75 * -0.5 + 0.125 / 3.0)


def weights(length, order, centre, half):
    """Weight of every texel along one axis; those of all the copies of a texel together."""
    wide = 2.0 * half
    found = [0.0] * length
    first = math.floor(centre - order * half) - 1
    last = math.ceil(centre + order * half) + 1
    for texel in range(first, last):
        left, right = (texel - centre) / wide, (texel + 1 - centre) / wide
        found[texel % length] += reach(order, right) - reach(order, left)
    return found


def spline_mean(image, order, row, column, half_rows, half_columns):
    """Mean (C,) of image (H, W, C)."""
    down = weights(image.shape[0], order, row, half_rows)
    across = weights(image.shape[1], order, column, half_columns)
    total = 0.0
    for i, weight in enumerate(down):
        for j, other in enumerate(across):
            total = total + weight * other * image[i, j]
    return total
