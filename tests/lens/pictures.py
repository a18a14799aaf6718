"""Pictures and blurs that the tests of the lens spread."""

import numpy as np


def random_picture(rng, height=24, width=33, opaque=True):
    rgba = (rng.random((height, width, 4)) ** 6 * 50).astype(np.float32)
    rgba[..., 3] = 1 if opaque else rng.random((height, width))
    return rgba


def random_coc(rng, height=24, width=33, largest=20.0):
    return rng.uniform(-largest, largest, (height, width)).astype(np.float32)


def highlight(height=81, width=81, value=1.0):
    """One bright pixel in the middle of black."""
    rgba = np.zeros((height, width, 4), np.float32)
    rgba[..., 3] = 1
    rgba[height // 2, width // 2, :3] = value
    return rgba


def even(rgba, diameter):
    """One diameter for the whole picture."""
    return np.full(rgba.shape[:2], diameter, np.float32)
