"""Built-in scenes: exact counts, sound geometry, a default camera."""

import numpy as np
import pytest

from raysvc.builtin import BUILTIN_SCENES
from raysvc.scene import Scene


@pytest.fixture(scope="module", params=sorted(BUILTIN_SCENES))
def scene(request: pytest.FixtureRequest) -> Scene:
    return BUILTIN_SCENES[request.param]()


def test_the_torus_park_has_the_counts_of_the_talk() -> None:
    park = BUILTIN_SCENES["torus_park"]()
    counts = np.bincount(park.material_of_triangle)
    assert len(park.triangles) == 288_852
    assert len(park.materials) == len(counts) == 4
    assert counts[0] == 20_872
    assert counts[1] == 255_488
    assert counts[2] + counts[3] == 12_492
    assert counts.min() > 0


@pytest.mark.parametrize("name", ["shiny", "glass"])
def test_still_lifes_have_about_a_hundred_thousand_triangles(name: str) -> None:
    assert 90_000 <= len(BUILTIN_SCENES[name]().triangles) <= 110_000


def test_glass_has_solids_sheets_and_varnish() -> None:
    materials = BUILTIN_SCENES["glass"]().materials
    through = [material for material in materials if material.transmission > 0]
    assert {material.solid for material in through} == {True, False}
    assert sum(material.clearcoat > 0 for material in materials) == 2
    assert all(sum(material.absorption) > 0 for material in through if material.solid)


def test_the_cornell_box_is_lit_by_a_lamp_that_is_seen() -> None:
    box = BUILTIN_SCENES["cornell"]()
    lit = [max(box.materials[m].emissive) > 0 for m in box.material_of_triangle]
    lamp = box.positions[box.triangles[lit]].astype(float)
    # Nothing but the lamp lights it, and the lamp shines down from just below the ceiling.
    assert box.lights == () and len(lamp) == 2
    across = np.cross(lamp[:, 1] - lamp[:, 0], lamp[:, 2] - lamp[:, 0])
    assert (across[:, 1] < 0).all() and np.allclose(across[:, [0, 2]], 0, atol=1e-9)
    assert 0 < box.bounds()[1, 1] - lamp[..., 1].max() < 0.01


def test_the_cornell_box_has_red_on_the_left_seen_from_the_camera() -> None:
    box = BUILTIN_SCENES["cornell"]()
    names = [material.name for material in box.materials]
    middles = box.positions[box.triangles].mean(axis=1)
    red = middles[box.material_of_triangle == names.index("red")]
    assert np.allclose(red[:, 0], box.bounds()[0, 0])


def test_every_scene_has_a_camera_called_default_that_sees_it(scene: Scene) -> None:
    assert scene.cameras[0].name == "default"
    pose = scene.cameras[0].world_from_camera
    target = (scene.positions[scene.triangles].mean(axis=(0, 1)) - pose[:3, 3]) @ pose[:3, :3]
    assert target[2] < 0
    assert np.allclose(pose[:3, :3].T @ pose[:3, :3], np.eye(3))


def test_normals_and_tangents_are_unit_and_perpendicular(scene: Scene) -> None:
    assert np.allclose(np.linalg.norm(scene.normals, axis=1), 1, atol=1e-5)
    along = scene.tangents[:, :3]
    assert np.allclose(np.linalg.norm(along, axis=1), 1, atol=1e-5)
    assert np.abs(np.einsum("vk,vk->v", along, scene.normals)).max() < 1e-5


def test_no_triangle_is_without_area(scene: Scene) -> None:
    corners = scene.positions[scene.triangles].astype(np.float64)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.linalg.norm(normals, axis=1).min() > 1e-9


def test_a_scene_is_the_same_every_time(scene: Scene) -> None:
    again = BUILTIN_SCENES[scene.name]()
    for name in ("positions", "normals", "uv", "colours", "triangles", "material_of_triangle"):
        assert np.array_equal(getattr(scene, name), getattr(again, name))


def test_base_colours_and_vertex_colours_reflect_no_more_than_all_light(scene: Scene) -> None:
    for material in scene.materials:
        assert max(material.base_colour) <= 1.0
    assert scene.colours.min() >= 0.0
    assert scene.colours.max() <= 1.0
