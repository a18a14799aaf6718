"""Boxes of an environment's tables: closed forms, and no place on the sphere that is special."""

import math

import numpy as np
import pytest

from raysvc.jit import kernel
from raysvc.lighting.sphere_kernels import map_radiances, narrow_radiance
from raysvc.lighting.sphere_table import sphere_table
from tests.lighting.surfaces import random_directions
from tests.oracles.lobe import map_directions


@kernel
def look(sharp, order, directions, solid_angle, result):
    for i in range(len(directions)):
        x, y, z = directions[i, 0], directions[i, 1], directions[i, 2]
        r, g, b = narrow_radiance(sharp, order, x, y, z, solid_angle)
        result[i, 0], result[i, 1], result[i, 2] = r, g, b


def means(table, directions, solid_angle, order=1):
    result = np.empty((len(directions), 3))
    look(table, order, directions, solid_angle, result)
    return result


def seen(radiance, directions):
    result = np.empty((len(directions), 3), np.float32)
    map_radiances(radiance, np.asarray(directions, np.float32), 1.0, 0.0, 1.0, result)
    return result


@pytest.mark.parametrize("shape", [(64, 128), (1, 1), (7, 5), (100, 100), (1200, 2400)])
def test_a_constant_map_is_constant_at_every_size(rng, shape):
    table = sphere_table(np.full((*shape, 3), 0.7, np.float32)).tables
    directions = random_directions(rng, 500)
    for solid_angle in (1e-7, 1e-3, 0.1, 1.0, 3.5):
        np.testing.assert_allclose(means(table, directions, solid_angle), 0.7, rtol=1e-6)


def test_a_cylinder_holds_exactly_the_light_of_the_map(rng):
    radiance = rng.random((50, 90, 3)).astype(np.float32)
    table = sphere_table(radiance).tables[0, -1, -1]
    rows, columns = (n - 1 for n in sphere_table(radiance).tables.shape[1:3])
    _, angles = map_directions(50, 90)
    expected = angles @ radiance.reshape(-1, 3).astype(float)
    np.testing.assert_allclose(table * 4 * math.pi / (rows * columns), expected, rtol=1e-9)


def test_a_linear_map_is_seen_as_it_is_from_everywhere(rng):
    # Radiance linear in direction: its mean over a symmetric box is its middle, shortened a little
    texels, _ = map_directions(256, 512)
    slopes = np.array([[0.3, 0.5, -0.2], [0.1, -0.4, 0.6], [-0.7, 0.1, 0.1]])
    radiance = (1 + texels @ slopes.T).reshape(256, 512, 3).astype(np.float32)
    table = sphere_table(radiance).tables
    directions = random_directions(rng, 2000)
    expected = 1 + directions @ slopes.T
    for side, tolerance in ((0.02, 0.004), (0.1, 0.005)):
        got = means(table, directions, side**2)
        np.testing.assert_allclose(got, expected, atol=tolerance)


@pytest.mark.parametrize(
    "place",
    [(0, 1, 0), (0, -1, 0), (0.02, 1, 0.01), (1, 0, 0), (-1, 0, 0), (0, 0, 1), (0, 0, -1),
     (0.001, 0.3, 1), (0.7, 0.7, 0.1), (-0.5, -0.7, 0.5)],
)  # fmt: skip
@pytest.mark.parametrize("solid_angle", [0.004, 0.05])
def test_a_bright_spot_gives_the_same_light_wherever_it_is(rng, place, solid_angle):
    towards = np.array(place) / np.linalg.norm(place)
    texels, angles = map_directions(128, 256)
    near = np.argmax(texels @ towards)
    radiance = np.zeros((128 * 256, 3), np.float32)
    radiance[near] = 1.0 / angles[near]
    table = sphere_table(radiance.reshape(128, 256, 3)).tables
    # Summed over all directions, every box that contains the spot sees its light once
    spot = texels[near]
    cap = 0.6
    count = 60_000
    z = 1 - (1 - math.cos(cap)) * (np.arange(count) + 0.5) / count
    turn = np.arange(count) * 2.399963
    a = np.cross(spot, [0.3, 0.2, 0.9])
    a /= np.linalg.norm(a)
    b = np.cross(spot, a)
    s = np.sqrt(1 - z**2)
    directions = (s * np.cos(turn))[:, None] * a + (s * np.sin(turn))[:, None] * b
    directions += z[:, None] * spot
    per_sample = 2 * math.pi * (1 - math.cos(cap)) / count
    total = means(table, directions, solid_angle)[:, 0].sum() * per_sample
    assert total == pytest.approx(1.0, abs=0.06)


def test_lookups_are_continuous_across_seams_poles_and_levels(rng):
    texels, _ = map_directions(64, 128)
    bands = 1 + np.sin(9 * texels[:, :1]) * np.cos(7 * texels[:, 1:2]) + texels[:, 2:] ** 2
    radiance = np.repeat(bands.reshape(64, 128, 1), 3, axis=2).astype(np.float32)
    table = sphere_table(radiance).tables
    step = 1e-4
    turn = np.arange(0, 2 * math.pi, step)
    around = np.stack([np.sin(turn), np.cos(turn) * 0, -np.cos(turn)], 1)
    over = np.stack([0.1 * np.sin(turn), np.cos(turn), -np.sin(turn)], 1)
    for path in (around, over / np.linalg.norm(over, axis=1, keepdims=True)):
        for solid_angle in (1e-3, 0.02, 0.2):
            jumps = np.abs(np.diff(means(table, path, solid_angle)[:, 0]))
            assert jumps.max() < 20 * step
    sizes = np.geomspace(1e-5, 3.4, 4000)
    one = random_directions(rng, 1)
    values = [means(table, one, size)[0, 0] for size in sizes]
    assert np.abs(np.diff(values)).max() < 0.02


def test_the_map_is_bilinear_between_texels_and_periodic(rng):
    radiance = rng.random((8, 16, 3)).astype(np.float32)
    texels, _ = map_directions(8, 16)
    np.testing.assert_allclose(seen(radiance, texels), radiance.reshape(-1, 3), atol=1e-5)
    seam = np.array([[0.0, 0.0, 1.0]])
    middle = radiance[3:5][:, [0, -1]].mean((0, 1))
    np.testing.assert_allclose(seen(radiance, seam)[0], middle, atol=1e-5)
    # From all sides, the pole is the mean of two opposite texels of its row
    turn = (np.arange(16) + 0.5) / 16 * 2 * np.pi
    close = np.stack([1e-6 * np.sin(turn), np.ones(16), -1e-6 * np.cos(turn)], 1)
    opposite = 0.5 * (radiance[0] + np.roll(radiance[0], 8, axis=0))
    np.testing.assert_allclose(seen(radiance, close), np.roll(opposite, 8, axis=0), atol=1e-5)


def test_a_map_of_one_texel_can_be_seen(rng):
    radiance = np.full((1, 1, 3), 3.0, np.float32)
    np.testing.assert_allclose(seen(radiance, random_directions(rng, 50)), 3.0)
