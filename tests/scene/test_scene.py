"""A scene checks what kernels rely on."""

from dataclasses import fields, replace

import numpy as np
import pytest

from raysvc.errors import InvalidEnvironment, InvalidScene
from raysvc.scene import Camera, Environment, Material, Scene, TextureRef
from tests.frame.subjects import still_life


def changed(**values) -> Scene:
    scene = still_life()
    kept = {f.name: getattr(scene, f.name) for f in fields(Scene) if f.init}
    return Scene(**(kept | values))


def with_value(name: str, value: float) -> np.ndarray:
    array = np.array(getattr(still_life(), name))
    array.reshape(-1)[5] = value
    return array


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("positions", np.nan),
        ("normals", np.inf),
        ("uv", np.nan),
        ("colours", -np.inf),
        ("tangents", np.nan),
        ("triangles", -1),
        ("triangles", 10**6),
        ("material_of_triangle", 3),
        ("material_of_triangle", -1),
    ],
)
def test_a_value_that_a_kernel_must_not_see_is_refused_by_name(name: str, value: float) -> None:
    with pytest.raises(InvalidScene) as caught:
        changed(**{name: with_value(name, value)})
    assert caught.value.field == name


@pytest.mark.parametrize(
    ("name", "array"),
    [
        ("positions", np.zeros((4, 3), np.float64)),
        ("triangles", np.zeros((4, 4), np.int32)),
        ("object_of_triangle", np.zeros(1, np.int32)),
        ("normals", np.zeros((3, 4), np.float32).T[:, :3]),
    ],
)
def test_a_wrong_shape_dtype_or_layout_is_refused_by_name(name: str, array: np.ndarray) -> None:
    with pytest.raises(InvalidScene):
        changed(**{name: array})


@pytest.mark.parametrize(
    "material",
    [
        Material(base_colour_texture=TextureRef(1)),
        Material(normal_texture=TextureRef(0, uv_set=2)),
        Material(roughness=float("nan")),
        Material(emissive=(1e39, 0.0, 0.0)),
        Material(base_colour_texture=TextureRef(0, uv_transform=(1, 0, np.inf, 0, 1, 0))),
    ],
)
def test_a_material_with_broken_references_or_numbers_is_refused(material: Material) -> None:
    scene = still_life()
    with pytest.raises(InvalidScene) as caught:
        changed(materials=(*scene.materials[:2], material))
    assert caught.value.field == "materials[2]"


def test_arrays_of_a_scene_cannot_be_changed() -> None:
    with pytest.raises(ValueError, match="read-only"):
        still_life().positions[0, 0] = 1.0


def test_bounds_are_those_of_the_triangles_used() -> None:
    scene = still_life()
    used = scene.positions[scene.triangles].reshape(-1, 3)
    np.testing.assert_array_equal(scene.bounds(), [used.min(axis=0), used.max(axis=0)])


@pytest.mark.parametrize(
    "radiance",
    [
        np.zeros((2, 4), np.float32),
        np.zeros((0, 4, 3), np.float32),
        np.zeros((2, 4, 3), np.float64),
        np.full((2, 4, 3), np.nan, np.float32),
        np.full((2, 4, 3), -1.0, np.float32),
    ],
)
def test_an_environment_is_finite_light_from_everywhere(radiance: np.ndarray) -> None:
    with pytest.raises(InvalidEnvironment):
        Environment(radiance)


def test_a_pixel_is_as_wide_as_the_projection_makes_it() -> None:
    depth = np.array([0.5, 2.0, 8.0], np.float32)
    pose = np.eye(4)
    perspective = Camera(pose, 10, 8, half_height=0.4)
    np.testing.assert_allclose(perspective.pixel_width_m(depth), depth * 0.1)
    parallel = Camera(pose, 10, 8, projection="orthographic", half_height=2.0)
    np.testing.assert_allclose(parallel.pixel_width_m(depth), 0.5)


def test_the_same_material_with_another_name_is_another_material() -> None:
    assert replace(Material(), name="a") != Material()
