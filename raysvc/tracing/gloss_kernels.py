"""What rough surfaces reflect: the mean of the rays of the pixels about each."""

import math

from raysvc.jit import kernel
from raysvc.types import Floats, Longs

REACH = 4
"""Pixels to each side from which light is taken."""
SAME_NORMAL = 0.9
"""Cosine between normals of pixels that are taken to be one surface."""
SAME_ROUGHNESS = 0.1
"""Difference in roughness of pixels that are taken to be one surface."""
LEAST_WEIGHT = 1e-2
LEAST_SIGMA_PX = 0.45
"""Of rough surfaces: a ray in the tail of its lobe, which counts little, is then not all that its
pixel has. A mirror's ray is."""


@kernel
def gather_gloss(
    radiance: Floats,
    share: Floats,
    weight: Floats,
    spread_px: Floats,
    roughness: Floats,
    depth: Floats,
    normal: Floats,
    depth_step: Floats,
    pixel: Longs,
    point_depth: Floats,
    point_normal: Floats,
    point_roughness: Floats,
    gathered: Floats,
) -> None:
    """Fill gathered (N, 4): RGB that N points' lobes reflect of the scene, and what share meets it.

    The first eight are pictures (H, W, ...): each pixel's ray brought `radiance` from a `share` of
    its lobe, and counts `weight`; its light is spread over `spread_px` (standard deviation of a
    Gaussian), as far as neighbours show the same surface. Pixels with share < 0 know nothing. The
    share of a point that nothing reaches is -1.
    """
    height, width = share.shape
    for n in range(len(pixel)):
        row, col = pixel[n] // width, pixel[n] % width
        red, green, blue, met, total = 0.0, 0.0, 0.0, 0.0, 0.0
        for y in range(max(row - REACH, 0), min(row + REACH + 1, height)):
            for x in range(max(col - REACH, 0), min(col + REACH + 1, width)):
                if share[y, x] < 0.0:
                    continue
                apart2 = float((x - col) * (x - col) + (y - row) * (y - row))
                sigma = max(spread_px[y, x], LEAST_SIGMA_PX)
                if spread_px[y, x] == 0.0 and apart2 > 0.0:
                    continue
                near = math.exp(-0.5 * apart2 / (sigma * sigma))
                if near < LEAST_WEIGHT:
                    continue
                same = (
                    point_normal[n, 0] * normal[y, x, 0]
                    + point_normal[n, 1] * normal[y, x, 1]
                    + point_normal[n, 2] * normal[y, x, 2]
                ) > SAME_NORMAL
                same = same and abs(point_roughness[n] - roughness[y, x]) < SAME_ROUGHNESS
                far = abs(row - y) + abs(col - x) + 1
                if same and abs(depth[y, x] - point_depth[n]) <= depth_step[y, x] * far:
                    counts = near * weight[y, x]
                    total += counts
                    met += counts * share[y, x]
                    red += counts * share[y, x] * radiance[y, x, 0]
                    green += counts * share[y, x] * radiance[y, x, 1]
                    blue += counts * share[y, x] * radiance[y, x, 2]
        gathered[n, 3] = met / total if total > 0.0 else -1.0
        scale = 1.0 / met if met > 0.0 else 0.0
        gathered[n, 0] = red * scale
        gathered[n, 1] = green * scale
        gathered[n, 2] = blue * scale
