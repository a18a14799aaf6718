"""The directionally adaptive filter: edges of known slope, with samples and without, and what must
not change."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from raysvc.imaging.directional_kernels import chord, compress, smooth_along_edges
from raysvc.raster.pixel_samples import sample_offsets

OFFSETS = sample_offsets(8)


def half_plane(angle_rad: float, size: int = 24, samples: int = 1) -> np.ndarray:
    """(size, size, 4) white on one side of a line through the middle, black on the other."""
    at = (np.arange(size * samples) + 0.5) / samples - 0.5 * size - 0.13
    x, y = np.meshgrid(at, at)
    white = (x * np.cos(angle_rad) + y * np.sin(angle_rad) > 0).astype(np.float32)
    white = white.reshape(size, samples, size, samples).mean(axis=(1, 3))
    picture = np.ones((size, size, 4), np.float32)
    picture[..., :3] = white[..., None]
    return np.ascontiguousarray(picture, np.float32)


def half_plane_samples(angle_rad: float, size: int = 24) -> np.ndarray:
    """(size * size, 8, 4) what OFFSETS show of the same picture."""
    at = np.arange(size) + 0.5 - 0.5 * size - 0.13
    y, x = np.meshgrid(at, at, indexing="ij")
    x = x.reshape(-1, 1) + OFFSETS[:, 0]
    y = y.reshape(-1, 1) + OFFSETS[:, 1]
    samples = np.ones((*x.shape, 4), np.float32)
    samples[..., :3] = (x * np.cos(angle_rad) + y * np.sin(angle_rad) > 0)[..., None]
    return samples


def smoothed(picture: np.ndarray, samples: np.ndarray | None = None) -> np.ndarray:
    """A picture, all of whose pixels have samples or none of them have."""
    shape = picture.shape[:2]
    pixel = np.arange(shape[0] * shape[1])
    slot = np.full(shape, -1, np.int32)
    if samples is None:
        samples = np.empty((0, len(OFFSETS), 4), np.float32)
    else:
        slot[:] = pixel.reshape(shape)
        samples = samples.copy()
        compress(samples.reshape(-1, 4), False)
    compressed, result = picture.copy(), np.empty((len(pixel), 4), np.float32)
    compress(compressed.reshape(-1, 4), False)
    smooth_along_edges(compressed, slot, samples, OFFSETS, pixel, result)
    compress(result, True)
    return result.reshape(picture.shape)


@pytest.mark.parametrize("angle_deg", [20.0, 30.0, 60.0, 110.0, 160.0])
def test_a_slanted_edge_comes_nearer_to_its_coverage(angle_deg: float) -> None:
    angle = np.radians(angle_deg)
    jagged, truth = half_plane(angle), half_plane(angle, samples=16)
    inner = (slice(3, -3), slice(3, -3))
    before = np.abs(jagged - truth)[inner].mean()
    after = np.abs(smoothed(jagged) - truth)[inner].mean()
    assert after < 0.9 * before


@pytest.mark.parametrize("angle_deg", [3.0, 20.0, 45.0, 110.0, 160.0])
def test_with_samples_a_slanted_edge_comes_nearer_than_their_mean(angle_deg: float) -> None:
    angle = np.radians(angle_deg)
    truth, samples = half_plane(angle, samples=16), half_plane_samples(angle)
    inner = (slice(3, -3), slice(3, -3))
    # Means of compressed light are darker than those of light: both are compared compressed
    plain = samples.reshape(*truth.shape[:2], -1, 4)[..., 0] * 0.5
    mean = plain.mean(axis=2) / (1.0 - plain.mean(axis=2))
    coverage = truth[..., 0] * 0.5 / (1.0 - truth[..., 0] * 0.5)
    filtered = smoothed(half_plane(angle), samples)[..., 0]
    assert np.square(filtered - coverage)[inner].mean() < np.square(mean - coverage)[inner].mean()


def test_edges_along_the_axes_stay_sharp() -> None:
    for angle in (0.0, np.pi / 2):
        picture = half_plane(angle)
        assert smoothed(picture) == pytest.approx(picture, abs=1e-6)


def test_flat_places_and_noise_stay() -> None:
    flat = np.full((8, 8, 4), 0.4, np.float32)
    assert smoothed(flat) == pytest.approx(flat, abs=1e-6)
    dots = np.zeros((9, 9, 4), np.float32)
    dots[..., 3] = 1.0
    dots[4, 4, :3] = 1.0
    assert smoothed(dots)[4, 4] == pytest.approx(dots[4, 4])


def test_where_there_is_no_one_direction_a_pixel_shows_its_own_samples(rng) -> None:
    noise = rng.random((25, 8, 4), dtype=np.float32)
    noise[..., 3] = 1.0
    shown = smoothed(noise[:, 0].reshape(5, 5, 4), noise)[2, 2]
    mean = noise[12].copy()
    compress(mean, False)
    mean = mean.mean(axis=0, keepdims=True)
    compress(mean, True)
    assert shown == pytest.approx(mean[0], rel=1e-5)


def test_a_highlight_does_not_outshine_the_mean() -> None:
    """The same edge, to a thousand times brighter light: compressed, not far from that of 1."""
    bright = half_plane(0.5)
    bright[..., :3] *= 1000.0
    shown = smoothed(bright)[..., 0]
    compressed = shown / (1 + shown)
    between = (compressed > 0.2) & (compressed < 0.8)
    assert between.sum() > 4
    assert np.isfinite(shown).all() and shown.max() <= 1001.0


@given(st.floats(-1.0, 1.0), st.floats(0.0, 2 * np.pi))
def test_chords_are_the_lines_of_a_square(offset: float, angle: float) -> None:
    across, along = np.cos(angle), np.sin(angle)
    assume(abs(abs(offset) - 0.5 * (abs(across) + abs(along))) > 1e-6)  # along a side
    t = np.linspace(-1.0, 1.0, 4001)
    x, y = offset * across - t * along, offset * along + t * across
    inside = (np.abs(x) <= 0.5) & (np.abs(y) <= 0.5)
    assert chord(offset, across, along) == pytest.approx(inside.mean() * 2.0, abs=0.01)
