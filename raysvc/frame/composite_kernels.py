"""Put the points of each pixel over one another."""

from raysvc.jit import kernel
from raysvc.types import Floats, Longs


@kernel
def over(pixel: Longs, radiance: Floats, alpha: Floats, rgba: Floats) -> None:
    """Add N points, front to back within a pixel, to premultiplied rgba (P, 4).

    Porter and Duff 1984, "Compositing Digital Images". `pixel` (N,) are rows of rgba.
    """
    for n in range(len(pixel)):
        p = pixel[n]
        weight = (1.0 - rgba[p, 3]) * alpha[n]
        for k in range(3):
            rgba[p, k] += weight * radiance[n, k]
        rgba[p, 3] += weight
