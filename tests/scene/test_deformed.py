"""Scenes with their vertices elsewhere: what is refused, and where normals and tangents go."""

import gc
import weakref

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import raysvc
from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import box, sheet, sphere, torus
from raysvc.errors import InvalidScene
from raysvc.scene import Scene
from tests.frame.subjects import GREY
from tests.oracles.carried import carried
from tests.scenes import mesh, soup

SEEDS = st.integers(0, 2**32 - 1)


def shape_of(*meshes) -> Scene:
    return scene_of("shape", [Part(one, 0) for one in meshes], [GREY])


def rotation(rng):
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return turn * np.sign(np.linalg.det(turn))


def bent(positions, amount=0.4):
    """Positions after a smooth deformation that leaves no direction as it was."""
    x, y, z = positions.astype(float).T
    return np.stack(
        [
            x + amount * np.sin(2 * y + z),
            y * (1 + 0.5 * amount * np.cos(3 * x)),
            z + amount * x * y,
        ],
        axis=1,
    )


def angles_deg(a, b):
    cosine = np.einsum("nk,nk->n", a.astype(float), b.astype(float))
    return np.degrees(np.arccos(np.clip(cosine, -1, 1)))


@settings(deadline=None, max_examples=30)
@given(SEEDS, st.floats(0.01, 100))
def test_what_is_turned_moved_and_scaled_keeps_its_normals_turned(seed, scale):
    rng = np.random.default_rng(seed)
    scene = shape_of(torus(1.0, 0.4, 12, 400), box(0.5, 0.7, 0.3).moved([2, 0, 0]))
    turn = rotation(rng)
    deformed = scene.deformed(scale * (scene.positions @ turn.T + rng.normal(size=3)))
    np.testing.assert_allclose(deformed.normals, scene.normals @ turn.T, atol=1e-4)
    np.testing.assert_allclose(deformed.tangents[:, :3], scene.tangents[:, :3] @ turn.T, atol=1e-4)
    np.testing.assert_array_equal(deformed.tangents[:, 3], scene.tangents[:, 3])


@settings(deadline=None, max_examples=20)
@given(SEEDS)
def test_normals_and_tangents_go_where_the_slow_way_takes_them(seed):
    rng = np.random.default_rng(seed)
    # Few places, so that many vertices share one; few directions, so that some agree.
    places = rng.uniform(-1, 1, (8, 3)).astype(np.float32)
    directions = np.concatenate([np.eye(3), -np.eye(3)])
    triangles = rng.integers(0, 30, (25, 3))
    triangles[0] = 5, 5, 7  # without area
    at = rng.integers(0, 8, 30)
    tangents = np.column_stack([directions[rng.integers(0, 6, 30)], rng.integers(-1, 2, 30)])
    scene = mesh(
        places[at], triangles, normals=directions[rng.integers(0, 6, 30)], tangents=tangents
    )
    moved = bent(scene.positions)
    moved[rng.integers(0, 30, 4)] += 0.1  # torn
    deformed = scene.deformed(moved)
    normals, expected_tangents = carried(scene, moved)
    np.testing.assert_allclose(deformed.normals, normals, atol=1e-5)
    np.testing.assert_allclose(deformed.tangents, expected_tangents, atol=1e-4)


def test_normals_that_are_those_of_flat_triangles_stay_so():
    scene = shape_of(box(1.0, 1.0, 1.0))
    sheared = scene.positions @ np.array([[1, 0.3, 0], [0, 1, 0.2], [0.4, 0, 2]]).T
    deformed = scene.deformed(sheared)
    corners = deformed.positions[deformed.triangles].astype(float)
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    across /= np.linalg.norm(across, axis=1)[:, None]
    for corner in range(3):
        np.testing.assert_allclose(
            deformed.normals[deformed.triangles[:, corner]], across, atol=1e-6
        )


@pytest.mark.parametrize("rings", [16, 64])
def test_a_sphere_that_is_stretched_has_the_normals_of_an_ellipsoid(rings):
    scene, axes = shape_of(sphere(1.0, rings)), np.array([1.0, 0.6, 1.7])
    deformed = scene.deformed(scene.positions * axes)
    exact = deformed.positions / axes**2
    exact /= np.linalg.norm(exact, axis=1)[:, None]
    # What is left falls with the size of the triangles; facets are 180 / rings degrees apart.
    assert angles_deg(deformed.normals, exact).max() < 0.4 * 180 / rings
    assert angles_deg(deformed.normals, exact).mean() < 0.05 * 180 / rings


def test_a_bent_surface_has_the_normals_of_the_bent_surface():
    scene = shape_of(sheet(2.0, 2.0, 60, 60))
    x, _, z = scene.positions.astype(float).T
    moved = np.stack([x, 0.3 * np.sin(3 * x) * np.cos(2 * z), z], axis=1)
    deformed = scene.deformed(moved)
    slope_x, slope_z = 0.9 * np.cos(3 * x) * np.cos(2 * z), -0.6 * np.sin(3 * x) * np.sin(2 * z)
    exact = np.stack([-slope_x, np.ones(len(x)), -slope_z], axis=1)
    exact /= np.linalg.norm(exact, axis=1)[:, None]
    inside = (np.abs(x) < 0.99) & (np.abs(z) < 0.99)
    assert angles_deg(deformed.normals[inside], exact[inside]).max() < 0.3
    along = np.stack([np.ones(len(x)), slope_x, np.zeros(len(x))], axis=1)
    along /= np.linalg.norm(along, axis=1)[:, None]
    assert angles_deg(deformed.tangents[inside, :3], along[inside]).max() < 0.3


def test_seams_stay_smooth_and_edges_stay_hard():
    scene = shape_of(torus(1.0, 0.4, 24, 1600), box(1.0, 1.0, 1.0).moved([3, 0, 0]))
    deformed = scene.deformed(bent(scene.positions))
    _, place = np.unique(scene.positions.round(5), axis=0, return_inverse=True)
    seams = edges = 0
    for number in np.flatnonzero(np.bincount(place) > 1):
        first, *others = np.flatnonzero(place == number)
        for other in others:
            if scene.normals[first] @ scene.normals[other] > 0.9999:
                np.testing.assert_array_equal(deformed.normals[first], deformed.normals[other])
                seams += 1
            else:
                assert angles_deg(*deformed.normals[[[first], [other]]])[0] > 20
                edges += 1
    assert seams > 50 and edges == 16


def test_a_seam_that_was_computed_twice_with_other_rounding_stays_smooth():
    scene = shape_of(torus(1.0, 0.4, 24, 1600))
    noise = np.random.default_rng(1).uniform(-1, 1, scene.positions.shape)
    deformed = scene.deformed(bent(scene.positions) * (1 + 5e-8 * noise))
    _, place = np.unique(scene.positions, axis=0, return_inverse=True)
    for number in np.flatnonzero(np.bincount(place) > 1):
        kin = deformed.normals[place == number]
        np.testing.assert_array_equal(kin, np.broadcast_to(kin[0], kin.shape))


def test_a_surface_that_is_torn_has_no_common_normal_any_more():
    scene = shape_of(
        sheet(1.0, 1.0, 1, 1).moved([-0.5, 0, 0]), sheet(1.0, 1.0, 1, 1).moved([0.5, 0, 0])
    )
    right = scene.positions[:, 0] + (np.arange(8) >= 4) > 0.5
    turned = scene.positions.astype(float)
    turned[right] = np.stack([turned[right, 0], turned[right, 0] + 0.001, turned[right, 2]], axis=1)
    normals = scene.deformed(turned).normals
    np.testing.assert_allclose(normals[~right], [[0, 1, 0]] * 4, atol=1e-6)
    np.testing.assert_allclose(normals[right], [[-(0.5**0.5), 0.5**0.5, 0]] * 4, atol=1e-6)


def test_what_has_not_moved_is_not_touched():
    scene = raysvc.load("builtin:shiny")
    same = scene.deformed(scene.positions)
    for name in ("positions", "normals", "tangents"):
        np.testing.assert_array_equal(getattr(same, name), getattr(scene, name))
    moved = scene.positions.copy()
    torus_vertices = np.unique(scene.triangles[scene.object_of_triangle == 1])
    moved[torus_vertices] *= np.float32(1.1)
    deformed = scene.deformed(moved)
    others = np.setdiff1d(np.arange(len(moved)), torus_vertices)
    np.testing.assert_array_equal(deformed.normals[others], scene.normals[others])
    np.testing.assert_array_equal(deformed.tangents[others], scene.tangents[others])
    assert (deformed.tangents[torus_vertices] != scene.tangents[torus_vertices]).any()


def test_a_shape_does_not_depend_on_the_shapes_before_it():
    scene = shape_of(torus(1.0, 0.4, 12, 400))
    flat = scene.positions * np.float32([1, 0, 1])  # after which nothing could be carried back
    there = scene.deformed(bent(scene.positions))
    by_a_detour = scene.deformed(flat).deformed(2 * flat).deformed(bent(scene.positions))
    for name in ("positions", "normals", "tangents"):
        np.testing.assert_array_equal(getattr(by_a_detour, name), getattr(there, name))
    back = by_a_detour.deformed(scene.positions)
    np.testing.assert_array_equal(back.normals, scene.normals)
    assert back.rest is scene.rest is by_a_detour.rest
    assert there.is_deformed and not scene.is_deformed


def test_all_but_the_shape_is_shared():
    scene = raysvc.load("builtin:shiny")
    deformed = scene.deformed(bent(scene.positions))
    for name in ("uv", "colours", "triangles", "material_of_triangle", "object_of_triangle"):
        assert getattr(deformed, name) is getattr(scene, name)
    assert deformed.textures is scene.textures and deformed.materials is scene.materials
    used = deformed.positions[deformed.triangles].reshape(-1, 3)
    np.testing.assert_array_equal(deformed.bounds(), [used.min(axis=0), used.max(axis=0)])


def test_shapes_on_the_way_are_let_go():
    scene = shape_of(torus(1.0, 0.4, 12, 400))
    first = scene.deformed(2 * scene.positions)
    gone = [weakref.ref(scene), weakref.ref(first)]
    last = first.deformed(3 * scene.positions)
    del scene, first
    gc.collect()
    assert [ref() for ref in gone] == [None, None]
    assert last.deformed(last.rest.positions).normals.shape == last.normals.shape


def test_normals_may_be_given_for_one_shape():
    scene = shape_of(torus(1.0, 0.4, 12, 400))
    normals = np.random.default_rng(5).normal(size=scene.normals.shape) * 7
    deformed = scene.deformed(scene.positions, normals)
    expected = normals / np.linalg.norm(normals, axis=1)[:, None]
    np.testing.assert_allclose(deformed.normals, expected, atol=1e-6)
    held = deformed.tangents[:, 3] != 0
    assert held.mean() > 0.99
    across = np.einsum("nk,nk->n", deformed.normals, deformed.tangents[:, :3])[held]
    np.testing.assert_allclose(across, 0, atol=1e-4)
    np.testing.assert_array_equal(deformed.deformed(scene.positions).normals, scene.normals)


def test_a_vertex_whose_triangles_have_no_area_keeps_its_normal():
    scene = shape_of(torus(1.0, 0.4, 12, 400))
    np.testing.assert_array_equal(scene.deformed(0 * scene.positions).normals, scene.normals)
    unused = mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [5, 5, 5]], [[0, 1, 2]])
    moved = unused.deformed(unused.positions[:, [1, 2, 0]])
    np.testing.assert_array_equal(moved.normals[3], unused.normals[3])


def test_more_normals_at_one_place_than_are_told_apart_are_each_on_their_own(rng):
    normals = rng.normal(size=(3 * 200, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    positions, triangles = soup(rng, 200)
    positions[::3] = 0
    scene = mesh(positions, triangles, normals=normals)
    np.testing.assert_allclose(scene.deformed(2 * positions).normals, normals, atol=1e-5)


@pytest.mark.parametrize(
    ("positions", "says"),
    [
        (np.zeros((7, 3)), "needs the shape (8, 3), has (7, 3)"),
        (np.zeros((8, 2)), "needs the shape (8, 3), has (8, 2)"),
        (np.zeros(24), "needs the shape (8, 3), has (24,)"),
        (np.full((8, 3), np.nan), "has NaN or infinite values at vertex 0"),
        (np.where(np.arange(24) == 10, np.inf, 0).reshape(8, 3), "infinite values at vertex 3"),
        (np.full((8, 3), 1e300), "has NaN or infinite values at vertex 0"),
        (np.full((8, 3), 2e18), "has a coordinate beyond 1e+18"),
        (np.zeros((8, 3), complex), "needs real numbers, has complex128"),
        (np.full((8, 3), "a"), "needs real numbers, has <U1"),
        (np.zeros((8, 3), bool), "needs real numbers, has bool"),
        ([[0, 0, 0], [1]] * 4, "is not an array of numbers"),
    ],
)
def test_positions_that_are_not_positions_are_refused_by_name(positions, says):
    scene = shape_of(sheet(1, 1, 1, 1), sheet(1, 1, 1, 1))
    with pytest.raises(InvalidScene) as caught:
        scene.deformed(positions)
    assert caught.value.field == "positions"
    assert says in caught.value.message


def test_normals_that_have_no_direction_are_refused_by_name():
    scene = shape_of(sheet(1, 1, 1, 1))
    normals = np.ones((4, 3))
    normals[2] = 0
    for wrong, says in ((normals, "no direction at vertex 2"), (np.ones((3, 3)), "shape (4, 3)")):
        with pytest.raises(InvalidScene) as caught:
            scene.deformed(scene.positions, wrong)
        assert caught.value.field == "normals"
        assert says in caught.value.message


def test_the_caller_s_array_stays_the_caller_s():
    scene = shape_of(sheet(1, 1, 1, 1))
    positions = scene.positions.copy()
    deformed = scene.deformed(positions)
    positions += 1
    assert not np.array_equal(deformed.positions, positions)
    with pytest.raises(ValueError, match="read-only"):
        deformed.positions[0] = 0


def test_a_scene_without_anything_can_be_deformed_too():
    empty = mesh(np.zeros((0, 3)), np.zeros((0, 3)))
    assert empty.deformed(np.zeros((0, 3))).positions.shape == (0, 3)
