"""Triangles and vertex attributes of primitives."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from raysvc.errors import InvalidScene
from raysvc.loading.gltf import topology
from tests.loading.gltf.building import QUAD, QUAD_INDICES, QUAD_UV, TRIANGLE, Builder, front_faces


def slow_triangles(mode: int, drawn: list[int]) -> list[list[int]]:
    triangles = []
    for i in range(len(drawn)):
        if mode == 4 and i % 3 == 2:
            triangles.append([drawn[i - 2], drawn[i - 1], drawn[i]])
        if mode == 5 and i >= 2:
            turned = (drawn[i - 1], drawn[i - 2]) if i % 2 else (drawn[i - 2], drawn[i - 1])
            triangles.append([*turned, drawn[i]])
        if mode == 6 and i >= 2:
            triangles.append([drawn[0], drawn[i - 1], drawn[i]])
    return triangles


def rotated(triangle: list[int]) -> tuple[int, ...]:
    """The triangle begun at its least vertex: the same triangle with the same winding."""
    least = min(range(3), key=lambda k: triangle[k])
    return tuple(triangle[least:] + triangle[:least])


@given(st.sampled_from([4, 5, 6]), st.lists(st.integers(0, 1000), max_size=12, unique=True))
def test_lists_strips_and_fans_draw_what_the_specification_says(mode, drawn):
    made = topology.triangles_of(mode, np.array(drawn, np.int64)).tolist()
    assert list(map(rotated, made)) == list(map(rotated, slow_triangles(mode, drawn)))
    assert topology.triangle_count(mode, len(drawn)) == len(made)


@pytest.mark.parametrize(("mode", "order"), [(4, [0, 1, 2, 0, 2, 3]), (5, [0, 1, 3, 2]), (6, None)])
def test_a_square_faces_the_same_way_in_every_mode(mode, order):
    builder = Builder()
    indices = None if order is None else np.array(order, "B")
    builder.mesh(QUAD, indices, {"mode": mode})
    scene = builder.load()
    assert np.allclose(front_faces(scene), [[0, 0, 1], [0, 0, 1]])
    assert scene.warnings == ()


@pytest.mark.parametrize("mode", [0, 1, 2, 3])
def test_points_and_lines_are_listed_in_the_warnings(mode):
    builder = Builder()
    builder.mesh(TRIANGLE)
    builder.mesh(TRIANGLE, more={"mode": mode})
    scene = builder.load()
    assert len(scene.triangles) == 1
    assert "meshes[1].primitives[0]" in scene.warnings[0]
    assert "not triangles" in scene.warnings[0]


def test_an_unknown_mode_is_refused():
    builder = Builder()
    builder.mesh(TRIANGLE, more={"mode": 7})
    with pytest.raises(InvalidScene) as raised:
        builder.load()
    assert raised.value.field == "meshes[0].primitives[0].mode"


def test_without_normals_triangles_are_flat():
    builder = Builder()
    folded = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], "f")
    builder.mesh(folded, np.array([0, 1, 2, 0, 3, 1], "B"))
    scene = builder.load()
    assert len(scene.positions) == 6
    expected = np.repeat([[0, 0, 1], [0, 1, 0]], 3, axis=0)
    assert np.array_equal(scene.normals[scene.triangles.reshape(-1)], expected)


def test_given_normals_are_kept_and_unused_vertices_dropped():
    builder = Builder()
    positions = np.concatenate([[[9, 9, np.nan]], QUAD]).astype("f")
    normals = np.tile(np.array([0, 0.6, 0.8], "f"), (5, 1))
    builder.mesh(positions, QUAD_INDICES + 1, NORMAL=normals)
    scene = builder.load()
    assert np.array_equal(scene.positions, QUAD)
    assert np.allclose(scene.normals, [0, 0.6, 0.8])
    assert scene.triangles.tolist() == [[0, 1, 2], [0, 2, 3]]


def test_a_few_vertices_of_a_large_array_are_found_too():
    builder = Builder()
    positions = np.zeros((1000, 3), "f")
    positions[[5, 700, 31]] = TRIANGLE
    builder.mesh(
        positions, np.array([5, 700, 31], "H"), NORMAL=np.tile([0, 0, 1], (1000, 1)).astype("f")
    )
    scene = builder.load()
    assert np.array_equal(scene.positions[scene.triangles[0]], TRIANGLE)
    assert len(scene.positions) == 3


@pytest.mark.parametrize("bad", [[0, 0, 0], [np.nan, 0, 0], [np.inf, 0, 0]])
def test_bad_normals_are_made_from_the_triangles(bad):
    builder = Builder()
    normals = np.array([[0, 0, 2], bad, [0, 0, 1]], "f")
    builder.mesh(TRIANGLE, NORMAL=normals)
    scene = builder.load()
    assert np.array_equal(scene.normals, np.tile([0, 0, 1], (3, 1)))
    assert any("made from the triangles" in warning for warning in scene.warnings)
    assert any("not unit" in warning for warning in scene.warnings)


def test_bad_tangents_are_left_to_the_shader():
    builder = Builder()
    tangents = np.array([[1, 0, 0, 1], [0, 0, 0, 1], [0, 2, 0, -1]], "f")
    builder.mesh(TRIANGLE, NORMAL=np.tile([0, 0, 1], (3, 1)).astype("f"), TANGENT=tangents)
    scene = builder.load()
    assert scene.tangents.tolist() == [[1, 0, 0, 1], [0, 0, 0, 0], [0, 1, 0, -1]]
    assert "tangents" in scene.warnings[0]


def test_tangents_without_normals_are_ignored_as_the_specification_says():
    builder = Builder()
    builder.mesh(TRIANGLE, TANGENT=np.tile([1, 0, 0, 1], (3, 1)).astype("f"))
    assert not builder.load().tangents.any()


@pytest.mark.parametrize(
    ("kind", "width", "values", "expected"),
    [
        ("f", 3, [0.001, 0.5, 2.0], [0.001, 0.5, 2.0, 1.0]),
        ("f", 4, [0.001, 0.5, 2.0, 0.25], [0.001, 0.5, 2.0, 0.25]),
        ("B", 3, [0, 51, 255], [0, 0.2, 1, 1]),
        ("B", 4, [0, 51, 255, 102], [0, 0.2, 1, 0.4]),
        ("H", 4, [0, 13107, 65535, 26214], [0, 0.2, 1, 0.4]),
    ],
)
def test_vertex_colours_are_linear_in_every_format(kind, width, values, expected):
    builder = Builder()
    colours = builder.accessor(np.tile(values, (3, 1)).astype(kind), normalized=kind != "f")
    builder.mesh(TRIANGLE, COLOR_0=colours)
    scene = builder.load()
    assert np.allclose(scene.colours, expected, atol=1e-6)
    assert scene.warnings == ()


def test_vertex_colours_default_to_white_and_odd_ones_are_repaired():
    builder = Builder()
    builder.mesh(TRIANGLE)
    assert (builder.load().colours == 1).all()
    builder = Builder()
    builder.mesh(TRIANGLE, COLOR_0=builder.accessor(np.full((3, 3), 255, "B")))
    builder.mesh(TRIANGLE, COLOR_0=np.full((3, 3), -1, "f"))
    scene = builder.load()
    assert scene.colours[0].tolist() == [1, 1, 1, 1]
    assert scene.colours[3].tolist() == [0, 0, 0, 1]
    assert len(scene.warnings) == 2


def test_both_sets_of_texture_coordinates_are_kept_and_more_are_named():
    builder = Builder()
    builder.mesh(
        QUAD,
        QUAD_INDICES,
        NORMAL=np.tile([0, 0, 1], (4, 1)).astype("f"),
        TEXCOORD_0=builder.accessor((QUAD_UV * 65535).astype("H"), normalized=True),
        TEXCOORD_1=(QUAD_UV * 3).astype("f"),
        TEXCOORD_2=QUAD_UV,
        COLOR_1=np.ones((4, 3), "f"),
        _CUSTOM=QUAD_UV,
    )
    scene = builder.load()
    assert np.array_equal(scene.uv[:, 0], QUAD_UV)
    assert np.array_equal(scene.uv[:, 1], QUAD_UV * 3)
    assert [warning.partition(": ")[2] for warning in scene.warnings] == [
        "TEXCOORD_2 is not used",
        "COLOR_1 is not used",
    ]


def test_wild_texture_coordinates_are_set_to_zero():
    builder = Builder()
    builder.mesh(TRIANGLE, TEXCOORD_0=np.array([[0, 1], [np.nan, 0], [1e30, 0]], "f"))
    scene = builder.load()
    assert scene.uv[:, 0].tolist() == [[0, 1], [0, 0], [0, 0]]
    assert "set to 0" in scene.warnings[0]


def test_quantised_meshes_are_read():
    builder = Builder(extensionsRequired=["KHR_mesh_quantization"])
    positions = builder.accessor(np.array([[0, 0, 0], [100, 0, 0], [0, 127, 0]], "b"))
    normals = builder.accessor(np.tile([0, 0, 127], (3, 1)).astype("b"), normalized=True)
    uv = builder.accessor(np.array([[0, 0], [3, 0], [0, 200]], "B"))
    builder.mesh(positions, NORMAL=normals, TEXCOORD_0=uv)
    scene = builder.load()
    assert scene.positions.tolist() == [[0, 0, 0], [100, 0, 0], [0, 127, 0]]
    assert scene.normals[0].tolist() == [0, 0, 1]
    assert scene.uv[:, 0].tolist() == [[0, 0], [3, 0], [0, 200]]
    assert scene.warnings == ()


def broken(positions=TRIANGLE, **attributes):
    builder = Builder()
    builder.mesh(positions, **attributes)
    return builder


BROKEN = {
    "indices beyond": (
        broken(indices=np.array([0, 1, 3], "I")),
        "meshes[0].primitives[0].indices",
    ),
    "restart index": (
        broken(indices=np.array([0, 1, 0xFFFF], "H")),
        "meshes[0].primitives[0].indices",
    ),
    "NaN": (broken(positions=TRIANGLE * np.float32(np.nan)), "accessors[0]"),
    "infinite": (broken(positions=np.where(TRIANGLE > 0, np.inf, 0).astype("f")), "accessors[0]"),
    "far": (broken(positions=TRIANGLE * np.float32(3e18)), "accessors[0]"),
    "counts differ": (
        broken(NORMAL=np.ones((2, 3), "f")),
        "meshes[0].primitives[0].attributes.NORMAL",
    ),
    "NaN colour": (broken(COLOR_0=np.full((3, 3), np.nan, "f")), "accessors[1]"),
    "no such accessor": (broken(NORMAL=9), "meshes[0].primitives[0].attributes.NORMAL"),
    "negative accessor": (broken(COLOR_0=-1), "meshes[0].primitives[0].attributes.COLOR_0"),
    "width": (broken(TEXCOORD_0=np.ones((3, 3), "f")), "accessors[1].type"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_primitive_is_refused_by_name(name):
    builder, field = BROKEN[name]
    with pytest.raises(InvalidScene) as raised:
        builder.load()
    assert raised.value.field == field


@pytest.mark.parametrize("part", ["attributes", "POSITION"])
def test_positions_are_needed(part):
    builder = broken()
    primitive = builder.tree["meshes"][0]["primitives"][0]
    primitive.pop("attributes")
    if part == "POSITION":
        primitive["attributes"] = {}
    with pytest.raises(InvalidScene) as raised:
        builder.load()
    assert part in raised.value.field


def test_incomplete_and_flat_triangles_are_named():
    builder = Builder()
    builder.mesh(QUAD)
    builder.mesh(TRIANGLE * 0)
    scene = builder.load()
    assert len(scene.triangles) == 2
    assert [warning.partition(": ")[2] for warning in scene.warnings] == [
        "the last triangle is incomplete and left out",
        "has triangles without area",
    ]


def test_morph_targets_are_named():
    builder = Builder()
    builder.mesh(TRIANGLE, more={"targets": [{"POSITION": 0}]})
    assert "morph targets" in builder.load().warnings[0]
