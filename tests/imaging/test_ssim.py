"""SSIM against its definition, window by window."""

import numpy as np
import pytest

from raysvc.errors import InvalidInput
from raysvc.imaging.ssim import LUMINANCE, ssim


def slow(a, b):
    """Every 11 x 11 window by itself, with numpy's weighted moments."""
    offset = np.arange(11) - 5
    weight = np.exp(-(offset[:, None] ** 2 + offset**2) / (2 * 1.5**2))
    weight /= weight.sum()
    a, b = a.astype(float) @ LUMINANCE, b.astype(float) @ LUMINANCE
    found = []
    for y in range(a.shape[0] - 10):
        for x in range(a.shape[1] - 10):
            p, q = a[y : y + 11, x : x + 11], b[y : y + 11, x : x + 11]
            mp, mq = (weight * p).sum(), (weight * q).sum()
            vp, vq = (weight * (p - mp) ** 2).sum(), (weight * (q - mq) ** 2).sum()
            cov = (weight * (p - mp) * (q - mq)).sum()
            c1, c2 = (0.01 * 255) ** 2, (0.03 * 255) ** 2
            top = (2 * mp * mq + c1) * (2 * cov + c2)
            found.append(top / ((mp**2 + mq**2 + c1) * (vp + vq + c2)))
    return np.mean(found)


def pictures(rng):
    a = rng.integers(0, 256, (24, 31, 3)).astype(np.uint8)
    noise = rng.integers(-30, 30, a.shape)
    return a, np.clip(a.astype(int) + noise, 0, 255).astype(np.uint8)


def test_it_is_what_its_definition_says(rng):
    a, b = pictures(rng)
    assert ssim(a, b) == pytest.approx(slow(a, b), rel=1e-9)
    assert 0.3 < ssim(a, b) < 0.99


def test_a_picture_is_alike_itself_and_unlike_its_negative(rng):
    a, _ = pictures(rng)
    assert ssim(a, a) == pytest.approx(1.0, abs=1e-12)
    assert ssim(a, 255 - a) < 0


@pytest.mark.parametrize("shape", [(24, 30, 3), (24, 31), (10, 31, 3)])
def test_other_shapes_are_refused(rng, shape):
    a, _ = pictures(rng)
    with pytest.raises(InvalidInput, match="pictures"):
        ssim(a, np.zeros(shape, np.uint8))


def test_pictures_smaller_than_a_window_are_refused():
    with pytest.raises(InvalidInput, match="at least 11"):
        ssim(np.zeros((10, 40, 3), np.uint8), np.zeros((10, 40, 3), np.uint8))
