import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import raysvc
from raysvc.compare.tessellation import tessellated
from raysvc.scene import Material, Texture, TextureRef
from tests.scenes import mesh, quad, soup


def areas(scene):
    a, b, c = np.moveaxis(scene.positions[scene.triangles].astype(float), 1, 0)
    return np.cross(b - a, c - a) / 2


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 1000), st.integers(1, 5))
def test_every_triangle_is_cut_into_equal_parts_that_turn_as_it_does(seed, parts):
    scene = mesh(*soup(np.random.default_rng(seed), 6))
    cut = areas(tessellated(scene, parts)).reshape(6, parts**2, 3)
    expected = np.broadcast_to(areas(scene)[:, None] / parts**2, cut.shape)
    np.testing.assert_allclose(cut, expected, atol=2e-6)


def test_one_part_is_the_scene_itself():
    scene = quad()
    assert tessellated(scene, 1) is scene


@pytest.mark.parametrize("parts", [2, 3, 7])
def test_edges_that_met_still_meet_in_the_same_bits(parts, rng):
    corners = rng.normal(size=(4, 3))
    cut = tessellated(mesh(corners, [[0, 1, 2], [2, 1, 3]]), parts)
    half = len(cut.positions) // 2
    one, other = (set(map(bytes, cut.positions[part])) for part in (slice(half), slice(half, None)))
    assert len(one & other) == parts + 1


def test_attributes_are_those_of_the_surface_between_the_vertices(rng):
    uv, colours = rng.random((3, 2)), rng.random((3, 4))
    scene = mesh([[0, 0, 0], [3, 0, 0], [0, 3, 0]], [[0, 1, 2]], uv=uv, colours=colours)
    cut = tessellated(scene, 3)
    weights = np.column_stack([1 - cut.positions[:, :2].sum(axis=1) / 3, cut.positions[:, :2] / 3])
    np.testing.assert_allclose(cut.uv[:, 0], weights @ uv, atol=1e-6)
    np.testing.assert_allclose(cut.colours, weights @ colours, atol=1e-6)


def test_normals_and_tangents_stay_unit_and_handedness_is_kept_where_vertices_agree():
    corners = np.eye(3)
    along = [[0, 0, 1, -1], [1, 0, 0, -1], [0, 1, 0, -1]]
    mixed = [[0, 0, 1, -1], [1, 0, 0, 1], [0, 1, 0, 1]]
    for tangents, handed in ((along, -1), (mixed, 0)):
        scene = mesh(corners, [[0, 1, 2]], normals=corners, tangents=tangents)
        cut = tessellated(scene, 4)
        np.testing.assert_allclose(np.linalg.norm(cut.normals, axis=1), 1, atol=1e-6)
        np.testing.assert_allclose(np.linalg.norm(cut.tangents[:, :3], axis=1), 1, atol=1e-6)
        assert (cut.tangents[:, 3] == handed).all()


def test_triangles_keep_their_material_and_object():
    scene = mesh(
        *soup(np.random.default_rng(1), 3),
        materials=[Material(), Material()],
        material_of_triangle=[1, 0, 1],
        object_of_triangle=[2, 1, 0],
    )
    cut = tessellated(scene, 2)
    assert cut.material_of_triangle.tolist() == [1] * 4 + [0] * 4 + [1] * 4
    assert cut.object_of_triangle.tolist() == [2] * 4 + [1] * 4 + [0] * 4


def test_a_tessellated_scene_is_the_same_picture():
    texture = Texture(np.random.default_rng(5).integers(0, 256, (8, 8, 4), np.uint8))
    material = Material(base_colour_texture=TextureRef(0), normal_texture=TextureRef(0))
    scene = quad(material, textures=(texture,))
    view = {"eye": [1.0, 0.8, 2.0], "width": 48, "height": 32}
    # Without edges' extra samples: those on one triangle share their shading.
    one, other = (
        raysvc.render(each, camera=view, settings={"aa": "none"}).layers
        for each in (scene, tessellated(scene, 5))
    )
    assert (one["id"] != other["id"]).any()
    for layer in ("depth", "normal", "albedo", "occlusion", "beauty"):
        np.testing.assert_allclose(one[layer], other[layer], rtol=1e-4, atol=1e-4, err_msg=layer)
