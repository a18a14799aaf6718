"""Normals and tangents that are made."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from raysvc.loading.gltf.directions import smooth_normals, unit
from raysvc.loading.gltf.tangents import tangents
from tests.loading.gltf.building import QUAD, QUAD_INDICES, QUAD_UV, Builder

UP = np.tile(np.array([0, 0, 1], np.float32), (4, 1))
FACES = QUAD_INDICES.reshape(-1, 3).astype(np.int64)


def test_unit_vectors_do_not_overflow():
    vectors = np.array([[3e300, 4e300, 0], [3e-320, 0, 4e-320], [0, 0, 0], [np.nan, 1, 1]])
    made, good = unit(vectors)
    assert good.tolist() == [True, True, False, False]
    assert np.allclose(made[:2], [[0.6, 0.8, 0], [0.6, 0, 0.8]], atol=1e-3)
    assert not made[2:].any()


def test_tangents_follow_u_with_the_bitangent_up_the_picture():
    made = tangents(QUAD, UP, QUAD_UV, FACES)
    assert np.allclose(made, [1, 0, 0, 1])
    bitangent = np.cross(UP, made[:, :3]) * made[:, 3:]
    assert np.allclose(bitangent, [0, 1, 0])


def test_mirrored_texture_coordinates_turn_the_handedness():
    made = tangents(QUAD, UP, QUAD_UV * np.array([-1, 1], np.float32), FACES)
    assert np.allclose(made, [-1, 0, 0, -1])


def test_vertices_where_the_handedness_differs_are_left_to_the_shader():
    uv = QUAD_UV.copy()
    uv[3] = [1, 1]
    uv[1] = [1, 1]
    made = tangents(QUAD, UP, uv, FACES)
    assert made[[0, 2], 3].tolist() == [0, 0]
    assert not made[[0, 2]].any()
    assert sorted(made[[1, 3], 3].tolist()) == [-1, 1]


def test_collapsed_texture_coordinates_give_no_tangent():
    assert not tangents(QUAD, UP, QUAD_UV * 0, FACES).any()


def test_vertices_that_agree_share_their_tangent():
    corners = FACES.reshape(-1)
    bent = QUAD.copy()
    bent[1, 2] = 0.7
    whole = tangents(bent, UP, QUAD_UV, FACES)
    split = tangents(bent[corners], UP[[0] * 6], QUAD_UV[corners], np.arange(6).reshape(-1, 3))
    assert np.allclose(split, whole[corners], atol=1e-6)


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 10_000))
def test_tangents_agree_with_a_vertex_by_vertex_sum(seed):
    rng = np.random.default_rng(seed)
    positions = rng.normal(size=(7, 3)).astype(np.float32)
    normals = rng.normal(size=(7, 3))
    normals = (normals / np.linalg.norm(normals, axis=1)[:, None]).astype(np.float32)
    uv = rng.normal(size=(7, 2)).astype(np.float32)
    faces = rng.permuted(np.tile(np.arange(7), (5, 1)), axis=1)[:, :3]
    made = tangents(positions, normals, uv, faces)
    for vertex in range(7):
        total, signs = np.zeros(3), set()
        for face in faces:
            if vertex not in face:
                continue
            at = face.tolist().index(vertex)
            a, b, c = (positions[face[(at + k) % 3]].astype(float) for k in range(3))
            ua, ub, uc = (uv[face[(at + k) % 3]].astype(float) for k in range(3))
            # Solve edges = [du dv] [T B]^T for T.
            along = np.linalg.solve(np.array([ub - ua, uc - ua]), np.array([b - a, c - a]))[0]
            cosine = (b - a) @ (c - a) / np.linalg.norm(b - a) / np.linalg.norm(c - a)
            total += along / np.linalg.norm(along) * np.arccos(np.clip(cosine, -1, 1))
            signs.add(-np.sign(np.linalg.det(np.array([ub - ua, uc - ua]))))
        if len(signs) != 1:
            assert not made[vertex].any()
            continue
        n = normals[vertex].astype(float)
        total -= n * (n @ total)
        assert made[vertex, 3] == signs.pop()
        assert np.allclose(made[vertex, :3], total / np.linalg.norm(total), atol=1e-4)


def test_smooth_normals_weigh_triangles_by_area():
    positions = np.array([[0, 0, 0], [1, 0, 0], [0, 3, 0], [0, 0, 1]], np.float32)
    made = smooth_normals(positions, np.array([[0, 1, 2], [0, 2, 3]]))
    assert np.allclose(made[0], np.array([3, 0, 3]) / np.sqrt(18))
    assert np.allclose(made[1], [0, 0, 1])


def material(**normal_texture):
    return {"normalTexture": {"index": 0, **normal_texture}}


def loaded(materials, **attributes):
    builder = Builder(materials=materials)
    builder.png(np.full((2, 2, 3), 128, np.uint8))
    builder.mesh(QUAD, QUAD_INDICES, {"material": 0}, TEXCOORD_0=QUAD_UV, **attributes)
    return builder.load()


def test_tangents_are_made_only_where_a_normal_map_needs_them():
    assert not loaded([{}], NORMAL=UP).tangents.any()
    assert np.allclose(loaded([material()], NORMAL=UP).tangents, [1, 0, 0, 1])
    assert np.allclose(loaded([material()]).tangents, [1, 0, 0, 1])
    given = np.tile(np.array([0, 1, 0, -1], "f"), (4, 1))
    assert np.allclose(loaded([material()], NORMAL=UP, TANGENT=given).tangents, given)


def test_tangents_are_made_in_the_normal_maps_own_coordinates():
    turned = {"KHR_texture_transform": {"rotation": np.pi / 2}}
    scene = loaded([material(extensions=turned)], NORMAL=UP)
    # The picture turns clockwise: its right is now down.
    assert np.allclose(scene.tangents, [0, -1, 0, 1], atol=1e-6)
    other = np.stack([1 - QUAD_UV[:, 1], QUAD_UV[:, 0]], axis=1)
    scene = loaded([material(texCoord=1)], NORMAL=UP, TEXCOORD_1=other)
    assert np.allclose(scene.tangents, [0, 1, 0, 1], atol=1e-6)
