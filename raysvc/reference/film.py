"""Sums of what paths bring to pixels."""

import numpy as np

from raysvc.types import Floats


class Film:
    """Mean of the samples of P pixels, in double precision.

    Samples arrive in passes; after any of them the mean is that of the samples so far. Threads may
    add to different pixels at a time.
    """

    def __init__(self, pixels: int) -> None:
        self._sum = np.zeros((pixels, 4))
        self._samples = np.zeros(pixels, np.int64)

    def add(self, begin: int, end: int, rgba: Floats) -> None:
        """Add the same number of samples to pixels begin..end: rgba (end - begin, samples, 4)."""
        self._sum[begin:end] += rgba.sum(axis=1, dtype=np.float64)
        self._samples[begin:end] += rgba.shape[1]

    def mean(self) -> Floats:
        """(P, 4) float32; every pixel must have a sample."""
        mean: Floats = (self._sum / self._samples[:, None]).astype(np.float32)
        return mean
