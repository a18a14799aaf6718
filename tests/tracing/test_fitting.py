"""Trees that are moved to another shape of a scene answer as trees that were built there."""

import numpy as np
import pytest

from raysvc.accel.registry import STRUCTURES
from raysvc.shading.scene_tables import SceneTables
from raysvc.tracing.fitting import WORST_RATIO, fitted
from raysvc.tracing.world import World
from tests.scenes import mesh, soup
from tests.tracing.test_world import MIXED, mixed_scene, random_rays

HERE = [name for name in STRUCTURES if STRUCTURES[name].why_not() is None]
REFITTING = ("bvh", "bvh_stackless", "bih")


def moved_a_little(scene, rng, by=0.1):
    return scene.deformed(scene.positions + rng.uniform(-by, by, scene.positions.shape))


def world(scene, structure, trees="one"):
    return World(scene, SceneTables.of(scene), structure, trees)


@pytest.mark.parametrize("trees", ["one", "per_material"])
@pytest.mark.parametrize("structure", HERE)
@pytest.mark.parametrize("solid", [True, False])
def test_moved_trees_answer_as_those_built_there(structure, trees, solid, rng):
    scene = mixed_scene(rng, solid=solid)
    shape, asked = moved_a_little(scene, rng, 0.5), random_rays(rng, 300)
    tables = SceneTables.of(scene).of_shape(shape)
    before = world(scene, structure, trees)
    moved, built = before.refitted(shape, tables), world(shape, structure, trees)
    for one, other in zip(moved.nearest(asked), built.nearest(asked), strict=True):
        np.testing.assert_array_equal(one, other)
    np.testing.assert_array_equal(moved.transmittance(asked), built.transmittance(asked))
    (ray, hits), (other_ray, other_hits) = moved.along(asked), built.along(asked)
    np.testing.assert_array_equal(ray, other_ray)
    for one, other in zip(hits, other_hits, strict=True):
        np.testing.assert_array_equal(one, other)
    assert moved.trees == before.trees and moved.structure == structure
    assert moved.is_around(shape) and not moved.is_around(scene)
    # And the trees that were moved are where they were.
    np.testing.assert_array_equal(
        before.nearest(asked).triangle, world(scene, structure, trees).nearest(asked).triangle
    )


@pytest.mark.parametrize("structure", HERE)
def test_trees_are_moved_where_they_can_be(structure, rng):
    scene = mixed_scene(rng)
    shape = moved_a_little(scene, rng, 0.001)
    before = world(scene, structure)
    fit = fitted(shape, SceneTables.of(shape), structure, "one", before)
    assert fit.refitted == (structure in REFITTING) == before.refits
    assert fit.ratio_refused is None
    figures = fit.figures()
    assert figures["refitted"] == fit.refitted
    if structure in ("embree", "brute"):
        assert figures["sah_cost"] is figures["sah_cost_built"] is figures["sah_ratio"] is None
    elif fit.refitted:
        assert figures["sah_cost_built"] == before.report.sah_cost
        assert figures["sah_cost"] == fit.world.report.sah_cost != before.report.sah_cost
        ratio = figures["sah_cost"] / figures["sah_cost_built"]
        assert figures["sah_ratio"] == pytest.approx(ratio) == pytest.approx(1, abs=0.05)
    else:
        assert figures["sah_cost"] == figures["sah_cost_built"]
        assert figures["sah_ratio"] == 1.0


def test_nothing_to_move_is_built(rng):
    scene = mixed_scene(rng)
    fit = fitted(scene, SceneTables.of(scene), "bvh", "one", None)
    assert not fit.refitted and fit.ratio_refused is None
    assert fit.figures()["sah_ratio"] == 1.0


@pytest.mark.parametrize("trees", ["one", "per_material"])
@pytest.mark.parametrize("structure", REFITTING)
def test_trees_that_would_have_become_too_costly_are_built_anew(structure, trees, rng):
    scene = mixed_scene(rng, 400)
    scattered = scene.deformed(rng.permutation(scene.positions))
    tables = SceneTables.of(scattered)
    fit = fitted(scattered, tables, structure, trees, world(scene, structure, trees))
    assert not fit.refitted
    assert fit.ratio_refused > WORST_RATIO
    figures, built = fit.figures(), world(scattered, structure, trees)
    assert figures["sah_ratio_refused"] == fit.ratio_refused
    assert figures["sah_cost"] == figures["sah_cost_built"] == built.report.sah_cost
    # What was built is what later shapes are measured by.
    near = moved_a_little(scattered, rng, 0.001)
    again = fitted(near, SceneTables.of(near), structure, trees, fit.world)
    assert again.refitted
    assert again.world.sah_cost_built == built.report.sah_cost


def test_what_trees_cost_when_built_is_remembered_from_shape_to_shape(rng):
    scene = mixed_scene(rng, 400)
    first = world(scene, "bvh")
    last = first
    for step in range(1, 8):
        shape = scene.deformed(scene.positions * np.float32([1, 1 + 0.02 * step, 1]))
        fit = fitted(shape, SceneTables.of(shape), "bvh", "one", last)
        assert fit.refitted
        last = fit.world
        assert last.sah_cost_built == first.report.sah_cost
    straight = first.refitted(shape, SceneTables.of(shape))
    assert last.report.sah_cost == pytest.approx(straight.report.sah_cost, rel=1e-9)


def test_trees_that_had_no_surface_are_built_anew_once_they_have(rng):
    positions, triangles = soup(rng, 50)
    scene = mesh(0 * positions, triangles, materials=MIXED[:1])
    shape = scene.deformed(positions)
    fit = fitted(shape, SceneTables.of(shape), "bvh", "one", world(scene, "bvh"))
    assert not fit.refitted
    assert fit.figures()["sah_ratio_refused"] is None  # JSON knows no infinity
    still = scene.deformed(0 * positions)
    assert fitted(still, SceneTables.of(still), "bvh", "one", world(scene, "bvh")).refitted


def test_tables_of_another_shape_share_all_that_is_not_shape(rng):
    scene = mixed_scene(rng)
    tables, shape = SceneTables.of(scene), moved_a_little(scene, rng)
    moved = tables.of_shape(shape)
    assert moved.textures is tables.textures and moved.materials is tables.materials
    for name, array in SceneTables.of(shape).geometry._asdict().items():
        np.testing.assert_array_equal(getattr(moved.geometry, name), array)
