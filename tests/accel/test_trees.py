"""Trees: what is reported of them, their quality, and moved vertices."""

import time

import numpy as np
import pytest

from raysvc.accel.base import Triangles
from raysvc.accel.quality import quality_of, with_quality
from raysvc.accel.registry import STRUCTURES, build
from tests.accel.variants import VARIANTS
from tests.oracles.tree_quality import end_point_overlap, surface_area_cost
from tests.scenes import rays, soup

each_variant = pytest.mark.parametrize("variant", VARIANTS)


def built(variant, scene):
    name, parameters = VARIANTS[variant]
    return build(name, scene, parameters)


@each_variant
def test_the_report_is_that_of_the_tree(variant, rng):
    scene = Triangles(*soup(rng, 300))
    structure = built(variant, scene)
    shape, report = structure.shape(), structure.report
    leaves = shape.left < 0
    depth = np.zeros(len(shape.left), int)
    for node in np.flatnonzero(~leaves):
        depth[shape.left[node]] = depth[shape.left[node] + 1] = depth[node] + 1
    assert report.nodes == len(leaves) == 2 * leaves.sum() - 1
    assert report.leaves == leaves.sum()
    assert report.empty_leaves == (shape.count[leaves] == 0).sum()
    assert report.max_depth == depth[leaves].max()
    assert report.mean_depth == pytest.approx(depth[leaves].mean())
    assert report.triangle_references == shape.count[leaves].sum() == len(shape.order)
    assert report.mean_triangles_per_leaf == pytest.approx(shape.count[leaves].mean())
    filled = shape.count[leaves & (shape.count > 0)]
    assert report.mean_triangles_per_nonempty_leaf == pytest.approx(filled.mean())
    assert report.duplication == pytest.approx(len(shape.order) / 300)
    assert report.tree_mib == pytest.approx((report.node_bytes + report.index_bytes) / 2**20)
    assert report.sah_cost == pytest.approx(surface_area_cost(shape), rel=1e-6)
    assert set(shape.order.tolist()) == set(range(300))


@each_variant
def test_cells_lie_in_their_parents_and_hold_their_triangles(variant, rng):
    scene = Triangles(*soup(rng, 400, size=0.05))
    name = VARIANTS[variant][0]
    shape = built(variant, scene).shape()
    boxes = shape.boxes.reshape(-1, 6)
    inner = np.flatnonzero(shape.left >= 0)
    for child in (shape.left[inner], shape.left[inner] + 1):
        filled = (boxes[child, :3] <= boxes[child, 3:]).all(axis=1)
        assert (boxes[child, :3] >= boxes[inner, :3])[filled].all()
        assert (boxes[child, 3:] <= boxes[inner, 3:])[filled].all()
    if name != "kd":  # whose cells cut triangles
        corners = scene.positions[scene.indices[shape.order]]
        for leaf in np.flatnonzero(shape.left < 0):
            held = corners[shape.first[leaf] : shape.first[leaf] + shape.count[leaf]]
            assert (held >= boxes[leaf, :3]).all()
            assert (held <= boxes[leaf, 3:]).all()


def test_clipping_spares_leaves_in_empty_space(rng):
    # Small triangles far apart: most rays miss all of them.
    scene = Triangles(*soup(rng, 2000, size=0.01))
    asked = rays(rng.uniform(-1, 1, (1000, 3)), rng.normal(size=(1000, 3)))
    by_area = build("bih", scene).counted(asked, "nearest")
    by_middle = build("bih", scene, {"split": "middle"}).counted(asked, "nearest")
    assert by_area.leaves.mean() < 0.7 * by_middle.leaves.mean()
    assert by_area.triangle_tests.mean() < 0.7 * by_middle.triangle_tests.mean()


@each_variant
def test_end_point_overlap_is_that_of_the_slow_way(variant, rng):
    scene = Triangles(*soup(rng, 60, size=0.5))
    structure = built(variant, scene)
    quality = quality_of(structure, scene)
    expected = end_point_overlap(structure.shape(), scene.positions, scene.indices)
    assert quality.epo == pytest.approx(expected, rel=1e-6, abs=1e-9)
    assert quality.epo_triangles == 60


def test_end_point_overlap_of_a_sample_is_near_and_says_so(rng):
    scene = Triangles(*soup(rng, 3000, size=0.2))
    structure = build("bvh", scene)
    whole, part = quality_of(structure, scene), quality_of(structure, scene, epo_triangles=600)
    assert whole.epo_triangles == 3000
    assert part.epo_triangles == 600
    assert part.epo == pytest.approx(whole.epo, rel=0.15)
    assert part == quality_of(structure, scene, epo_triangles=600)
    assert with_quality(structure.report, part).epo == part.epo


def test_what_cannot_be_seen_is_none(rng):
    scene = Triangles(*soup(rng, 20))
    for name in ("embree", "brute"):
        if STRUCTURES[name].why_not() is None:
            assert quality_of(build(name, scene), scene).epo is None


@each_variant
def test_moved_vertices_are_met_where_they_are(variant, rng):
    positions, indices = soup(rng, 400)
    structure = built(variant, Triangles(positions, indices))
    moved = positions + rng.normal(size=positions.shape).astype(np.float32) * np.float32(0.2)
    refitted = structure.refitted(moved)
    scene = Triangles(moved, indices)
    asked = rays(rng.uniform(-2, 2, (500, 3)), rng.normal(size=(500, 3)))
    expected = build("brute", scene).nearest_triangle(asked)
    np.testing.assert_array_equal(refitted.nearest_triangle(asked), expected)
    np.testing.assert_array_equal(refitted.occluded(asked), expected >= 0)
    if structure.refits:
        np.testing.assert_array_equal(refitted.shape().order, structure.shape().order)
        assert refitted.report.nodes == structure.report.nodes
        assert refitted.report.sah_cost > structure.report.sah_cost
    # The structure that was asked is as it was.
    first = build("brute", Triangles(positions, indices)).nearest_triangle(asked)
    np.testing.assert_array_equal(structure.nearest_triangle(asked), first)


def test_refitting_what_has_not_moved_changes_nothing(rng):
    scene = Triangles(*soup(rng, 200))
    structure = build("bvh", scene)
    refitted = structure.refitted(scene.positions)
    boxes = [np.unique(tree.shape().boxes.reshape(-1, 6), axis=0) for tree in (refitted, structure)]
    np.testing.assert_array_equal(boxes[0], boxes[1])
    assert refitted.report.sah_cost == pytest.approx(structure.report.sah_cost, rel=1e-12)


@each_variant
def test_which_structures_keep_their_tree_is_said(variant, rng):
    name, parameters = VARIANTS[variant]
    scene = Triangles(*soup(rng, 5))
    keeps = name in ("bvh", "bvh_stackless") or (name == "bih" and "split" not in parameters)
    assert built(variant, scene).refits == keeps
    assert not build("brute", scene).refits


TURNS = {
    "half a turn": np.diag([-1, 1, -1]),
    "mirrored": np.diag([1, -1, 1]),
    "a quarter of a turn": np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]]),
}


@pytest.mark.parametrize("turn", TURNS)
@pytest.mark.parametrize("name", ["bvh", "bvh_stackless", "bih"])
def test_a_tree_that_was_turned_is_as_quick_as_one_built_there(name, turn, rng):
    positions, indices = soup(rng, 3000, size=0.05)
    turned = np.ascontiguousarray(positions @ TURNS[turn].T.astype(np.float32))
    built_there = build(name, Triangles(turned, indices))
    refitted = build(name, Triangles(positions, indices)).refitted(turned)
    asked = rays(rng.uniform(-1, 1, (500, 3)), rng.normal(size=(500, 3)))
    ours, theirs = refitted.counted(asked, "nearest"), built_there.counted(asked, "nearest")
    np.testing.assert_array_equal(ours.triangle, theirs.triangle)
    assert ours.node_steps.sum() < 1.05 * theirs.node_steps.sum()
    assert refitted.report.sah_cost == pytest.approx(built_there.report.sah_cost, rel=0.02)


@pytest.mark.parametrize("name", ["bvh", "bvh_stackless", "bih"])
def test_the_time_of_a_refit_is_all_that_it_takes(name, rng):
    structure, moved = build(name, Triangles(*soup(rng, 20_000))), soup(rng, 20_000)[0]
    start = time.perf_counter()
    refitted = structure.refitted(moved)
    taken_ms = 1000.0 * (time.perf_counter() - start)
    assert 0.5 * taken_ms < refitted.report.build_ms < taken_ms
