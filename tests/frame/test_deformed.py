"""Frames of deformed scenes: the same picture however their trees came to be."""

import gc
import weakref

import numpy as np
import pytest

import raysvc
from raysvc.accel.registry import STRUCTURES
from raysvc.frame.prepared import prepare
from raysvc.frame.settings import Settings
from raysvc.frame.surroundings import default_environment
from raysvc.frame.warm_up import specimen
from raysvc.scene import Scene
from tests.frame.subjects import still_life

CAMERA = {"width": 40, "height": 28, "eye": [0.5, 1.5, 4.0], "target": [0.0, 0.3, 0.0]}
FAST = {"occlusion_samples": 4, "aa_samples": 2, "bounces": 2}
HERE = [name for name in STRUCTURES if STRUCTURES[name].why_not() is None and name != "brute"]


def twisted(scene: Scene, turn: float) -> np.ndarray:
    """Positions turned about +Y, the more the higher they are."""
    x, y, z = scene.rest.positions.astype(float).T
    cosine, sine = np.cos(turn * y), np.sin(turn * y)
    return np.stack([cosine * x + sine * z, y, cosine * z - sine * x], axis=1)


def made_anew(scene: Scene) -> Scene:
    """The same scene without a past."""
    arrays = ("positions", "normals", "tangents", "uv", "colours", "triangles")
    arrays += ("material_of_triangle", "object_of_triangle")
    kept = ("materials", "textures", "lights", "cameras", "name", "warnings")
    return Scene(
        **{name: getattr(scene, name).copy() for name in arrays},
        **{name: getattr(scene, name) for name in kept},
    )


def rendered(scene: Scene, **settings: object) -> raysvc.Frame:
    return raysvc.render(scene, camera=CAMERA, settings=FAST | settings)


def same(one: raysvc.Frame, other: raysvc.Frame) -> None:
    assert one.layers.keys() == other.layers.keys()
    for name, layer in one.layers.items():
        np.testing.assert_array_equal(layer, other.layers[name])
    assert one.encode("png") == other.encode("png")


@pytest.mark.parametrize("trees", ["one", "per_material"])
@pytest.mark.parametrize("structure", HERE)
def test_a_deformed_scene_looks_as_if_it_had_been_made_so(structure: str, trees: str) -> None:
    scene = specimen()  # with masked and blended panes
    rendered(scene, structure=structure, trees=trees)
    deformed = scene.deformed(twisted(scene, 0.2))
    frame = rendered(deformed, structure=structure, trees=trees)
    assert frame.statistics.build["refitted"] == (structure in ("bvh", "bvh_stackless", "bih"))
    expected = rendered(made_anew(deformed), structure=structure, trees=trees)
    assert not expected.statistics.build["refitted"]
    same(frame, expected)


def test_paths_find_a_deformed_scene_as_if_it_had_been_made_so() -> None:
    scene, settings = specimen(), {"mode": "reference", "samples": 2, "structure": "bvh"}
    rendered(scene, **settings)
    deformed = scene.deformed(twisted(scene, 0.2))
    frame = rendered(deformed, **settings)
    assert frame.statistics.build["refitted"]
    same(frame, rendered(made_anew(deformed), **settings))


def test_a_scene_whose_vertices_stay_looks_the_same() -> None:
    scene = still_life()
    same(
        rendered(scene.deformed(scene.positions), structure="bvh"),
        rendered(scene, structure="bvh"),
    )


def test_a_deformed_scene_looks_different() -> None:
    scene = still_life()
    before, after = rendered(scene), rendered(scene.deformed(twisted(scene, 0.5)))
    changed = np.abs(before.layers["beauty"] - after.layers["beauty"]).max(axis=-1) > 0.01
    assert changed.mean() > 0.05


def test_an_animation_moves_the_trees_from_frame_to_frame() -> None:
    scene = still_life()
    rendered(scene, structure="bvh")
    cost = None
    for frame in range(1, 6):
        scene = scene.deformed(twisted(scene, 0.01 * frame))  # the shape before is let go
        build = rendered(scene, structure="bvh").statistics.build
        assert build["refitted"] and not build["cached"]
        cost = cost or build["sah_cost_built"]
        assert build["sah_cost_built"] == cost
        assert build["sah_ratio"] == pytest.approx(build["sah_cost"] / cost)
    again = rendered(scene, structure="bvh").statistics.build
    assert again["cached"] and again["refitted"]


def test_trees_are_built_anew_when_a_shape_is_too_far_off() -> None:
    scene = still_life()
    rendered(scene, structure="bvh")
    rng = np.random.default_rng(7)
    torn = scene.deformed(rng.permutation(scene.positions))
    frame = rendered(torn, structure="bvh")
    build = frame.statistics.build
    assert not build["refitted"] and build["sah_ratio"] == 1.0
    assert build["sah_ratio_refused"] > 1.2
    same(frame, rendered(made_anew(torn), structure="bvh"))


def prepared(scene: Scene, structure: str = "bvh"):
    return prepare(scene, default_environment(), Settings(structure=structure))


def test_textures_are_not_prepared_again() -> None:
    scene = still_life()
    first = prepared(scene)
    second = prepared(scene.deformed(twisted(scene, 0.1)))
    assert second.tables.textures is first.tables.textures


def test_both_the_scene_and_its_latest_shape_keep_their_trees() -> None:
    scene = still_life()
    shapes = [scene.deformed(twisted(scene, 0.01 * k)) for k in range(3)]
    worlds = [prepared(each).world for each in (scene, *shapes)]
    assert prepared(scene).cached and prepared(scene).world is worlds[0]
    assert not prepared(shapes[1]).cached
    assert prepared(shapes[1]).cached and prepared(scene).cached


def test_what_nobody_holds_is_let_go() -> None:
    scene = still_life()
    world = weakref.ref(prepared(scene).world)
    shape = scene.deformed(twisted(scene, 0.1))
    known = weakref.ref(scene)
    del scene
    gc.collect()
    assert known() is None
    assert world() is not None  # the next shape's trees come from it
    moved = weakref.ref(prepared(shape).world)
    gc.collect()
    assert world() is None
    del shape
    gc.collect()
    assert moved() is None
