"""Rays that leave surfaces: where they start and where they go."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from raysvc.shading.scene_tables import SceneTables
from raysvc.tracing.reflection import mirror_rays, rays_from, rays_towards
from raysvc.tracing.world import World
from tests.scenes import mesh
from tests.tracing.points import points

SEEDS = st.integers(0, 2**32 - 1)
UP = np.array([0, 0, 1.0])


def unit(v):
    return np.asarray(v, float) / np.linalg.norm(v, axis=-1, keepdims=True)


def test_a_mirror_turns_the_view_about_its_normal():
    view = unit([3, 0, 4])
    asked = mirror_rays(points([0, 0, 0], UP, view=view))
    assert asked.directions[0] == pytest.approx(unit([-3, 0, 4]), abs=1e-6)
    assert np.isinf(asked.t_max).all()


@settings(deadline=None, max_examples=50)
@given(SEEDS)
def test_mirror_rays_are_unit_and_leave_the_triangle(seed):
    rng = np.random.default_rng(seed)
    normal = unit(rng.normal(size=3))
    view = unit(rng.normal(size=(40, 3)))
    view *= np.sign(view @ normal)[:, None]
    bent = unit(normal + rng.normal(size=(40, 3)) * 0.5)
    surface = points(rng.normal(size=(40, 3)), bent, geometric_normal=normal, view=view)
    directions = mirror_rays(surface).directions.astype(float)
    assert np.linalg.norm(directions, axis=1) == pytest.approx(np.ones(40), abs=1e-5)
    assert (directions @ normal >= -1e-6).all()
    mirrored = 2 * np.einsum("nk,nk->n", bent, view)[:, None] * bent - view
    straight = mirrored @ normal > 1e-3
    assert directions[straight] == pytest.approx(mirrored[straight], abs=1e-5)


def test_rays_start_on_the_side_to_which_they_go():
    surface = points([[1, 2, 3], [1, 2, 3]], UP)
    asked = rays_from(surface, np.array([[0, 0, 1], [0, 0, -1]]), np.array([1.0, 2.0]))
    assert asked.origins[0, 2] > 3 > asked.origins[1, 2]
    assert asked.t_max.tolist() == [1, 2]
    assert np.abs(asked.origins[:, 2] - 3).max() < 1e-3


@settings(deadline=None, max_examples=60)
@given(SEEDS, st.sampled_from([1e-2, 1.0, 30.0, 1e3]), st.sampled_from([0.0, 1.0, 100.0]))
@pytest.mark.parametrize("structure", ["brute", "auto"])
def test_a_triangle_never_shadows_itself(structure, seed, size, away):
    rng = np.random.default_rng(seed)
    corners = rng.uniform(-size, size, (3, 3)) + rng.uniform(-away, away, 3)
    scene = mesh(corners, [[0, 1, 2]])
    tables = SceneTables.of(scene)
    weights = rng.dirichlet([1, 1, 1], 200)[:, :2].astype(np.float32)
    arriving = unit(rng.normal(size=(200, 3))).astype(np.float32)
    surface = tables.surface(np.zeros(200, np.int32), weights, arriving)
    leaving = unit(rng.normal(size=(200, 3)))
    asked = rays_from(surface, leaving, np.full(200, np.inf))
    assert (World(scene, tables, structure).transmittance(asked) == 1).all()
    assert (World(scene, tables, structure).transmittance(mirror_rays(surface)) == 1).all()


def test_rays_end_at_the_places_they_are_sent_to(rng):
    at = rng.uniform(-50, 50, (200, 3)).astype(np.float32)
    surface = points(at, (0, 0, 1))
    index = rng.integers(0, 200, 300)
    direction = rng.normal(size=(300, 3))
    direction = (direction / np.linalg.norm(direction, axis=1)[:, None]).astype(np.float32)
    distance = rng.uniform(0.1, 20, 300).astype(np.float32)
    distance[::5] = np.inf
    found = rays_towards(surface, direction, distance, index)
    near = np.isfinite(distance)
    ends = found.origins + found.directions * found.t_max[:, None]
    expected = at[index] + direction * distance[:, None]
    np.testing.assert_allclose(ends[near], expected[near], atol=2e-5)
    np.testing.assert_array_equal(found.directions[~near], direction[~near])
    assert (found.t_max[~near] == np.inf).all()
    np.testing.assert_allclose(np.linalg.norm(found.directions, axis=1), 1, rtol=1e-6)
    # They start off the surface, on the side to which they go
    off = (found.origins - at[index])[:, 2]
    assert (off * direction[:, 2] > 0).all()
