"""The sRGB transfer curve (IEC 61966-2-1), between display-linear 0..1 and encoded 0..1."""

import numpy as np

from raysvc.types import Floats


def srgb_from_linear(linear: Floats) -> Floats:
    """Encode: any shape float32, 0..1 linear to 0..1 sRGB."""
    curved = np.float32(1.055) * np.power(linear, np.float32(1 / 2.4)) - np.float32(0.055)
    return np.where(linear <= np.float32(0.0031308), np.float32(12.92) * linear, curved)


def linear_from_srgb(encoded: Floats) -> Floats:
    """Decode: any shape float32, 0..1 sRGB to 0..1 linear."""
    curved = np.power((encoded + np.float32(0.055)) / np.float32(1.055), np.float32(2.4))
    return np.where(encoded <= np.float32(0.04045), encoded / np.float32(12.92), curved)
