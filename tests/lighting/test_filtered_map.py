"""Filtered maps against brute force: lobes of every width, suns, turns, and the light they keep."""

import math

import numpy as np
import pytest

import raysvc
from raysvc.errors import DeadlineExceeded, InvalidSetting, LimitExceeded
from raysvc.lighting.area_resampling import resampled
from raysvc.lighting.brdf import MIRROR_ROUGHNESS
from raysvc.lighting.filtered_map import filtered_map, irradiance_map, lobe_integral
from raysvc.lighting.image_light import ImageLight
from raysvc.lighting.spherical_harmonics import cosine_factors, evaluate, projected, sh9
from raysvc.lighting.sun import extract_suns
from raysvc.parallel import Control
from raysvc.scene import Environment
from tests.lighting.surfaces import surface_of
from tests.oracles.filtered_light import filtered, irradiance
from tests.oracles.lobe import map_directions


def finer(radiance, times=8):
    return np.repeat(np.repeat(radiance, times, axis=0), times, axis=1)


@pytest.fixture
def pixels(rng):
    return rng.random((16, 32, 3)).astype(np.float32) ** 3


def sunny(height=128, width=256):
    """A dim sky with a disc of 2 degrees that has most of the light."""
    directions, _ = map_directions(height, width)
    towards = np.array([0.6, 0.64, -0.48])
    sky = 0.2 + 0.1 * directions[:, 1:2] * [0.3, 0.6, 1.0]
    sky[directions @ towards > math.cos(math.radians(2.0))] += [2000.0, 1500.0, 1000.0]
    return sky.reshape(height, width, 3).astype(np.float32)


@pytest.mark.parametrize("roughness", [0.25, 0.4, 0.7, 1.0])
def test_lobes_are_those_of_brute_force(pixels, roughness):
    directions, _ = map_directions(32, 64)
    found = filtered_map(Environment(pixels), roughness, 64, 32)
    expected = filtered(finer(pixels, 16), directions[::31], roughness)
    np.testing.assert_allclose(found.reshape(-1, 3)[::31], expected, rtol=5e-3)


def test_narrow_lobes_at_the_size_of_the_map_are_those_of_brute_force():
    # Smooth within texels, for they are read as areas of constant light
    directions, _ = map_directions(128, 256)
    smooth = 1.0 + 0.5 * np.sin(5 * directions) * directions[:, [1, 2, 0]]
    environment = Environment(smooth.reshape(128, 256, 3).astype(np.float32))
    for roughness in (0.05, 0.12, 0.2):
        found = filtered_map(environment, roughness, 256, 128)
        expected = filtered(finer(environment.radiance, 4), directions[::2003], roughness)
        np.testing.assert_allclose(found.reshape(-1, 3)[::2003], expected, rtol=0.01)


@pytest.mark.parametrize("roughness", [0.2, 0.35, 0.7, 1.0])
def test_a_sun_is_put_back_as_its_lobe(roughness):
    radiance = sunny(256, 512)
    (sun,), _ = extract_suns(radiance)
    directions, _ = map_directions(64, 128)
    near = np.flatnonzero(directions @ sun.direction > 0.99)
    some = np.concatenate([near, np.arange(0, len(directions), 97)])
    found = filtered_map(Environment(radiance), roughness, 128, 64).reshape(-1, 3)[some]
    expected = filtered(radiance, directions[some], roughness)
    assert expected.max() > 10 * expected.min()
    np.testing.assert_allclose(found, expected, rtol=0.03, atol=1e-3)


@pytest.mark.parametrize("roughness", [0.0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.6, 1.0])
@pytest.mark.parametrize("size", [(64, 32), (100, 40), (256, 128)])
def test_light_is_kept(roughness, size):
    radiance = sunny()
    light = map_directions(128, 256)[1] @ radiance.reshape(-1, 3)
    width, height = size
    found = filtered_map(Environment(radiance), roughness, width, height)
    kept = map_directions(height, width)[1] @ found.reshape(-1, 3)
    np.testing.assert_allclose(kept, light, rtol=0.01)


@pytest.mark.parametrize("roughness", [0.0, 0.04, 0.1, 0.3, 1.0])
@pytest.mark.parametrize("size", [(1, 1), (2, 1), (7, 5), (65, 33), (90, 3)])
def test_constant_light_stays_constant(roughness, size):
    grey = Environment(np.full((16, 32, 3), 0.7, np.float32))
    found = filtered_map(grey, roughness, *size)
    assert found.shape == (size[1], size[0], 3) and found.dtype == np.float32
    np.testing.assert_allclose(found, 0.7, rtol=1e-5)


def test_a_mirror_is_the_map_itself(pixels):
    environment = Environment(pixels)
    np.testing.assert_array_equal(filtered_map(environment, 0.0, 32, 16), pixels)
    halved = filtered_map(environment, MIRROR_ROUGHNESS, 16, 16)
    np.testing.assert_allclose(halved, (pixels[:, ::2] + pixels[:, 1::2]) / 2, rtol=1e-6)


def test_resampled_texels_are_means_by_solid_angle(pixels):
    _, angles = map_directions(48, 96)
    fine = finer(pixels, 3) * angles.reshape(48, 96, 1)
    expected = fine.reshape(8, 6, 24, 4, 3).sum((1, 3))
    expected /= angles.reshape(8, 6, 24, 4, 1).sum((1, 3))
    np.testing.assert_allclose(resampled(pixels, 8, 24), expected, rtol=1e-12)


@pytest.mark.parametrize("roughness", [0.0, 0.1, 0.5])
def test_a_quarter_turn_moves_columns_to_the_left(roughness):
    environment = Environment(sunny(32, 64))
    still = filtered_map(environment, roughness, 64, 32)
    turned = filtered_map(environment, roughness, 64, 32, yaw_deg=90.0, strength=2.0)
    np.testing.assert_allclose(turned, 2 * np.roll(still, -16, axis=1), rtol=1e-5, atol=1e-5)


def test_irradiance_is_that_of_brute_force_with_the_sun_to_the_horizon():
    radiance = sunny()
    directions, _ = map_directions(16, 32)
    found = irradiance_map(Environment(radiance), 32, 16).reshape(-1, 3)
    expected = irradiance(finer(radiance, 2), directions)
    np.testing.assert_allclose(found, expected, rtol=2e-3, atol=1e-3 * expected.max())
    # Of light that is smooth, harmonics say the same
    rest = extract_suns(radiance)[1]
    many = evaluate(projected(rest, 12) * cosine_factors(12)[:, None], directions)
    smooth = irradiance_map(Environment(rest.copy()), 32, 16).reshape(-1, 3)
    np.testing.assert_allclose(smooth, many, rtol=1e-3)


def test_narrow_lobes_are_those_that_surfaces_are_lit_by():
    # Wide ones differ: there a surface's lobe has G2 in it, and the map's N.L
    directions, _ = map_directions(32, 64)
    smooth = 1.0 + 0.5 * np.sin(5 * directions) * directions[:, [1, 2, 0]]
    environment = Environment(smooth.reshape(32, 64, 3).astype(np.float32))
    light = ImageLight(environment, 35.0, 3.0)
    surface = surface_of(directions, directions, 1.0, 1.0, 0.25)
    expected = light.specular(surface, 4) / light.specular_albedo(surface)
    found = filtered_map(environment, 0.25, 64, 32, yaw_deg=35.0, strength=3.0)
    np.testing.assert_allclose(found.reshape(-1, 3), expected, rtol=0.05)


@pytest.mark.parametrize("alpha", [1e-3, 0.05, 0.5, 0.99, 0.9998, 1.0])
def test_the_integral_of_a_lobe_has_its_closed_form(alpha):
    half, weights = np.polynomial.legendre.leggauss(400)
    # In log(sin^2 + alpha^2), where the density is smooth
    low, high = math.log(alpha**2), math.log(0.5 + alpha**2)
    sine2 = np.exp(0.5 * (high - low) * (half + 1) + low) - alpha**2
    density = alpha**2 / (math.pi * (sine2 * (1 - alpha**2) + alpha**2) ** 2)
    steps = 0.5 * (high - low) * weights * (sine2 + alpha**2)
    expected = 4 * math.pi * (density * (1 - 2 * sine2)) @ steps
    assert lobe_integral(alpha) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("roughness", [0.05, 0.4])
def test_threads_do_not_change_a_bit(roughness):
    environment = Environment(sunny(32, 64))
    one, three = (
        filtered_map(environment, roughness, 64, 32, control=Control(threads=n)) for n in (1, 3)
    )
    assert (one == three).all()


@pytest.mark.parametrize(
    ("roughness", "size", "kind", "field"),
    [
        (-0.1, (8, 4), InvalidSetting, "roughness"),
        (1.5, (8, 4), InvalidSetting, "roughness"),
        (math.nan, (8, 4), InvalidSetting, "roughness"),
        (0.5, (0, 4), InvalidSetting, "width"),
        (0.5, (8, -1), InvalidSetting, "height"),
        (0.5, (4, 5), InvalidSetting, "height"),
        (0.5, (5000, 4), LimitExceeded, "width"),
        (0.5, (4096, 1025), LimitExceeded, "height"),
    ],
)
def test_what_cannot_be_is_refused_by_name(pixels, roughness, size, kind, field):
    with pytest.raises(kind) as caught:
        filtered_map(Environment(pixels), roughness, *size)
    assert caught.value.field == field


@pytest.mark.parametrize(
    ("turned", "field"),
    [
        ({"yaw_deg": math.nan}, "yaw_deg"),
        ({"strength": -1.0}, "strength"),
        ({"strength": math.inf}, "strength"),
    ],
)
def test_what_cannot_turn_or_scale_is_refused_by_name(pixels, turned, field):
    for work in (lambda e: filtered_map(e, 0.5, 8, 4, **turned), lambda e: sh9(e, **turned)):
        with pytest.raises(InvalidSetting) as caught:
            work(Environment(pixels))
        assert caught.value.field == field


def test_a_deadline_ends_it(pixels):
    control = Control(deadline_s=-1.0)
    for roughness in (0.0, 0.5):
        with pytest.raises(DeadlineExceeded):
            filtered_map(Environment(pixels), roughness, control=control)


def test_library_users_find_it(pixels):
    assert raysvc.filtered_map is filtered_map and raysvc.irradiance_map is irradiance_map
