"""Where samples lie: evenly, apart, and about the centre."""

import numpy as np
import pytest

from raysvc.raster.pixel_samples import sample_offsets

EVERY_COUNT = range(1, 65)


@pytest.mark.parametrize("count", EVERY_COUNT)
def test_every_row_and_column_of_the_grid_holds_one_sample(count: int) -> None:
    cells = (sample_offsets(count) + 0.5) * count - 0.5
    np.testing.assert_allclose(np.sort(cells[:, 0]), np.arange(count), atol=1e-9)
    np.testing.assert_allclose(np.sort(cells[:, 1]), np.arange(count), atol=1e-9)


@pytest.mark.parametrize("count", EVERY_COUNT)
def test_the_mean_of_the_samples_is_the_centre(count: int) -> None:
    np.testing.assert_allclose(sample_offsets(count).mean(axis=0), 0.0, atol=1e-9)


@pytest.mark.parametrize("count", EVERY_COUNT[1:])
def test_samples_keep_apart(count: int) -> None:
    offsets = sample_offsets(count)
    apart = np.linalg.norm(offsets[:, None] - offsets[None], axis=-1) + np.eye(count)
    assert apart.min() > 0.75 / np.sqrt(count)


def test_a_half_plane_covers_as_many_samples_as_its_area_says() -> None:
    offsets = sample_offsets(16)
    rng = np.random.default_rng(5)
    axis = (np.arange(200) + 0.5) / 200 - 0.5
    grid = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    errors = []
    for angle, at in zip(rng.uniform(0, np.pi, 200), rng.uniform(-0.5, 0.5, 200), strict=True):
        across = np.array([np.cos(angle), np.sin(angle)])
        errors.append((offsets @ across < at).mean() - (grid @ across < at).mean())
    # Independent random samples are off by 0.1 in the root mean square.
    assert np.sqrt(np.mean(np.square(errors))) < 0.035
    assert np.max(np.abs(errors)) < 2 / 16


def test_one_sample_is_the_centre() -> None:
    assert sample_offsets(1).tolist() == [[0.0, 0.0]]
