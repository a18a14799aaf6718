"""Background where a blurred foreground hides it: carried in from around the hole."""

import numpy as np

from raysvc.lens.fill_kernels import pull, push
from raysvc.types import Floats


def fill_holes(picture: Floats, known: Floats) -> bool:
    """Fill a picture (H, W, C) in place where `known` (H, W), 0..1, is less than one; all float32.

    What is fully known keeps its bits. Returns False, and changes nothing, if nothing is known.
    """
    if not known.any():
        return False
    levels = [(picture, known)]
    while max(levels[-1][1].shape) > 1:
        colour, weight = levels[-1]
        size = tuple((extent + 1) // 2 for extent in weight.shape)
        coarse = np.empty((*size, picture.shape[2]), np.float32), np.empty(size, np.float32)
        push(colour, weight, *coarse)
        levels.append(coarse)
    for (colour, weight), (coarse_colour, _) in zip(levels[-2::-1], levels[:0:-1], strict=True):
        pull(coarse_colour, weight, colour)
    return True
