"""Lobes averaged over what a pixel sees mirrored (`Surface.mirrored`)."""

import numpy as np
import pytest

from raysvc.lighting.image_light import ImageLight
from raysvc.scene import Environment
from raysvc.shading.mirrored import Mirrored
from tests.lighting.surfaces import random_directions, surface_of
from tests.oracles.lobe import map_directions

STEPS = 24


def speckled(rng):
    """A map that is different in every texel, and a small lamp."""
    radiance = rng.random((128, 256, 3)).astype(np.float32) ** 4
    radiance[40:42, 60:62] = 300.0
    return radiance


def facing(directions, roughness, pixel_sr):
    """Metal that mirrors what lies straight ahead."""
    surface = surface_of(directions, directions, 1.0, 1.0, roughness)
    return surface._replace(mirrored=Mirrored(np.full(len(directions), pixel_sr, np.float32)))


def mean_around(radiance, directions, pixel_sr):
    """(N, 3) means of a map over squares of so many steradians, point by point."""
    height, width, _ = radiance.shape
    across = np.cross(directions, [0.3, 0.9, 0.1])
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    up = np.cross(across, directions)
    total = np.zeros((len(directions), 3))
    offsets = ((np.arange(STEPS) + 0.5) / STEPS - 0.5) * np.sqrt(pixel_sr)
    for a in offsets:
        for b in offsets:
            x, y, z = (directions + a * across + b * up).T
            row = np.arccos(np.clip(y / np.sqrt(x * x + y * y + z * z), -1, 1)) / np.pi * height
            column = (np.arctan2(x, -z) / (2 * np.pi) + 0.5) * width
            total += radiance[np.minimum(row.astype(int), height - 1), column.astype(int) % width]
    return total / STEPS**2


@pytest.fixture(scope="module")
def directions():
    return random_directions(np.random.default_rng(8), 300)


def test_the_oracle_looks_where_the_map_is(directions):
    texels, _ = map_directions(128, 256)
    np.testing.assert_allclose(
        mean_around(texels.reshape(128, 256, 3), directions, 1e-8), directions, atol=0.02
    )


@pytest.mark.parametrize("roughness", [0.0, 0.04])
def test_a_mirror_shows_its_pixel_s_mean_and_not_a_texel(rng, directions, roughness):
    radiance = speckled(rng)
    radiance[40:42, 60:62] = 1.0
    light = ImageLight(Environment(radiance))
    truth = mean_around(radiance, directions, 0.02)
    shown = light.specular(facing(directions, roughness, 0.02))
    point = light.specular(facing(directions, roughness, 0.0))
    error, error_of_points = np.abs(shown - truth).mean(), np.abs(point - truth).mean()
    assert error < 0.15 * error_of_points


def test_a_pixel_no_larger_than_a_texel_shows_the_map(rng, directions):
    light = ImageLight(Environment(speckled(rng)))
    texel_sr = 4 * np.pi / (128 * 256)
    within = light.specular(facing(directions, 0.0, 0.9 * texel_sr))
    np.testing.assert_array_equal(within, light.specular(facing(directions, 0.0, 0.0)))
    beyond = light.specular(facing(directions, 0.0, 1.5 * texel_sr))
    assert (within != beyond).any()


def test_mirrors_average_suns_with_the_rest(rng):
    radiance = np.full((128, 256, 3), 0.5, np.float32)
    radiance[40:42, 60:62] = 3000.0
    light = ImageLight(Environment(radiance))
    assert light.suns
    towards = np.array([light.suns[0].direction])
    pixel_sr = 0.03
    shown = light.specular(facing(towards, 0.0, pixel_sr))[0, 0]
    expected = 0.5 + light.suns[0].irradiance[0] / pixel_sr
    assert shown == pytest.approx(expected, rel=0.05)
    assert light.specular(facing(towards, 0.0, 0.0))[0, 0] > 2000


def test_wide_lobes_and_constant_light_stay_as_they_are(rng, directions):
    sky = ImageLight(Environment(speckled(rng)))
    np.testing.assert_array_equal(
        sky.specular(facing(directions, 0.5, 0.05)), sky.specular(facing(directions, 0.5, 0.0))
    )
    grey = ImageLight(Environment(np.full((32, 64, 3), 0.5, np.float32)))
    for roughness in (0.0, 0.1, 0.3):
        surface = facing(directions, roughness, 0.08)
        np.testing.assert_allclose(
            grey.specular(surface), 0.5 * grey.specular_albedo(surface), rtol=1e-5
        )
