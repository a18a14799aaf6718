import numpy as np
import pytest

import raysvc
from raysvc.accel.base import Rays, Triangles
from raysvc.accel.forest import MOST_TREES, Forest
from raysvc.accel.registry import build
from raysvc.errors import LimitExceeded
from tests.scenes import rays, soup

OURS = ("brute", "bvh")


def random_rays(rng, count, t_max=np.inf):
    return rays(rng.uniform(-1.5, 1.5, (count, 3)), rng.normal(size=(count, 3)), t_max)


def soup_in_groups(rng, groups=5, count=400):
    """Triangles, every tenth of them twice in another group, so that there are ties."""
    positions, indices = soup(rng, count)
    indices = np.concatenate([indices, indices[::10]])
    group = rng.integers(0, groups, len(indices)).astype(np.int32)
    return Triangles(positions, indices), group


@pytest.mark.parametrize("name", OURS)
@pytest.mark.parametrize("t_max", [np.inf, 0.6])
def test_trees_of_groups_answer_as_one_tree_to_the_bit(name, t_max, rng):
    triangles, group = soup_in_groups(rng)
    one, forest = build(name, triangles), Forest(name, triangles, group)
    some = random_rays(rng, 2000, t_max)
    assert len(forest.trees) == 5
    np.testing.assert_array_equal(forest.nearest_triangle(some), one.nearest_triangle(some))
    np.testing.assert_array_equal(forest.occluded(some), one.occluded(some))
    assert (one.nearest_triangle(some) >= 0).any()


def test_the_rays_that_are_asked_stay_as_they_were(rng):
    triangles, group = soup_in_groups(rng)
    some = random_rays(rng, 100, 5.0)
    Forest("brute", triangles, group).nearest_triangle(some)
    assert (some.t_max == 5.0).all()


@pytest.mark.parametrize("query", ["nearest", "occluded"])
def test_counting_gives_the_same_answers_and_adds_up(query, rng):
    triangles, group = soup_in_groups(rng)
    forest, some = Forest("bvh", triangles, group), random_rays(rng, 500)
    counters = forest.counted(some, query)
    assert counters is not None
    if query == "nearest":
        np.testing.assert_array_equal(counters.triangle, forest.nearest_triangle(some))
    np.testing.assert_array_equal(counters.triangle >= 0, forest.occluded(some))
    alone = [tree.counted(some, query) for tree in forest.trees]
    assert counters.node_steps.sum() <= sum(part.node_steps.sum() for part in alone)
    assert counters.max_stack_depth.max() <= max(part.max_stack_depth.max() for part in alone)
    if query == "nearest":
        # Every tree's root is fetched by every ray.
        assert (counters.node_steps >= len(forest.trees)).all()


def test_the_report_joins_those_of_the_trees(rng):
    triangles, group = soup_in_groups(rng)
    forest = Forest("bvh", triangles, group)
    reports = [tree.report for tree in forest.trees]
    assert forest.report.triangles == len(triangles.indices)
    assert forest.report.triangle_references == len(triangles.indices)
    assert forest.report.nodes == sum(report.nodes for report in reports)
    assert forest.report.max_depth == max(report.max_depth for report in reports)
    depths = [report.mean_depth for report in reports]
    assert min(depths) <= forest.report.mean_depth <= max(depths)
    assert forest.report.sah_cost < sum(report.sah_cost for report in reports)


def test_moved_vertices_are_answered_for(rng):
    triangles, group = soup_in_groups(rng)
    moved = (triangles.positions + np.float32(0.2)).astype(np.float32)
    some = random_rays(rng, 500)
    expected = build("brute", Triangles(moved, triangles.indices)).nearest_triangle(some)
    forest = Forest("bvh", triangles, group).refitted(moved)
    np.testing.assert_array_equal(forest.nearest_triangle(some), expected)


def test_nothing_at_all_is_met_by_nothing():
    nothing = Triangles(np.zeros((0, 3), np.float32), np.zeros((0, 3), np.int32))
    forest = Forest("bvh", nothing, np.zeros(0, np.int32))
    some = Rays(*(np.ones((4, 3), np.float32) for _ in range(2)), np.ones(4, np.float32))
    assert (forest.nearest_triangle(some) == -1).all()
    assert not forest.occluded(some).any()


def test_more_materials_than_trees_are_refused(rng):
    positions, indices = soup(rng, MOST_TREES + 1)
    with pytest.raises(LimitExceeded, match="trees"):
        Forest("brute", Triangles(positions, indices), np.arange(len(indices), dtype=np.int32))


@pytest.mark.parametrize("scene", ["builtin:cornell", "builtin:shiny"])
@pytest.mark.parametrize("structure", ["bvh", "embree"])
def test_a_picture_is_the_same_with_a_tree_per_material(scene, structure):
    loaded = raysvc.load(scene)
    camera = {"width": 64, "height": 48, "gltf_camera": 0}
    pictures = [
        raysvc.render(loaded, None, camera, {"structure": structure, "trees": trees})
        for trees in ("one", "per_material")
    ]
    assert pictures[0].encode("npz") == pictures[1].encode("npz")
