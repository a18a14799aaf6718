"""What the counting kernels say."""

import numpy as np
import pytest

from raysvc.accel.base import Triangles
from raysvc.accel.registry import STRUCTURES, build
from tests.accel.variants import VARIANTS
from tests.scenes import rays, soup


@pytest.fixture
def scene(rng):
    return Triangles(*soup(rng, 500))


@pytest.fixture
def asked(rng):
    return rays(rng.uniform(-2, 2, (300, 3)), rng.normal(size=(300, 3)))


@pytest.mark.parametrize("variant", VARIANTS)
def test_counting_changes_no_answer_and_every_number_is_possible(variant, scene, asked):
    name, parameters = VARIANTS[variant]
    structure = build(name, scene, parameters)
    nearest, occluded = structure.counted(asked, "nearest"), structure.counted(asked, "occluded")
    np.testing.assert_array_equal(nearest.triangle, structure.nearest_triangle(asked))
    np.testing.assert_array_equal(occluded.triangle >= 0, structure.occluded(asked))
    report = structure.report
    for counters in (nearest, occluded):
        assert (counters.leaves <= report.leaves).all()
        assert (counters.node_steps <= 2 * report.nodes).all()
        assert (counters.triangle_tests <= report.triangle_references).all()
        assert (counters.stack_writes <= counters.node_steps).all()
        assert (counters.max_stack_depth <= report.max_depth).all()
        assert ((counters.triangle_tests > 0) | (counters.triangle < 0)).all()
    assert (occluded.triangle_tests <= nearest.triangle_tests).all()
    assert nearest.bytes_touched.sum() > 0
    assert (nearest.plane_tests.sum() > 0) == (name in ("kd", "bih"))
    assert (nearest.box_tests.sum() > 0) == (name in ("bvh", "bvh_stackless"))
    again = structure.counted(asked, "nearest")
    np.testing.assert_array_equal(again.node_steps, nearest.node_steps)


def test_conventions_of_steps_are_kept(scene, asked):
    bvh = build("bvh", scene).counted(asked, "nearest")
    np.testing.assert_array_equal(bvh.box_tests, 2 * bvh.node_steps)
    for links in ("octant", "skip"):
        linked = build("bvh_stackless", scene, {"links": links}).counted(asked, "nearest")
        np.testing.assert_array_equal(linked.box_tests, linked.node_steps)
        assert not linked.stack_writes.any()
        assert not linked.max_stack_depth.any()
    kd = build("kd", scene).counted(asked, "nearest")
    np.testing.assert_array_equal(kd.plane_tests + kd.leaves, kd.node_steps)
    bih = build("bih", scene).counted(asked, "nearest")
    np.testing.assert_array_equal(bih.plane_tests + 2 * bih.leaves, 2 * bih.node_steps)


def test_brute_force_tests_everything(scene, asked):
    counters = build("brute", scene).counted(asked, "nearest")
    assert counters.triangle_tests.sum() == len(asked) * len(scene.indices)


def test_mailboxes_spare_tests(rng, asked):
    big = Triangles(*soup(rng, 60, size=1.5))
    structure = build("kd", big, {"traversal_cost": 0.2})
    assert structure.report.duplication > 2
    assert (structure.counted(asked, "nearest").triangle_tests <= 60).mean() > 0.9


@pytest.mark.skipif(STRUCTURES["embree"].why_not() is not None, reason="not on this machine")
def test_embree_shows_nothing(scene, asked):
    structure = build("embree", scene)
    assert structure.counted(asked, "nearest") is None
    assert structure.state_bytes is None
    assert structure.report.nodes is None
