"""Light that microfacets scatter more than once: furnaces, and the factor on all kinds of light."""

import numpy as np
import pytest

from raysvc.lighting.albedo import specular_albedo
from raysvc.lighting.direct import reflected
from raysvc.lighting.image_light import Filtering, ImageLight
from raysvc.lighting.rescattering import with_rescattering
from raysvc.scene import Environment
from raysvc.shading.glass import Glass
from tests.lighting.surfaces import random_directions, surface_of, views_of
from tests.lighting.test_lamps import glowing, lamps, panel
from tests.oracles.lobe import albedo

COSINES = np.array([0.03, 0.1, 0.25, 0.5, 0.75, 1.0])
ROUGHNESS = [0.0, 0.1, 0.3, 0.5, 0.8, 1.0]


def points(base, metallic, roughness):
    """Points seen at all of COSINES."""
    view = np.stack([np.sqrt(1 - COSINES**2), 0 * COSINES, COSINES], 1)
    return surface_of(np.tile([0, 0, 1.0], (len(view), 1)), view, base, metallic, roughness)


@pytest.fixture(scope="module", params=["sat", "sh9", "split_sum", "brute"])
def furnace(request):
    return ImageLight(
        Environment(np.full((32, 64, 3), 0.5, np.float32)), filtering=Filtering(request.param)
    )


@pytest.mark.parametrize("roughness", ROUGHNESS)
def test_white_metal_vanishes_in_a_furnace(furnace, roughness):
    surface = points(1.0, 1.0, roughness)
    whole = furnace.specular(with_rescattering(surface))
    np.testing.assert_allclose(whole, 0.5, rtol=1e-3)
    once = furnace.specular(surface)
    for i, cosine in enumerate(COSINES):
        lost = 1 - albedo(cosine, np.ones(3), 1.0, roughness, steps=200)[1]
        np.testing.assert_allclose(1 - once[i] / 0.5, lost, atol=2e-2)
    if roughness == 1.0:
        assert (once < 0.5 * 0.9).all()


@pytest.mark.parametrize("base", [(0.9, 0.5, 0.1), (0.2, 0.2, 0.2)])
@pytest.mark.parametrize("metallic", [0.0, 0.4, 1.0])
def test_of_what_is_missing_f0_comes_back(base, metallic):
    f0 = 0.04 * (1 - metallic) + np.array(base) * metallic
    for roughness in ROUGHNESS:
        surface = points(base, metallic, roughness)
        white = specular_albedo(points(1.0, 1.0, roughness))
        ratio = specular_albedo(with_rescattering(surface)) / specular_albedo(surface)
        np.testing.assert_allclose(ratio, 1 + f0 * (1 / white - 1), rtol=1e-5)
        if metallic == 0.0:
            assert ratio.max() < 1.1


@pytest.mark.parametrize("angular_radius", [0.0, 0.05])
def test_lights_gain_as_much_as_constant_light_does(rng, angular_radius):
    normal = random_directions(rng, 200)
    view, light = views_of(rng, normal, 0.4), views_of(rng, normal).astype(np.float32)
    irradiance = np.ones((200, 3), np.float32)
    surface = surface_of(normal, view, (0.9, 0.5, 0.1), 1.0, 0.7)
    once = reflected(surface, light, irradiance, angular_radius)
    more = reflected(with_rescattering(surface), light, irradiance, angular_radius)
    gain = specular_albedo(with_rescattering(surface)) / specular_albedo(surface)
    np.testing.assert_allclose(more, once * gain, rtol=1e-5)
    assert (gain > 1.005).all()


def test_what_lights_is_diffused_as_before(rng):
    normal = random_directions(rng, 100)
    surface = surface_of(normal, views_of(rng, normal), 0.8, 0.0, 1.0, dielectric_f0=0.0)
    light, irradiance = normal.astype(np.float32), np.ones((100, 3), np.float32)
    np.testing.assert_array_equal(
        reflected(surface, light, irradiance, 0.0),
        reflected(with_rescattering(surface), light, irradiance, 0.0),
    )


def test_lamps_gain_as_much_as_constant_light_does():
    found, _ = lamps([panel(0.6, 1.0)], [glowing()])
    at = np.array([(0.2, 0.0, z) for z in (-1.0, 0.0, 0.8)], np.float32)
    view = np.array([0.0, 0.6, 0.8])
    surface = surface_of(np.tile([0, 1.0, 0], (3, 1)), view, (0.9, 0.6, 0.3), 1.0, 0.8)
    surface = surface._replace(position=at)
    once = found.lights[0].unshadowed(surface)
    more = found.lights[0].unshadowed(with_rescattering(surface))
    gain = specular_albedo(with_rescattering(surface)) / specular_albedo(surface)
    assert once.min() > 0 and gain.min() > 1.05
    np.testing.assert_allclose(more, once * gain, rtol=1e-5)


def test_glass_seen_from_inside_is_left_as_it_is():
    surface = points(1.0, 0.0, 0.8)
    count = surface.size
    glass = Glass(
        np.ones(count, bool),
        np.arange(count) % 2 == 0,
        np.full(count, 1.5, np.float32),
        np.zeros((count, 3), np.float32),
    )
    surface = surface._replace(glass=glass, transmission=np.ones(count, np.float32))
    missing = with_rescattering(surface).rescattering.missing
    assert (missing[::2] > 0.02).all() and (missing[1::2] == 0).all()
