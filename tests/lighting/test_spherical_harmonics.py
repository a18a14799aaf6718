"""Harmonics against closed forms, sums over texels and brute-force irradiance."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from raysvc.errors import InvalidSetting
from raysvc.lighting.lat_long import texel_directions
from raysvc.lighting.spherical_harmonics import (
    MAX_DEGREE,
    cosine_factors,
    evaluate,
    harmonics,
    projected,
    sh9,
)
from raysvc.scene import Environment
from tests.lighting.surfaces import random_directions
from tests.oracles.filtered_light import irradiance
from tests.oracles.lobe import map_directions


def finer(radiance, times=8):
    return np.repeat(np.repeat(radiance, times, axis=0), times, axis=1)


def test_the_first_nine_are_those_of_ramamoorthi_and_hanrahan(rng):
    directions = random_directions(rng, 50)
    x, y, z = directions.T
    expected = [
        0.282095 + 0 * x,
        0.488603 * y,
        0.488603 * z,
        0.488603 * x,
        1.092548 * x * y,
        1.092548 * y * z,
        0.315392 * (3 * z * z - 1),
        1.092548 * x * z,
        0.546274 * (x * x - y * y),
    ]
    np.testing.assert_allclose(harmonics(directions, 2), np.stack(expected, 1), atol=2e-6)


@pytest.mark.parametrize("degree", [0, 1, 8, MAX_DEGREE])
def test_they_are_orthonormal(degree):
    directions, angles = map_directions(200, 100)
    values = harmonics(directions, degree)
    grams = (values * angles[:, None]).T @ values
    np.testing.assert_allclose(grams, np.eye(len(grams)), atol=0.01)


def test_each_degree_sums_to_its_number_everywhere(rng):
    values = harmonics(random_directions(rng, 20), 12) ** 2
    for order in range(13):
        part = values[:, order * order : (order + 1) ** 2].sum(1)
        np.testing.assert_allclose(part, (2 * order + 1) / (4 * math.pi), rtol=1e-12)


@pytest.mark.parametrize(("height", "width"), [(1, 1), (1, 2), (7, 5), (64, 128)])
def test_a_constant_map_has_one_coefficient(height, width):
    found = projected(np.full((height, width, 3), 0.5, np.float32), 8)
    np.testing.assert_allclose(found[0], 0.5 * math.sqrt(4 * math.pi), rtol=1e-12)
    np.testing.assert_allclose(found[1:], 0, atol=1e-12)


def test_a_projection_is_the_sum_over_texels(rng):
    pixels = rng.random((24, 40, 3)).astype(np.float32) ** 4
    fine = finer(pixels)
    directions, angles = map_directions(*fine.shape[:2])
    expected = (harmonics(directions, 8) * angles[:, None]).T @ fine.reshape(-1, 3)
    np.testing.assert_allclose(projected(pixels, 8), expected, atol=2e-4)


def test_one_bright_texel_is_a_delta():
    pixels = np.zeros((256, 512, 3), np.float32)
    pixels[60, 400] = 1000.0
    towards = texel_directions(60.5, 400.5, 256, 512)
    light = 1000.0 * map_directions(256, 512)[1][60 * 512]
    expected = light * harmonics(towards[None], 8)[0]
    np.testing.assert_allclose(projected(pixels, 8)[:, 1], expected, atol=1e-3 * light)


def test_a_cosine_lobe_has_its_closed_form():
    towards = np.array([0.48, 0.6, -0.64])
    directions, _ = map_directions(256, 512)
    lobe = np.maximum(directions @ towards, 0).reshape(256, 512, 1)
    found = projected(np.repeat(lobe, 3, 2).astype(np.float32), 8)
    expected = cosine_factors(8) * harmonics(towards[None], 8)[0]
    np.testing.assert_allclose(found[:, 0], expected, atol=2e-4)
    assert cosine_factors(4)[[0, 1, 4, 9, 16]] == pytest.approx(
        [math.pi, 2 * math.pi / 3, math.pi / 4, 0.0, -math.pi / 24]
    )


def test_what_harmonics_span_is_kept_with_its_energy(rng):
    given_ = rng.normal(size=(25, 3))
    given_[0] = 20.0  # light is not negative
    directions, angles = map_directions(180, 360)
    pixels = evaluate(given_, directions)
    assert pixels.min() > 0
    found = projected(pixels.reshape(180, 360, 3).astype(np.float32), 6)
    np.testing.assert_allclose(found[:25], given_, rtol=1e-3, atol=1e-3)
    np.testing.assert_allclose(found[25:], 0, atol=1e-3)
    # Parseval
    np.testing.assert_allclose((found**2).sum(0), angles @ pixels**2, rtol=1e-3)


@settings(max_examples=20, deadline=None)
@given(yaw_deg=st.floats(-720, 720), seed=st.integers(0, 100))
def test_turning_a_map_turns_its_harmonics(yaw_deg, seed):
    rng = np.random.default_rng(seed)
    pixels = rng.random((6, 12, 3)).astype(np.float32)
    still, turned = projected(pixels, 5), projected(pixels, 5, yaw_deg)
    c, s = math.cos(math.radians(yaw_deg)), math.sin(math.radians(yaw_deg))
    turn = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    directions = random_directions(rng, 40)
    np.testing.assert_allclose(
        evaluate(turned, directions @ turn.T), evaluate(still, directions), atol=1e-9
    )


def test_irradiance_of_nine_and_of_more_comes_close_to_the_integral(rng):
    pixels = rng.random((12, 24, 3)).astype(np.float32) ** 3
    directions = random_directions(rng, 100)
    expected = irradiance(finer(pixels), directions)
    nine = evaluate(sh9(Environment(pixels)).irradiance, directions)
    np.testing.assert_allclose(nine, expected, rtol=0.05)
    many = evaluate(projected(pixels, 8) * cosine_factors(8)[:, None], directions)
    np.testing.assert_allclose(many, expected, rtol=0.01)


def test_nine_of_a_constant_light_are_in_their_units():
    grey = Environment(np.full((8, 16, 3), 0.5, np.float32))
    found = sh9(grey, strength=2.0)
    up = np.array([[0.0, 1.0, 0.0]])
    np.testing.assert_allclose(evaluate(found.radiance, up), 1.0)
    np.testing.assert_allclose(evaluate(found.irradiance, up), math.pi)
    shown = found.to_dict()
    assert len(shown["basis"]) == len(shown["radiance"]) == len(shown["irradiance"]) == 9


def test_the_same_map_gives_the_same_bits(rng):
    pixels = rng.random((40, 80, 3)).astype(np.float32)
    assert (projected(pixels, 8) == projected(pixels, 8)).all()


def test_wrong_degrees_are_refused(rng):
    for degree in (-1, MAX_DEGREE + 1):
        with pytest.raises(InvalidSetting, match="degree"):
            harmonics(random_directions(rng, 2), degree)
    with pytest.raises(InvalidSetting, match="coefficients"):
        evaluate(np.zeros((5, 3)), random_directions(rng, 2))
