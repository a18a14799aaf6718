"""An environment softened once, against the tables that it was made from."""

import numpy as np
import pytest

from raysvc.jit import kernel
from raysvc.lighting.image_light import ImageLight
from raysvc.lighting.soft_map import LARGEST, solid_angle_of_rays
from raysvc.lighting.soft_map_kernels import soft_radiance
from raysvc.scene import Environment
from tests.lighting.surfaces import random_directions
from tests.oracles.lobe import map_directions


@kernel
def look_up(soft, directions, radiance):
    for i in range(len(directions)):
        r, g, b = soft_radiance(soft, directions[i, 0], directions[i, 1], directions[i, 2])
        radiance[i, 0], radiance[i, 1], radiance[i, 2] = r, g, b


def looked_up(soft, directions):
    radiance = np.empty((len(directions), 3))
    look_up(soft, np.asarray(directions, float), radiance)
    return radiance


def gradient(height=64):
    """Smooth in all directions, different in each channel."""
    directions, _ = map_directions(height, 2 * height)
    x, y, z = directions.T
    colours = np.stack([1 + 0.8 * x, 1.2 + y * z, 1 - 0.6 * y], axis=1)
    return Environment(colours.reshape(height, 2 * height, 3).astype(np.float32))


def test_constant_light_stays_constant(rng):
    soft = ImageLight(Environment(np.full((16, 32, 3), 3.0, "f4")), 0.0, 2.0).softened(0.2)
    assert looked_up(soft, random_directions(rng, 500)) == pytest.approx(np.full((500, 3), 6.0))


@pytest.mark.parametrize("yaw_deg", [0.0, 70.0])
def test_a_smooth_environment_is_seen_as_it_is(rng, yaw_deg):
    light = ImageLight(gradient(), yaw_deg)
    directions = random_directions(rng, 2000)
    error = looked_up(light.softened(0.05), directions) - light.radiance(directions.astype("f4"))
    assert np.abs(error).max() < 0.03


def blob(towards, sharpness, height=128):
    """Light about one direction, e-fold at 1 / sharpness below a cosine of 1."""
    directions, _ = map_directions(height, 2 * height)
    grey = np.exp(sharpness * (directions @ np.asarray(towards, float) - 1))
    return ImageLight(Environment(np.repeat(grey, 3).reshape(height, -1, 3).astype(np.float32)))


@pytest.mark.parametrize("towards", [(0, 0, -1), (0, 1, 0), (0, -1, 0), (0.6, 0.8, 0)])
@pytest.mark.parametrize("wide", [0.1, 0.5])
def test_a_wide_lookup_is_about_a_mean_over_its_cone(towards, wide):
    light = blob(towards, 20)
    assert not light.suns
    # Mean of exp(k (c - 1)) over a cone of solid angle w, for which 1 - c is at most w / 2 pi.
    depth = 20 * wide / (2 * np.pi)
    mean = (1 - np.exp(-depth)) / depth
    assert looked_up(light.softened(wide), [towards])[0, 0] == pytest.approx(mean, rel=0.12)
    assert looked_up(light.softened(wide), [np.negative(towards)]).max() < 1e-3


def test_all_light_is_still_there(rng):
    light = blob((0.6, 0.8, 0.0), 15)
    directions = random_directions(rng, 200_000)
    mean = looked_up(light.softened(0.4), directions).mean(axis=0)
    assert mean == pytest.approx(light.radiance(directions.astype("f4")).mean(axis=0), rel=0.03)


def test_rays_share_the_hemisphere():
    assert solid_angle_of_rays(16) * 16 == pytest.approx(np.pi)
    soft = ImageLight(gradient()).softened(solid_angle_of_rays(1))
    assert (soft.radiance == ImageLight(gradient()).softened(LARGEST).radiance).all()
