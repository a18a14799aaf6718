"""A scene cut into patches: every point has one, and their samples lie on them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from raysvc.accel.base import Hits
from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import box, sphere
from raysvc.scene import Material
from raysvc.shading.scene_tables import SceneTables
from raysvc.tracing import patches as module
from raysvc.tracing.patches import SAMPLES, Patches
from tests.scenes import mesh, quad, soup

TWO_SIDED = Material(metallic=0.0, double_sided=True)


def cut(scene):
    return Patches.of(scene, SceneTables.of(scene))


def met(patches, triangle, barycentric, directions):
    count = len(triangle)
    hits = Hits(np.ones(count, "f4"), np.asarray(triangle, np.int32), np.asarray(barycentric, "f4"))
    return patches.met(hits, np.asarray(directions, "f4"))


def place_of(scene, triangle, barycentric):
    corners = scene.positions[scene.triangles[triangle]].astype(float)
    u, v = np.asarray(barycentric, float).T
    weights = np.stack([1 - u - v, u, v], axis=1)
    return np.einsum("nk,nkc->nc", weights, corners)


@pytest.mark.parametrize("material", [Material(metallic=0.0), TWO_SIDED])
def test_a_patch_meets_its_own_samples(material):
    scene = scene_of("ball", [Part(sphere(1.0, 30), 0), Part(box(6, 0.1, 6), 0)], [material])
    patches = cut(scene)
    found = met(patches, patches.triangle, patches.barycentric, -patches.towards)
    assert (found == np.repeat(np.arange(patches.count), SAMPLES)).all()


def test_a_large_triangle_is_cut_into_small_patches():
    patches = cut(quad(half=5.0))
    places = place_of(quad(half=5.0), patches.triangle, patches.barycentric)
    extent = np.ptp(places.reshape(-1, SAMPLES, 3), axis=1)
    assert module.CELLS / 2 < patches.count < 2 * module.CELLS
    assert extent.max() < 3 * patches.size_m


@settings(deadline=None, max_examples=20)
@given(st.integers(0, 2**32 - 1))
def test_neighbouring_points_of_a_triangle_are_in_one_or_neighbouring_patches(seed):
    rng = np.random.default_rng(seed)
    scene = quad(half=2.0)
    patches = cut(scene)
    weights = rng.dirichlet([1, 1, 1], 200)[:, :2]
    triangle = rng.integers(0, 2, 200)
    patch = met(patches, triangle, weights, np.tile([0, 0, -1.0], (200, 1)))
    samples = place_of(scene, patches.triangle, patches.barycentric).reshape(-1, SAMPLES, 3)
    away = samples[patch] - place_of(scene, triangle, weights)[:, None]
    assert np.linalg.norm(away, axis=2).max() < 3 * patches.size_m


def test_sides_that_face_different_ways_are_different_patches_if_both_are_seen():
    directions = np.array([[0, 0, -1.0], [0, 0, 1.0]])
    one = met(cut(quad()), [0, 0], [[0.3, 0.3]] * 2, directions)
    both = met(cut(quad(TWO_SIDED)), [0, 0], [[0.3, 0.3]] * 2, directions)
    assert one[0] == one[1]
    assert both[0] != both[1]


def test_what_shares_a_cell_and_faces_alike_shares_a_patch(rng):
    # Many tiny leaves in one place, and one far away
    positions, triangles = soup(rng, 500, size=1e-4, scale=1e-3)
    positions[:, 2] = 0
    scene = mesh(
        np.concatenate([positions, [(9, 0, 0), (10, 0, 0), (9, 1, 0)]]),
        np.concatenate([triangles, [[1500, 1501, 1502]]]),
        materials=(TWO_SIDED,),
    )
    patches = cut(scene)
    leaf = met(patches, np.arange(500), np.full((500, 2), 0.3), np.tile([0, 0, -1.0], (500, 1)))
    assert len(np.unique(leaf)) <= 8
    assert met(patches, [500], [[0.3, 0.3]], [[0, 0, -1.0]])[0] not in leaf


def test_the_number_of_patches_is_bounded(rng, monkeypatch):
    monkeypatch.setattr(module, "MAX_PATCHES", 500)
    positions, triangles = soup(rng, 3000, size=0.05)
    patches = cut(mesh(positions, triangles, materials=(TWO_SIDED,)))
    assert 50 < patches.count <= 500


def test_misses_have_no_patch_and_degenerate_triangles_do_no_harm():
    scene = mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [[0, 1, 2], [0, 1, 1], [2, 2, 2]])
    patches = cut(scene)
    assert met(patches, [-1, 0], [[0, 0], [0.2, 0.2]], [[0, 0, -1.0]] * 2)[0] == -1
    assert np.isfinite(patches.towards).all() and np.isfinite(patches.barycentric).all()
    nothing = cut(mesh([(0, 0, 0)], np.zeros((0, 3))))
    assert nothing.count == 0 and len(nothing.triangle) == 0
