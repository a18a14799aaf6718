"""SSIM: how much of a picture's structure another one has.

Wang, Bovik, Sheikh and Simoncelli 2004, "Image Quality Assessment: From Error Visibility to
Structural Similarity", with the constants and the Gaussian window of its section III-C.
"""

from typing import Final

import numpy as np

from raysvc.errors import InvalidInput
from raysvc.types import Bytes, Doubles

LUMINANCE: Final = np.array([0.2126, 0.7152, 0.0722])
"""Of Rec.709."""
DEVIATION_PX: Final = 1.5
TAPS: Final = 11
LUMINANCE_CONSTANT: Final = (0.01 * 255) ** 2
CONTRAST_CONSTANT: Final = (0.03 * 255) ** 2


def ssim(picture: Bytes, reference: Bytes) -> float:
    """Mean SSIM of luminance of two pictures (H, W, 3) uint8 as displayed; 1 is alike.

    Windows that do not lie wholly within the picture are left out. Raises InvalidInput for
    pictures of different shapes, or smaller than a window.
    """
    if picture.shape != reference.shape or picture.ndim != 3 or picture.shape[2] != 3:
        raise InvalidInput(f"cannot compare {picture.shape} and {reference.shape}", "pictures")
    if min(picture.shape[:2]) < TAPS:
        raise InvalidInput(f"must be at least {TAPS} pixels wide and high", "pictures")
    a, b = (each.astype(np.float64) @ LUMINANCE for each in (picture, reference))
    mean_a, mean_b = _blurred(a), _blurred(b)
    both, one, other = mean_a * mean_b, mean_a**2, mean_b**2
    covariance = _blurred(a * b) - both
    variances = _blurred(a * a) - one + _blurred(b * b) - other
    alike = (2 * both + LUMINANCE_CONSTANT) * (2 * covariance + CONTRAST_CONSTANT)
    norm = (one + other + LUMINANCE_CONSTANT) * (variances + CONTRAST_CONSTANT)
    return float((alike / norm).mean())


def _blurred(values: Doubles) -> Doubles:
    """(H - 10, W - 10) means over the Gaussian window, of (H, W)."""
    offset = np.arange(TAPS) - TAPS // 2
    weights = np.exp(-0.5 * (offset / DEVIATION_PX) ** 2)
    weights /= weights.sum()
    for _ in range(2):
        rows = len(values) - TAPS + 1
        values = sum(
            (weight * values[k : k + rows] for k, weight in enumerate(weights)),
            start=np.zeros((rows, values.shape[1])),
        ).T
    return values
