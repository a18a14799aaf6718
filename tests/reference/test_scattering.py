"""The BRDF along paths: its value, its directions and their density, against the formula."""

import numpy as np
import pytest

from raysvc.lighting.albedo import albedo_tables
from raysvc.reference.scattering_kernels import reflect_samples, scatter
from raysvc.reference.weight_kernels import mis_weights
from tests.lighting.surfaces import random_directions, surface_of, views_of
from tests.oracles.brdf import gltf_lobes
from tests.oracles.directional_albedo import directional_albedo

BASE = np.array([0.9, 0.5, 0.1])
UP = np.array([0.0, 0.0, 1.0])


def view_at(cosine):
    return np.array([np.sqrt(1 - cosine**2), 0.0, cosine])


def points(count, cosine, metallic, roughness, geometric_normal=UP, base=BASE):
    """The same point `count` times, its shading normal +Z, seen at a cosine to that."""
    up = np.tile(UP, (count, 1))
    surface = surface_of(up, view_at(cosine), base, metallic, roughness)
    return surface._replace(geometric_normal=np.tile(np.float32(geometric_normal), (count, 1)))


def scattered(surface, rng):
    """Directions, throughput of white light, densities."""
    count = surface.size
    directions = np.empty((count, 3), np.float32)
    throughput, density = np.ones((count, 3), np.float32), np.empty(count)
    # An even lattice, so that means are those of many more samples
    index = np.arange(count)[:, None]
    place = (index * [0.7548776662466927, 0.5698402909980532] + rng.random(2)) % 1.0
    pick = (index[:, 0] * 0.6180339887498949 + rng.random()) % 1.0
    scatter(albedo_tables().specular, surface, place, pick, directions, throughput, density)
    return directions, throughput, density


def answered(surface, to_light):
    """BRDF times cosine towards directions (N, 3)."""
    count = surface.size
    white, value = np.ones((count, 3), np.float32), np.empty((count, 3), np.float32)
    reflect_samples(
        albedo_tables().specular,
        surface,
        np.ascontiguousarray(to_light, np.float32),
        white,
        np.full(count, np.inf),
        white,
        value,
    )
    return value


def densities(surface, to_light):
    """Density with which `scatter` draws directions (N, 3), from the weight of a light there."""
    count = surface.size
    white, value = np.ones((count, 3), np.float32), np.empty((count, 3), np.float32)
    own = np.full(count, 1.0)
    to_light = np.ascontiguousarray(to_light, np.float32)
    terms = albedo_tables().specular
    reflect_samples(terms, surface, to_light, white, own, white, value)
    whole = answered(surface, to_light)
    seen = whole[:, 0] > 0
    weight = np.where(seen, value[:, 0].astype(float) / np.where(seen, whole[:, 0], 1), 1.0)
    return np.sqrt(np.maximum(1.0 / weight - 1.0, 0.0))


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
    count, cells = 400_000, (24, 36)
    directions, throughput, density = scattered(
        points(count, 0.5, metallic, roughness, geometric), rng
    )
    drawn = density > 0
    # Expected in each cell of (z, azimuth), 64 places of each
    z = (np.arange(cells[0] * 8) + 0.5) / (cells[0] * 4) - 1
    azimuth = ((np.arange(cells[1] * 8) + 0.5) / (cells[1] * 8) - 0.5) * 2 * np.pi
    z, azimuth = (a.reshape(-1) for a in np.meshgrid(z, azimuth, indexing="ij"))
    sine = np.sqrt(1 - z**2)
    at = np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), z], axis=1)
    claimed = densities(points(len(at), 0.5, metallic, roughness, geometric), at)
    claimed = claimed.reshape(cells[0], 8, cells[1], 8).mean(axis=(1, 3)) * 4 * np.pi
    expected = claimed / claimed.size * count
    assert expected.sum() == pytest.approx(drawn.sum(), rel=5e-3)
    seen = directions[drawn].astype(float)
    counted = np.histogram2d(
        seen[:, 2],
        np.arctan2(seen[:, 1], seen[:, 0]),
        cells,
        [[-1, 1], [-np.pi, np.pi]],
    )[0]
    many = expected > 100
    assert many.sum() > 40
    # Chi-square would count the grid's own error; few per cent of a cell are that and noise
    error = (counted - expected)[many] / np.sqrt(expected[many] + (0.02 * expected[many]) ** 2)
    assert np.abs(error).max() < 5
    assert np.square(error).mean() < 1.5
    assert (throughput[~drawn] == 0).all()


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
