"""Round filters of maps: closed forms, conservation, and sums over all texels."""

import numpy as np
import pytest

from raysvc.lighting.area_resampling import resampled
from raysvc.lighting.zonal import ZonalMap, legendre_rows, zonal_coefficients
from tests.oracles.lobe import map_directions


def waves(height, width):
    texels, _ = map_directions(height, width)
    x, y, z = texels.T
    grey = 0.6 + 0.3 * y + np.sin(5 * x) * np.cos(4 * z) ** 2
    return np.stack([grey, 2 + x, z * z], 1).reshape(height, width, 3)


def test_legendre_functions_are_orthonormal():
    rows = legendre_rows(12, 2000)
    sine = np.sin((np.arange(2000) + 0.5) * np.pi / 2000) * np.pi / 2000 * 2 * np.pi
    for functions in rows:
        np.testing.assert_allclose(
            (functions * sine) @ functions.T, np.eye(len(functions)), atol=1e-4
        )


def test_a_kernel_that_does_nothing_leaves_a_smooth_map():
    radiance = waves(256, 512)
    same = ZonalMap.of(radiance, 31).filtered(np.ones(32)[None], 256, 512)[0]
    np.testing.assert_allclose(same, radiance, atol=2e-3)


def test_other_sizes_show_the_same_map():
    coarse = ZonalMap.of(waves(256, 512), 20).filtered(np.ones(21)[None], 50, 90)[0]
    np.testing.assert_allclose(coarse, waves(50, 90), atol=0.01)


def test_the_cosine_lobe_has_the_known_coefficients():
    # Ramamoorthi and Hanrahan 2001, equation 8, over pi
    lobe = zonal_coefficients(lambda c: np.maximum(c, 0.0), 6)
    np.testing.assert_allclose(lobe, [1, 2 / 3, 1 / 4, 0, -1 / 24, 0, 1 / 64], atol=1e-6)


@pytest.mark.parametrize("sharpness", [3.0, 40.0, 3000.0])
def test_coefficients_of_von_mises_and_fishers_lobe(sharpness):
    lobe = zonal_coefficients(lambda c: np.exp(sharpness * (c - 1)), 2)
    mean = 1 / np.tanh(sharpness) - 1 / sharpness
    np.testing.assert_allclose(lobe, [1, mean, 1 - 3 * mean / sharpness], rtol=1e-6)


@pytest.mark.parametrize("exponent", [2, 20, 200])
def test_filtering_is_the_sum_over_all_texels(exponent, rng):
    radiance = rng.random((64, 128, 3)) ** 8
    fine = radiance.repeat(4, axis=0).repeat(4, axis=1)
    texels, angles = map_directions(256, 512)
    lobe = zonal_coefficients(lambda c: np.maximum(c, 0.0) ** exponent, 63)
    got = ZonalMap.of(fine, 63).filtered(lobe[None], 64, 128)[0]
    places, _ = map_directions(64, 128)
    weights = np.maximum(places @ texels.T, 0.0) ** exponent * angles
    expected = weights @ fine.reshape(-1, 3) / weights.sum(axis=1, keepdims=True)
    np.testing.assert_allclose(got.reshape(-1, 3), expected, rtol=0.01)


def test_constant_maps_stay_constant_to_the_last_digits():
    lobe = zonal_coefficients(lambda c: np.exp(9 * c), 40)
    same = ZonalMap.of(np.full((100, 200, 3), 0.7), 40).filtered(lobe[None], 30, 60)[0]
    np.testing.assert_allclose(same, 0.7, rtol=1e-12)


@pytest.mark.parametrize(
    ("shape", "rows"), [((4, 8), 64), ((100, 200), 64), ((512, 1024), 128), ((130, 7), 64)]
)
def test_resampling_keeps_the_light_of_every_direction(shape, rows, rng):
    radiance = rng.random((*shape, 3)).astype(np.float32)
    finer = resampled(radiance, rows, 2 * rows)
    assert rows // 2 <= len(finer)
    for map_ in (radiance.astype(float), finer):
        texels, angles = map_directions(*map_.shape[:2])
        light = np.concatenate([angles[:, None], angles[:, None] * texels], 1).T
        total = light @ map_.reshape(-1, 3)
        if map_ is not finer:
            expected = total
    np.testing.assert_allclose(total[0], expected[0], rtol=1e-6)
    np.testing.assert_allclose(total[1:], expected[1:], atol=0.02 * expected[0].max())
