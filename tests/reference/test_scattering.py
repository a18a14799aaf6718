"""The BRDF along paths: its value, its directions and their density, against the formula."""

import numpy as np
import pytest

from raysvc.reference.weight_kernels import mis_weights
from tests.lighting.surfaces import random_directions, surface_of, views_of
from tests.oracles.brdf import gltf_lobes
from tests.oracles.directional_albedo import directional_albedo
from tests.reference.scattered import answered, counted_and_claimed, scattered

BASE = np.array([0.9, 0.5, 0.1])
UP = np.array([0.0, 0.0, 1.0])


def view_at(cosine):
    return np.array([np.sqrt(1 - cosine**2), 0.0, cosine])


def points(count, cosine, metallic, roughness, geometric_normal=UP, base=BASE):
    """The same point `count` times, its shading normal +Z, seen at a cosine to that."""
    up = np.tile(UP, (count, 1))
    surface = surface_of(up, view_at(cosine), base, metallic, roughness)
    return surface._replace(geometric_normal=np.tile(np.float32(geometric_normal), (count, 1)))


@pytest.mark.parametrize("metallic", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("roughness", [0.0, 0.1, 0.4, 1.0])
def test_light_is_reflected_by_the_formula_of_gltf(rng, metallic, roughness):
    normal = random_directions(rng, 200)
    view, light = views_of(rng, normal), views_of(rng, normal)
    mirrored = 2 * (normal * view).sum(1, keepdims=True) * normal - view
    light[::2] = mirrored[::2] + 0.5 * roughness**2 * rng.normal(size=(100, 3))
    light /= np.linalg.norm(light, axis=1, keepdims=True)
    surface = surface_of(normal, view, BASE, metallic, roughness)
    got = answered(surface, light)
    for i in range(200):
        n = surface.normal[i].astype(float)
        n /= np.linalg.norm(n)
        towards = light[i : i + 1].astype(np.float32).astype(float)
        seen_from = surface.to_viewer[i].astype(float)
        lobes = gltf_lobes(n, seen_from, towards, BASE, metallic, roughness)
        expected = sum(lobes)[0] * max(n @ towards[0], 0)
        np.testing.assert_allclose(got[i], expected, rtol=1e-3, atol=1e-6)


@pytest.mark.parametrize("roughness", [0.0, 0.3, 1.0])
def test_light_and_viewer_may_change_places(rng, roughness):
    normal = np.tile(UP, (100, 1))
    one, other = views_of(rng, normal), views_of(rng, normal)
    there = answered(surface_of(normal, one, BASE, 0.3, roughness), other) / other[:, 2:]
    back = answered(surface_of(normal, other, BASE, 0.3, roughness), one) / one[:, 2:]
    np.testing.assert_allclose(there, back, rtol=2e-3, atol=1e-6)


@pytest.mark.parametrize("tilt_deg", [0.0, 35.0])
@pytest.mark.parametrize("metallic", [0.0, 1.0])
@pytest.mark.parametrize("roughness", [0.0, 0.2, 0.5, 1.0])
@pytest.mark.parametrize("cosine", [0.15, 0.6, 1.0])
def test_constant_light_gives_the_directional_albedo(rng, tilt_deg, metallic, roughness, cosine):
    """Also where the shading normal is tilted: what would go below the triangle is not lost."""
    tilt = np.radians(tilt_deg)
    geometric = np.array([np.sin(tilt), 0.0, np.cos(tilt)])
    surface = points(200_000, cosine, metallic, roughness, geometric)
    directions, throughput, _ = scattered(surface, rng)
    expected = directional_albedo(cosine, BASE, metallic, roughness)
    np.testing.assert_allclose(throughput.mean(axis=0, dtype=float), expected, rtol=5e-3)
    assert (directions @ geometric.astype(np.float32) > -1e-6).all()


@pytest.mark.parametrize("tilt_deg", [0.0, 35.0])
@pytest.mark.parametrize("metallic", [0.0, 1.0])
@pytest.mark.parametrize("roughness", [0.35, 1.0])
def test_directions_are_drawn_with_the_density_that_is_claimed(rng, tilt_deg, metallic, roughness):
    tilt = np.radians(tilt_deg)
    geometric = np.array([np.sin(tilt), 0.0, np.cos(tilt)])

    def make(count):
        return points(count, 0.5, metallic, roughness, geometric)

    counted, expected, drawn = counted_and_claimed(make, 400_000, rng)
    assert expected.sum() == pytest.approx(drawn.sum(), rel=5e-3)
    many = expected > 100
    assert many.sum() > 40
    # Chi-square would count the grid's own error; few per cent of a cell are that and noise
    error = (counted - expected)[many] / np.sqrt(expected[many] + (0.02 * expected[many]) ** 2)
    assert np.abs(error).max() < 5
    assert np.square(error).mean() < 1.5


@pytest.mark.parametrize("roughness", [0.0, 0.4])
def test_what_a_path_keeps_is_the_value_over_the_density(rng, roughness):
    geometric = np.array([0.3, 0.1, 0.95]) / np.linalg.norm([0.3, 0.1, 0.95])
    surface = points(500, 0.7, 0.2, roughness, geometric)
    directions, throughput, density = scattered(surface, rng)
    drawn = density > 0
    value = answered(surface, directions)
    np.testing.assert_allclose(
        (throughput * density[:, None])[drawn], value[drawn], rtol=5e-3, atol=1e-7
    )


def test_nothing_comes_from_below_the_triangle(rng):
    geometric = np.array([0.6, 0.0, 0.8])
    light = random_directions(rng, 4000)
    surface = points(4000, 0.8, 0.0, 0.5, geometric)
    below = light @ geometric < -1e-6
    assert (answered(surface, light)[below] == 0).all()
    above = (light @ geometric > 0.01) & (light[:, 2] > 0.01)
    assert (answered(surface, light)[above] > 0).all()


def test_weights_of_two_ways_sum_to_one(rng):
    one, other = rng.exponential(size=(2, 100)) * 10.0 ** rng.uniform(-6, 6, (2, 100))
    first, second = np.empty((2, 100), np.float32)
    mis_weights(one, other, first)
    mis_weights(other, one, second)
    np.testing.assert_allclose(first + second, 1.0, rtol=1e-6)
    mis_weights(np.full(100, np.inf), other, first)
    assert (first == 1).all()
