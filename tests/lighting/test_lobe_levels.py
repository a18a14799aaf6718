"""Levels of round lobes against sums over all texels, and their continuity."""

import numpy as np
import pytest

from raysvc.jit import kernel
from raysvc.lighting.area_resampling import resampled
from raysvc.lighting.ggx_lobes import from_above, ggx_lobes, roughest
from raysvc.lighting.image_kernels import COSINE, FINEST_ALPHA
from raysvc.lighting.lobe_level_kernels import lobe_radiance, round_lobe
from raysvc.lighting.lobe_levels import DEGREE, LobeLevels
from raysvc.lighting.phong_kernels import level_of_exponent
from raysvc.lighting.phong_lobes import phong_lobes
from raysvc.lighting.sphere_table import sphere_table
from raysvc.lighting.zonal import ZonalMap
from tests.lighting.surfaces import random_directions
from tests.oracles.lobe import map_directions


@kernel
def look(levels, directions, level, result):
    for i in range(len(directions)):
        r, g, b = lobe_radiance(
            levels[0],
            levels[1],
            levels[2],
            directions[i, 0],
            directions[i, 1],
            directions[i, 2],
            level[i],
        )
        result[i, 0], result[i, 1], result[i, 2] = r, g, b


@kernel
def look_narrow(sharp, levels, direction, level, narrowest, result):
    for i in range(len(level)):
        r, g, b = round_lobe(
            sharp,
            1,
            levels[0],
            levels[1],
            levels[2],
            direction[0],
            direction[1],
            direction[2],
            level[i],
            narrowest,
            0.0,
        )
        result[i, 0], result[i, 1], result[i, 2] = r, g, b


def under(levels, directions, level):
    result = np.empty((len(directions), 3))
    look(tuple(levels), 2.5 * directions, np.full(len(directions), float(level)), result)
    return result


@pytest.fixture(scope="module")
def spots():
    """A map of bright boxes on a dim sky."""
    rng = np.random.default_rng(4)
    radiance = np.full((128, 256, 3), 0.1, np.float32)
    for _ in range(12):
        row, column = rng.integers(0, 118), rng.integers(0, 240)
        radiance[row : row + 8, column : column + 12] += rng.uniform(1, 10, 3)
    return radiance


@pytest.fixture(scope="module")
def harmonics(spots):
    return ZonalMap.of(resampled(spots, 2 * DEGREE, 4 * DEGREE), DEGREE)


@pytest.mark.parametrize("level", [0, 2, 5, 8, COSINE, COSINE + 1, COSINE + 2])
def test_ggx_levels_are_sums_over_all_texels(spots, harmonics, level, rng):
    levels = LobeLevels.of(harmonics, ggx_lobes())
    fine = spots.repeat(4, axis=0).repeat(4, axis=1)
    texels, angles = map_directions(*fine.shape[:2])
    directions = random_directions(rng, 60)
    cosines = directions @ texels.T
    if level <= COSINE:
        weights = from_above(cosines, FINEST_ALPHA * 2 ** (level / 2)) * angles
    else:
        weights = roughest(cosines, {1: 0.5, 2: 0.12}[level - COSINE]) * angles
    expected = weights @ fine.reshape(-1, 3) / weights.sum(axis=1, keepdims=True)
    error = np.abs(under(levels, directions, level) / expected - 1)
    assert error.mean() < 0.012 and error.max() < 0.08


@pytest.mark.parametrize("exponent", [512.0, 64.0, 8.0, 1.0, 23.0, 9.5])
def test_phong_levels_are_sums_over_all_texels(spots, harmonics, exponent, rng):
    levels = LobeLevels.of(harmonics, phong_lobes())
    fine = spots.repeat(4, axis=0).repeat(4, axis=1)
    texels, angles = map_directions(*fine.shape[:2])
    directions = random_directions(rng, 60)
    weights = np.maximum(directions @ texels.T, 0) ** exponent * angles
    expected = weights @ fine.reshape(-1, 3) / weights.sum(axis=1, keepdims=True)
    error = np.abs(under(levels, directions, level_of_exponent(exponent)) / expected - 1)
    assert error.mean() < 0.03


def test_levels_keep_the_light_of_the_map(spots, harmonics):
    _, angles = map_directions(*spots.shape[:2])
    light = angles @ spots.reshape(-1, 3) / (4 * np.pi)
    places, angles = map_directions(200, 400)
    for family in (ggx_lobes(), phong_lobes()):
        levels = LobeLevels.of(harmonics, family)
        for level in range(0, len(family.sides), 3):
            mean = angles @ under(levels, places, level) / (4 * np.pi)
            np.testing.assert_allclose(mean, light, rtol=4e-3)


def test_lookups_are_continuous_across_folds_seams_and_levels(harmonics, spots):
    levels, sharp = LobeLevels.of(harmonics, ggx_lobes()), sphere_table(spots).tables
    step = 1e-4
    turn = np.arange(0, 2 * np.pi, step)
    across = np.stack([np.sin(turn), 0.02 * np.cos(turn), np.cos(turn)], 1)
    over = np.stack([0.01 + 0 * turn, np.cos(turn), np.sin(turn)], 1)
    for path in (across, over):
        for level in (0.0, 3.5, 8.0):
            assert np.abs(np.diff(under(levels, path, level)[:, 0])).max() < 100 * step
    widths = np.linspace(-6, 13, 20_000)
    result = np.empty((len(widths), 3))
    look_narrow(sharp, tuple(levels), np.array([0.3, 0.4, -0.2]), widths, 0.012, result)
    assert np.abs(np.diff(result[:, 0])).max() < 0.02


def test_a_family_of_a_constant_map_is_constant():
    harmonics = ZonalMap.of(np.full((256, 512, 3), 0.25), DEGREE)
    for family in (ggx_lobes(), phong_lobes()):
        levels = LobeLevels.of(harmonics, family)
        for side, first in zip(levels.sides, levels.firsts, strict=True):
            image = levels.texels[first : first + side + 2, : side + 2]
            np.testing.assert_allclose(image, 0.25, rtol=1e-6)
