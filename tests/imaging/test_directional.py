"""The directionally adaptive filter: edges of known slope, what must not change, contrast."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from raysvc.imaging.directional_kernels import chord, contrasts, smooth_along_edges


def half_plane(angle_rad: float, size: int = 24, samples: int = 1) -> np.ndarray:
    """(size, size, 4) white on one side of a line through the middle, black on the other."""
    at = (np.arange(size * samples) + 0.5) / samples - 0.5 * size - 0.13
    x, y = np.meshgrid(at, at)
    white = (x * np.cos(angle_rad) + y * np.sin(angle_rad) > 0).astype(np.float32)
    white = white.reshape(size, samples, size, samples).mean(axis=(1, 3))
    picture = np.ones((size, size, 4), np.float32)
    picture[..., :3] = white[..., None]
    return np.ascontiguousarray(picture, np.float32)


def smoothed(picture: np.ndarray, mask: np.ndarray | None = None) -> np.ndarray:
    result = np.empty_like(picture)
    smooth_along_edges(picture, np.ones(picture.shape[:2], bool) if mask is None else mask, result)
    return result


@pytest.mark.parametrize("angle_deg", [20.0, 30.0, 60.0, 110.0, 160.0])
def test_a_slanted_edge_comes_nearer_to_its_coverage(angle_deg: float) -> None:
    angle = np.radians(angle_deg)
    jagged, truth = half_plane(angle), half_plane(angle, samples=16)
    inner = (slice(3, -3), slice(3, -3))
    before = np.abs(jagged - truth)[inner].mean()
    after = np.abs(smoothed(jagged) - truth)[inner].mean()
    assert after < 0.9 * before


def test_edges_along_the_axes_stay_sharp() -> None:
    for angle in (0.0, np.pi / 2):
        picture = half_plane(angle)
        assert smoothed(picture) == pytest.approx(picture, abs=1e-6)


def test_flat_places_noise_and_what_is_not_masked_stay(rng) -> None:
    flat = np.full((8, 8, 4), 0.4, np.float32)
    assert (smoothed(flat) == flat).all()
    edge = half_plane(0.5)
    assert (smoothed(edge, np.zeros(edge.shape[:2], bool)) == edge).all()
    dots = np.zeros((9, 9, 4), np.float32)
    dots[..., 3] = 1.0
    dots[4, 4, :3] = 1.0
    assert smoothed(dots)[4, 4] == pytest.approx(dots[4, 4])


def test_a_highlight_does_not_outshine_the_mean() -> None:
    """The same edge, to a thousand times brighter light: compressed, not far from that of 1."""
    bright = half_plane(0.5)
    bright[..., :3] *= 1000.0
    shown = smoothed(bright)[..., 0]
    compressed = shown / (1 + shown)
    between = (compressed > 0.2) & (compressed < 0.8)
    assert between.sum() > 4
    assert np.isfinite(shown).all() and shown.max() <= 1000.5


@given(st.floats(-1.0, 1.0), st.floats(0.0, 2 * np.pi))
def test_chords_are_the_lines_of_a_square(offset: float, angle: float) -> None:
    across, along = np.cos(angle), np.sin(angle)
    t = np.linspace(-1.0, 1.0, 4001)
    x, y = offset * across - t * along, offset * along + t * across
    inside = (np.abs(x) <= 0.5) & (np.abs(y) <= 0.5)
    assert chord(offset, across, along) == pytest.approx(inside.mean() * 2.0, abs=0.01)


def test_contrast_is_the_greatest_difference_to_a_neighbour() -> None:
    picture = np.zeros((3, 4, 4), np.float32)
    picture[..., 3] = 1.0
    picture[1, 0, 1] = 0.5
    contrast = np.empty((3, 4), np.float32)
    contrasts(picture, contrast)
    scale = 1 / (1 + 0.7152 * 0.5)
    assert contrast[:, :2] == pytest.approx(0.5 * scale)
    assert (contrast[:, 2:] == 0).all()
