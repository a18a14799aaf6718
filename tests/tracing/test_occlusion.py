"""How much of the sky a point sees, against closed forms; and what neighbours lend each other."""

import numpy as np
import pytest

from raysvc.scene import Material
from raysvc.shading.scene_tables import SceneTables
from raysvc.tracing.occlusion import (
    EVERY,
    VisibilityPicture,
    is_traced,
    pattern,
    tile_of,
    visibility,
)
from raysvc.tracing.world import World
from tests.scenes import joined, mesh, quad
from tests.tracing.points import points

MANY = pattern(4096, seed=3)
WHITE = Material(metallic=0.0)


def seen(scene, surface, radius_m, samples=MANY, tile=0):
    world = World(scene, SceneTables.of(scene), "auto")
    return visibility(world, surface, np.full(surface.size, tile, np.int32), samples, radius_m)


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
    # What four neighbours see with few samples averages to nearly the closed form.
    few = pattern(16, seed=5)
    hidden = (np.arccos(0.3) - 0.3 * np.sqrt(1 - 0.09)) / np.pi
    scene = wall(0.3)
    at = points([0, 0, 0], (0, 0, 1))
    each = [seen(scene, at, 1.0, few, tile)[0] for tile in range(4)]
    assert np.mean(each) == pytest.approx(1 - hidden, abs=0.02)
    assert np.ptp(each) > 0


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
    pixel = np.arange(12 * 10)
    traced = is_traced(pixel, 12).reshape(10, 12)
    assert traced[::EVERY, ::EVERY].all()
    assert traced.sum() * EVERY**2 == traced.size
    tile = tile_of(pixel, 12).reshape(10, 12)[::EVERY, ::EVERY]
    for row in range(len(tile) - 1):
        for col in range(tile.shape[1] - 1):
            assert sorted(tile[row : row + 2, col : col + 2].ravel()) == [0, 1, 2, 3]


# What neighbours lend each other


def picture(visible, depth=None, normal=None):
    visible = np.array(visible, np.float32)
    depth = np.ones(visible.shape) if depth is None else np.broadcast_to(depth, visible.shape)
    if normal is None:
        normal = np.zeros((*visible.shape, 3))
        normal[..., 2] = np.isfinite(depth)
    return VisibilityPicture(
        visible,
        np.array(depth, np.float32),
        np.array(normal, np.float32),
        np.full(visible.shape, 0.1, np.float32),
    )


def around(one):
    """At every pixel centre, as frames ask."""
    shape = one.visible.shape
    pixel = np.arange(one.visible.size)
    return one.around(pixel, one.depth.ravel(), one.normal.reshape(-1, 3)).reshape(shape)


def beside(one):
    pixel = np.arange(one.visible.size)
    found = one.beside(pixel, one.depth.ravel(), one.normal.reshape(-1, 3))
    return found.reshape(one.visible.shape)


def test_pixels_between_take_the_mean_of_the_four_traced_ones():
    known = np.full((6, 6), -1.0)
    known[::2, ::2] = [[0, 1, 0], [1, 0, 1], [0, 1, 0]]
    mean = around(picture(known))
    assert mean[1, 1] == pytest.approx(0.5)
    assert ((mean >= 0) & (mean <= 1)).all()


def test_a_step_in_depth_separates():
    visible = [[0, 0, 0, 1, 1, 1]] * 6
    depth = np.where(np.array(visible) > 0, 5.0, 1.0)
    for found in (around(picture(visible, depth)), beside(picture(visible, depth))):
        assert (found == visible).all()


def test_a_crease_separates():
    visible = [[0, 0, 0, 1, 1, 1]] * 6
    normal = np.zeros((6, 6, 3))
    normal[:, :3, 2] = 1
    normal[:, 3:, 0] = 1
    one = picture(visible, normal=normal)
    assert (around(one) == visible).all()
    assert (beside(one) == visible).all()


def test_a_slope_does_not_separate():
    visible = np.indices((6, 6)).sum(axis=0) % 2
    depth = 1.0 + 0.05 * np.arange(6)
    assert beside(picture(visible, depth))[1:-1, 1:-1] == pytest.approx(
        np.full((4, 4), 0.5), abs=0.06
    )


def test_a_point_of_another_surface_than_all_about_it_gets_nothing():
    one = picture(np.ones((4, 4)))
    pixel = np.array([5, 5, 5])
    depth = np.array([1.0, 9.0, 1.0], np.float32)
    normal = np.array([[0, 0, 1], [0, 0, 1], [1, 0, 0]], np.float32)
    assert one.beside(pixel, depth, normal).tolist() == [1, -1, -1]


def test_the_background_lends_nothing():
    depth = np.array([[1.0, 1.0, np.inf, np.inf]] * 4)
    visible = np.where(np.isfinite(depth), 1.0, 0.0)
    found = beside(picture(visible, depth))
    assert (found[:, :2] == 1).all()
