"""Our own structures agree with testing everything to the bit, whatever their parameters."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from raysvc.accel.base import Rays, Triangles
from raysvc.accel.registry import build
from raysvc.builtin.shapes import torus
from tests.accel.variants import VARIANTS
from tests.scenes import rays, soup

each_variant = pytest.mark.parametrize("variant", VARIANTS)


def agree(variant, scene, asked):
    """Same triangles as brute force, for both questions, and return them."""
    name, parameters = VARIANTS[variant]
    structure, brute = build(name, scene, parameters), build("brute", scene)
    found = structure.nearest_triangle(asked)
    np.testing.assert_array_equal(found, brute.nearest_triangle(asked))
    np.testing.assert_array_equal(structure.occluded(asked), brute.occluded(asked))
    return found


def lattice(rng, count):
    """Triangles with small whole coordinates: many share planes, edges, places and numbers."""
    corners = rng.integers(0, 5, (count, 3, 3)).astype(np.float32)
    return corners.reshape(-1, 3), np.arange(3 * count, dtype=np.int32).reshape(-1, 3)


@each_variant
@settings(deadline=None, max_examples=15)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 300), size=st.floats(0.01, 2.0))
def test_random_triangles(variant, seed, count, size):
    rng = np.random.default_rng(seed)
    scene = Triangles(*soup(rng, count, size=size))
    origins, directions = rng.uniform(-2, 2, (300, 3)), rng.normal(size=(300, 3))
    agree(variant, scene, rays(origins, directions, rng.uniform(0, 4, 300)))


@each_variant
@settings(deadline=None, max_examples=15)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 120))
def test_rays_through_corners_edges_and_planes(variant, seed, count):
    rng = np.random.default_rng(seed)
    scene = Triangles(*lattice(rng, count))
    origins = rng.integers(-2, 14, (600, 3)) / 2
    directions = rng.integers(-2, 3, (600, 3)).astype(np.float32)
    directions[rng.random((600, 3)) < 0.3] *= np.float32(-0.0)
    directions[(directions == 0).all(axis=1), 0] = 1
    agree(variant, scene, rays(origins, directions))


@each_variant
@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("place", [0.0, 0.25])
def test_triangles_all_in_one_plane(variant, axis, place, rng):
    corners, indices = lattice(rng, 60)
    corners[:, axis] = place
    asked = rays(rng.uniform(-1, 5, (400, 3)), rng.normal(size=(400, 3)))
    found = agree(variant, Triangles(corners, indices), asked)
    assert (found >= 0).any()


@each_variant
@pytest.mark.parametrize("scale", [1e-18, 1e-6, 1e6, 1e15])
def test_tiny_and_huge_scenes(variant, scale, rng):
    positions, indices = soup(rng, 150, scale=scale)
    asked = rays(rng.uniform(-2, 2, (400, 3)) * scale, rng.normal(size=(400, 3)))
    assert (agree(variant, Triangles(positions, indices), asked) >= 0).any()


@each_variant
def test_scenes_whose_sizes_differ_by_many_powers_of_two(variant, rng):
    positions, indices = soup(rng, 400)
    shrunk = np.float32(2.0) ** -np.arange(0, 40, 0.1)[:, None, None]
    positions = (positions.reshape(-1, 3, 3) * shrunk).astype(np.float32).reshape(-1, 3)
    name, parameters = VARIANTS[variant]
    scene = Triangles(positions, indices)
    assert build(name, scene, parameters).report.max_depth <= 80
    agree(variant, scene, rays(rng.uniform(-1, 1, (400, 3)) * 0.01, rng.normal(size=(400, 3))))


@each_variant
def test_very_many_triangles_in_one_place(variant, rng):
    corners = np.tile(rng.uniform(-1, 1, (1, 3, 3)), (1000, 1, 1)).astype(np.float32)
    scene = Triangles(corners.reshape(-1, 3), np.arange(3000, dtype=np.int32).reshape(-1, 3))
    middle = corners[0].mean(axis=0)
    origins = rng.uniform(-3, 3, (20, 3)).astype(np.float32)
    found = agree(variant, scene, rays(origins, middle - origins))
    assert (found == 0).all()


@each_variant
def test_no_ray_escapes_from_a_torus(variant, rng):
    surface = torus(1.0, 0.4, 24, 2000)
    positions = surface.positions.astype(np.float32)
    scene = Triangles(positions, surface.triangles.astype(np.int32))
    angle = rng.uniform(0, 2 * np.pi, 4000)
    origins = np.stack([np.cos(angle), np.zeros(4000), np.sin(angle)], axis=1).astype(np.float32)
    targets = positions[rng.integers(0, len(positions), 4000)]
    assert (agree(variant, scene, rays(origins, targets - origins)) >= 0).all()


@each_variant
def test_an_answer_does_not_depend_on_what_is_asked_beside_it(variant, rng):
    name, parameters = VARIANTS[variant]
    structure = build(name, Triangles(*soup(rng, 200)), parameters)
    asked = rays(rng.uniform(-2, 2, (100, 3)), rng.normal(size=(100, 3)))
    together = structure.nearest_triangle(asked)
    alone = [
        structure.nearest_triangle(
            Rays(asked.origins[r : r + 1], asked.directions[r : r + 1], asked.t_max[r : r + 1])
        )[0]
        for r in range(100)
    ]
    assert together.tolist() == alone


def test_a_hit_behind_the_cell_does_not_hide_a_nearer_one():
    # A long triangle is met far behind the cell that it shares with the ray's origin; in the next
    # cells a small one is nearer.
    small = [[[x, -0.1, -0.1], [x, 0.3, -0.1], [x, -0.1, 0.3]] for x in (2.0, 3.0, 4.0)]
    long = [[-1, -1, 0.5], [-1, 1, 0.5], [9, 0, -0.05]]
    corners = np.array([long, *small], np.float32).reshape(-1, 3)
    scene = Triangles(corners, np.arange(12, dtype=np.int32).reshape(-1, 3))
    ray = rays([-1, 0, 0], [1, 0, 0])
    for cost, bonus in itertools.product((0.0, 0.5, 2.0), (0.0, 0.5)):
        kd = build("kd", scene, {"traversal_cost": cost, "empty_bonus": bonus, "max_depth": 8})
        assert kd.nearest_triangle(ray).tolist() == [1]
