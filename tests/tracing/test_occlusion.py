"""How much of the hemisphere a point sees, against closed forms."""

import numpy as np
import pytest

from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import sphere
from raysvc.scene import Material
from raysvc.shading.scene_tables import SceneTables
from raysvc.tracing.occlusion import (
    AROUND,
    EVERY,
    is_traced,
    occlusion_rays,
    pattern,
    tile_of,
)
from raysvc.tracing.occlusion_kernels import TILES
from raysvc.tracing.world import World
from tests.scenes import joined, mesh, quad
from tests.tracing.points import points

MANY = pattern(4096, seed=3)
WHITE = Material(metallic=0.0)


def seen(scene, surface, radius_m, samples=MANY, tile=0):
    world = World(scene, SceneTables.of(scene), "auto")
    tiles = np.full(surface.size, tile, np.int32)
    rays = occlusion_rays(surface, tiles, samples, radius_m)
    return world.transmittance(rays).reshape(surface.size, len(samples)).mean(axis=1)


def wall(x, material=WHITE, half=1000.0):
    """A wall across the x axis, endless as far as radii here go."""
    corners = [(x, -half, -half), (x, half, -half), (x, half, half), (x, -half, half)]
    return mesh(corners, [[0, 1, 2], [0, 2, 3]], materials=(material,))


def test_a_point_of_an_open_plane_sees_everything(rng):
    ground = quad(half=50.0)
    at = np.concatenate([rng.uniform(-40, 40, (200, 2)), np.zeros((200, 1))], axis=1)
    assert (seen(ground, points(at, (0, 0, 1)), 10.0, pattern(16, 0)) == 1).all()


@pytest.mark.parametrize("height", [0.2, 0.5, 0.9])
def test_under_a_ceiling_the_rim_within_the_radius_is_free(height):
    # A ray reaches the ceiling within the radius if its cosine is at least the height over it.
    free = seen(quad(z=height, half=50.0), points([0.1, 0.2, 0], (0, 0, 1)), 1.0)
    assert free[0] == pytest.approx(height**2, abs=0.003)


def test_a_ceiling_beyond_the_radius_hides_nothing():
    free = seen(quad(z=1.01, half=50.0), points([0.1, 0.2, 0], (0, 0, 1)), 1.0)
    assert free[0] == 1


@pytest.mark.parametrize("distance", [1e-4, 0.3, 0.7, 0.95])
def test_beside_an_endless_wall_a_segment_of_the_disk_is_hidden(distance):
    # Directions that reach it within the radius have x >= distance: in the disk of
    # cosine-weighted directions (Nusselt's) that is a segment.
    hidden = (np.arccos(distance) - distance * np.sqrt(1 - distance**2)) / np.pi
    free = seen(wall(distance), points([0, 0, 0], (0, 0, 1)), 1.0)
    assert free[0] == pytest.approx(1 - hidden, abs=0.004)


def test_in_a_corner_of_two_walls_a_quarter_is_left():
    corners = [(-1e3, 1e-4, -1e3), (1e3, 1e-4, -1e3), (1e3, 1e-4, 1e3), (-1e3, 1e-4, 1e3)]
    scene = joined(wall(1e-4), mesh(corners, [[0, 1, 2], [0, 2, 3]]))
    free = seen(scene, points([0, 0, 0], (0, 0, 1)), 1.0)
    assert free[0] == pytest.approx(0.25, abs=0.005)


def test_a_blended_wall_hides_its_part():
    pane = wall(1e-4, Material(base_colour=(1, 1, 1, 0.3), alpha_mode="blend", metallic=0.0))
    free = seen(pane, points([0, 0, 0], (0, 0, 1)), 1.0)
    assert free[0] == pytest.approx(1 - 0.3 / 2, abs=0.003)


def test_rays_stay_above_the_triangle_whatever_the_shading_normal(rng):
    at = np.concatenate([rng.uniform(-40, 40, (100, 2)), np.zeros((100, 1))], axis=1)
    bent = np.array([0.9, 0, 0.436])
    surface = points(at, bent / np.linalg.norm(bent), geometric_normal=(0, 0, 1))
    assert (seen(quad(half=50.0), surface, 10.0, pattern(32, 1)) == 1).all()


@pytest.mark.parametrize("normal", [(0, 0, 1), (0, 0, -1), (0.6, -0.8, 0), (1, 0, 0), (0, 1, 0)])
def test_every_normal_has_a_whole_hemisphere(normal):
    n = np.array(normal, float)
    # A parallel ceiling at half the radius hides all but a quarter.
    across = np.linalg.svd(n[None])[2][1:] * 50
    square = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    corners = n * 0.5 + square @ across
    ceiling = mesh(corners, [[0, 1, 2], [0, 2, 3]])
    assert seen(ceiling, points([0, 0, 0], n), 1.0)[0] == pytest.approx(0.25, abs=0.003)


def test_shifted_patterns_together_are_a_finer_one():
    # What a tile of neighbours sees with few samples averages to nearly the closed form.
    few = pattern(16, seed=5)
    hidden = (np.arccos(0.3) - 0.3 * np.sqrt(1 - 0.09)) / np.pi
    scene = wall(0.3)
    at = points([0, 0, 0], (0, 0, 1))
    each = [seen(scene, at, 1.0, few, tile)[0] for tile in range(TILES)]
    assert np.mean(each) == pytest.approx(1 - hidden, abs=0.005)
    assert np.ptp(each) > 0


def test_under_a_ball_its_disk_is_hidden():
    # The cosine-weighted part of the hemisphere that a ball right above hides: its squared sine.
    ball = scene_of("ball", [Part(sphere(1.0, 120).moved([0, 1.6, 0]), 0)], [WHITE])
    free = seen(ball, points([0, 0, 0], (0, 1, 0)), np.inf)
    assert free[0] == pytest.approx(1 - 1 / 1.6**2, abs=0.003)


def test_a_pattern_is_spread_over_the_square_and_moved_by_its_seed():
    first, second = pattern(64, 0), pattern(64, 1)
    for samples in (first, second):
        assert samples.shape == (64, 2)
        assert ((samples >= 0) & (samples < 1)).all()
        # One in each of 64 columns, and in each of 8 rows about 8.
        assert np.array_equal(np.sort((samples[:, 0] * 64).astype(int)), np.arange(64))
        assert np.ptp(np.histogram(samples[:, 1], 8, (0, 1))[0]) <= 2
    assert not np.allclose(first, second)
    assert (pattern(64, 0) == first).all()


def test_traced_pixels_and_their_neighbours_take_all_shifts():
    pixel = np.arange(24 * 20)
    traced = is_traced(pixel, 24).reshape(20, 24)
    assert traced[::EVERY, ::EVERY].all()
    assert traced.sum() * EVERY**2 == traced.size
    tile = tile_of(pixel, 24).reshape(20, 24)[::EVERY, ::EVERY]
    for row in range(len(tile) - 3):
        for col in range(tile.shape[1] - 3):
            shifts = tile[row : row + 4, col : col + 4].ravel()
            assert sorted(shifts) == list(range(TILES))


@pytest.mark.parametrize("row", [8, 9])
@pytest.mark.parametrize("col", [8, 9])
def test_the_mean_of_neighbours_weighs_every_shift_the_same(row, col):
    weights = AROUND[2 * (row % 2) + col % 2]
    reach = weights.shape[0] - 1
    total = np.zeros(TILES)
    for y in range(row - reach, row + reach + 1):
        for x in range(col - reach, col + reach + 1):
            if is_traced(np.array([y * 24 + x]), 24)[0]:
                shift = tile_of(np.array([y * 24 + x]), 24)[0]
                total[shift] += weights[abs(y - row), abs(x - col)]
    assert total == pytest.approx(np.full(TILES, total[0])) and total[0] > 0
