"""Drawing from environments: densities, their integral, and what is lit by them."""

import numpy as np
import pytest

from raysvc.lighting.image_light import ImageLight
from raysvc.reference.environment import EnvironmentLight
from raysvc.scene import Environment
from tests.lighting.surfaces import random_directions
from tests.oracles.lobe import map_directions

SHAPES = [(1, 1), (1, 5), (2, 3), (8, 16), (9, 17)]


def patchy(rng, height, width):
    """Dark, with few texels that are bright; one of them is at a pole."""
    pixels = rng.exponential(0.05, (height, width, 3)) * (rng.random((height, width, 1)) < 0.5)
    pixels[0, 0] += 3.0
    pixels[height // 2, width // 2] += (200.0, 150.0, 90.0)
    return Environment(pixels.astype(np.float32))


def grid(height=600, width=1200):
    """Directions of a fine grid, and their solid angles."""
    directions, angles = map_directions(height, width)
    return directions.astype(np.float32), angles


@pytest.mark.parametrize("shape", SHAPES)
def test_the_density_integrates_to_one(rng, shape):
    directions, angles = grid()
    _, density = EnvironmentLight(patchy(rng, *shape)).look_up(directions)
    assert density @ angles == pytest.approx(1.0, rel=2e-3)


@pytest.mark.parametrize("shape", SHAPES)
def test_whatever_is_bright_can_be_drawn(rng, shape):
    light = EnvironmentLight(patchy(rng, *shape))
    radiance, density = light.look_up(random_directions(rng, 20_000).astype(np.float32))
    assert (density[radiance.any(axis=1)] > 0).all()


@pytest.mark.parametrize("shape", SHAPES)
def test_directions_are_drawn_with_their_density(rng, shape):
    light = EnvironmentLight(patchy(rng, *shape), yaw_deg=25.0)
    count, cells = 200_000, (20, 30)
    samples = light.sample(rng.random((count, 2)))
    np.testing.assert_allclose(np.linalg.norm(samples.to_light, axis=1), 1, rtol=1e-6)
    directions, angles = grid()
    _, density = light.look_up(directions)
    where = lambda d: (  # noqa: E731
        np.minimum(((1 - d[:, 1]) / 2 * cells[0]).astype(int), cells[0] - 1) * cells[1]
        + np.minimum(
            ((np.arctan2(d[:, 0], -d[:, 2]) / 2 / np.pi + 0.5) * cells[1]).astype(int),
            cells[1] - 1,
        )
    )
    expected = np.bincount(where(directions), density * angles * count, cells[0] * cells[1])
    counted = np.bincount(where(samples.to_light.astype(float)), minlength=cells[0] * cells[1])
    error = (counted - expected) / np.sqrt(expected + (0.03 * expected) ** 2 + 25)
    assert np.abs(error).max() < 5
    assert np.square(error).mean() < 1.5


@pytest.mark.parametrize("shape", SHAPES)
def test_looking_a_drawn_direction_up_gives_the_same(rng, shape):
    light = EnvironmentLight(patchy(rng, *shape), yaw_deg=-70.0, strength=3.0)
    samples = light.sample(rng.random((5000, 2)))
    radiance, density = light.look_up(samples.to_light)
    np.testing.assert_allclose(density, samples.density, rtol=2e-3, atol=1e-4)
    drawn = samples.radiance * samples.density[:, None]
    np.testing.assert_allclose(drawn, radiance, rtol=2e-3, atol=1e-3)


def test_radiance_is_that_of_the_hybrid_renderer(rng):
    environment = patchy(rng, 16, 32)
    directions = random_directions(rng, 1000).astype(np.float32)
    radiance, _ = EnvironmentLight(environment, 40.0, 2.0).look_up(directions)
    expected = ImageLight(environment, 40.0, 2.0).radiance(directions)
    np.testing.assert_allclose(radiance, expected, rtol=1e-6)


@pytest.mark.parametrize("facing", [(0, 1, 0), (0.6, -0.48, 0.64), (-1, 0, 0)])
def test_estimated_irradiance_is_that_of_a_sum_over_all_directions(rng, facing):
    light = EnvironmentLight(patchy(rng, 9, 18), yaw_deg=100.0)
    directions, angles = grid()
    radiance, _ = light.look_up(directions)
    cosine = np.maximum(directions @ np.array(facing), 0)
    expected = (radiance * (cosine * angles)[:, None]).sum(axis=0)
    samples = light.sample(rng.random((200_000, 2)))
    cosine = np.maximum(samples.to_light @ np.array(facing), 0)
    estimate = (samples.radiance * cosine[:, None]).mean(axis=0, dtype=float)
    np.testing.assert_allclose(estimate, expected, rtol=0.02)


def test_a_grey_sun_of_one_texel_is_drawn_without_noise(rng):
    pixels = np.zeros((64, 128, 3), np.float32)
    pixels[20, 50] = 1000.0
    samples = EnvironmentLight(Environment(pixels)).sample(rng.random((5000, 2)))
    # Left is the sine of the polar angle, which changes by 4 % over the sun
    assert samples.radiance.std() < 0.03 * samples.radiance.mean()


@pytest.mark.parametrize("strength", [0.0, 1.0])
def test_a_black_environment_is_dark(strength):
    value = 0.0 if strength else 1.0
    environment = Environment(np.full((4, 8, 3), value, np.float32))
    light = EnvironmentLight(environment, strength=strength)
    assert light.is_dark
    radiance, density = light.look_up(np.float32([[0, 1, 0], [0, 0, -1]]))
    assert not radiance.any()
    assert np.isfinite(density).all()
