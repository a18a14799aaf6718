"""Hierarchies and instances."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from raysvc.errors import InvalidScene, LimitExceeded
from raysvc.limits import Limits
from tests.loading.gltf.building import QUAD, QUAD_INDICES, QUAD_UV, TRIANGLE, Builder, front_faces

ROOT = 0.5**0.5
NORMALS = np.tile([0, 0, 1], (3, 1)).astype("f")


def turned(rotation, vector):
    """Rotate by a unit quaternion x y z w: q v q*, multiplied out."""
    xyz, w = np.array(rotation[:3]), rotation[3]
    vector = np.array(vector, float)
    return vector + 2 * np.cross(xyz, np.cross(xyz, vector) + w * vector)


def slow_positions(tree, triangle):
    """World positions of every visit, found by going down recursively; by name order of visits."""
    found = []

    def visit(number, chain):
        node = tree["nodes"][number]
        chain = [node, *chain]
        if "mesh" in node:
            points = []
            for point in triangle:
                point = point.astype(float)
                for each in chain:
                    point = point * each.get("scale", (1, 1, 1))
                    point = turned(each.get("rotation", (0, 0, 0, 1)), point)
                    point = point + each.get("translation", (0, 0, 0))
                points.append(point)
            found.append(points)
        for child in node.get("children", []):
            visit(child, chain)

    for root in tree["scenes"][0]["nodes"]:
        visit(root, [])
    return found


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(1, 9))
def test_hierarchies_transform_as_a_recursive_walk_does(seed, count):
    rng = np.random.default_rng(seed)
    builder = Builder()
    builder.mesh(TRIANGLE, NORMAL=NORMALS)
    for number in range(count):
        rotation = rng.normal(size=4)
        builder.node(
            translation=rng.normal(size=3).tolist(),
            rotation=(rotation / np.linalg.norm(rotation)).tolist(),
            scale=rng.choice([-2, -1, 0.5, 1, 3], 3).tolist(),
            children=[c for c in range(number + 1, count) if rng.random() < 0.4],
            **({"mesh": 0} if rng.random() < 0.7 or number == 0 else {}),
        )
    scene = builder.load()
    expected = np.array(slow_positions(builder.tree, TRIANGLE)).reshape(-1, 9)
    corners = np.sort(scene.triangles, axis=1)
    made = scene.positions[corners].reshape(-1, 9)
    assert len(made) == len(expected)
    nearest = np.abs(made[:, None] - expected[None]).max(axis=2)
    assert nearest.min(axis=0).max() < 1e-2 and nearest.min(axis=1).max() < 1e-2
    # Shading normals stay on the side of the front faces, mirrored or not.
    facing = np.einsum("fk,fk->f", front_faces(scene), scene.normals[scene.triangles[:, 0]])
    assert (facing > 0).all()


def test_a_matrix_is_read_by_columns():
    builder = Builder()
    builder.mesh(TRIANGLE)
    builder.node(mesh=0, matrix=[0, 2, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 7, 8, 9, 1])
    scene = builder.load()
    assert scene.positions.tolist() == [[7, 8, 9], [7, 10, 9], [6, 8, 9]]


def test_a_mirrored_node_keeps_fronts_normals_and_the_tangent_frame():
    builder = Builder(materials=[{"normalTexture": {"index": 0}}])
    builder.png(np.full((2, 2, 3), 128, np.uint8))
    builder.mesh(
        QUAD,
        QUAD_INDICES,
        {"material": 0},
        NORMAL=np.tile([0, 0, 1], (4, 1)).astype("f"),
        TEXCOORD_0=QUAD_UV,
    )
    builder.node(mesh=0, scale=[-1, 1, 1])
    scene = builder.load()
    assert (front_faces(scene)[:, 2] > 0).all()
    assert np.allclose(scene.normals, [0, 0, 1])
    assert np.allclose(scene.tangents, [-1, 0, 0, -1])
    bitangent = np.cross(scene.normals, scene.tangents[:, :3]) * scene.tangents[:, 3:]
    assert np.allclose(bitangent, [0, 1, 0])


def test_normals_go_by_the_inverse_transpose():
    builder = Builder()
    slanted = np.array([[0, 0, 0], [1, 0, -1], [0, 1, 0]], "f")
    builder.mesh(slanted, NORMAL=np.tile([ROOT, 0, ROOT], (3, 1)).astype("f"))
    builder.node(mesh=0, scale=[4, 1, 1])
    scene = builder.load()
    front = front_faces(scene)[0]
    assert np.allclose(scene.normals, front / np.linalg.norm(front), atol=1e-6)


def test_every_instance_of_every_primitive_is_an_object():
    builder = Builder()
    builder.mesh(TRIANGLE)
    builder.tree["meshes"][0]["primitives"].append(builder.tree["meshes"][0]["primitives"][0])
    builder.mesh(QUAD, QUAD_INDICES)
    for mesh in (0, 1, 0):
        builder.node(mesh=mesh)
    scene = builder.load()
    assert np.bincount(scene.object_of_triangle).tolist() == [1, 1, 1, 1, 2]


def instancing(builder, **attributes):
    accessors = {name: builder.accessor(values) for name, values in attributes.items()}
    return {"EXT_mesh_gpu_instancing": {"attributes": accessors}}


def test_gpu_instances_stand_within_their_node():
    builder = Builder(extensionsRequired=["EXT_mesh_gpu_instancing"])
    builder.mesh(TRIANGLE)
    extension = instancing(
        builder,
        TRANSLATION=np.array([[1, 0, 0], [0, 5, 0]], "f"),
        SCALE=np.array([[1, 1, 1], [2, 2, -2]], "f"),
        ROTATION=np.array([[0, 0, ROOT, ROOT], [0, 0, 0, 1]], "f"),
        _ID=np.array([7, 8], "f"),
    )
    builder.node(mesh=0, translation=[0, 0, 10], extensions=extension)
    builder.node(mesh=0)
    scene = builder.load()
    assert np.allclose(scene.positions[:3], [[1, 0, 10], [1, 1, 10], [0, 0, 10]], atol=1e-6)
    assert np.allclose(scene.positions[3:6], [[0, 5, 10], [2, 5, 10], [0, 7, 10]])
    assert np.allclose(scene.positions[6:], TRIANGLE)
    assert scene.object_of_triangle.tolist() == [0, 1, 2]
    assert scene.warnings == ()


def test_gpu_instances_need_equal_counts_and_finite_values():
    for wrong in (np.ones((3, 3), "f"), np.full((2, 3), np.nan, "f")):
        builder = Builder()
        builder.mesh(TRIANGLE)
        given = instancing(builder, TRANSLATION=np.zeros((2, 3), "f"), SCALE=wrong)
        builder.node(mesh=0, extensions=given)
        with pytest.raises(InvalidScene, match=r"nodes\[0\].extensions.EXT_mesh_gpu_instancing"):
            builder.load()


def scene_of(*nodes, **parts):
    builder = Builder(nodes=list(nodes), **parts)
    builder.mesh(TRIANGLE)
    return builder


NAN = float("nan")
EYE = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
BROKEN = {
    "self": (scene_of({"children": [0]}), "nodes[0].children"),
    "cycle": (scene_of({"children": [1]}, {"children": [2]}, {"children": [1]}), "children"),
    "elsewhere": (scene_of({}, {"children": [1]}, scenes=[{"nodes": [0]}]), "nodes[1].children"),
    "child": (scene_of({"children": [1]}), "nodes[0].children"),
    "negative child": (scene_of({"children": [-1]}), "nodes[0].children"),
    "mesh": (scene_of({"mesh": 1}), "nodes[0].mesh"),
    "camera": (scene_of({"camera": 0}), "nodes[0].camera"),
    "matrix NaN": (scene_of({"matrix": [NAN] * 16}), "nodes[0].matrix"),
    "matrix infinite": (scene_of({"matrix": [*EYE[:15], 1e999]}), "nodes[0].matrix"),
    "matrix of 15": (scene_of({"matrix": EYE[:15]}), "nodes[0].matrix"),
    "projective": (scene_of({"matrix": [*EYE[:3], 0.5, *EYE[4:]]}), "nodes[0].matrix"),
    "translation of 2": (scene_of({"translation": [1, 2]}), "nodes[0].translation"),
    "scale of text": (scene_of({"scale": ["1", 1, 1]}), "nodes[0].scale"),
    "far": (scene_of({"mesh": 0, "translation": [1e19, 0, 0]}), "nodes[0]"),
    "overflow": (
        scene_of(
            {"scale": [1e200, 1, 1], "children": [1]},
            {"scale": [1e200, 1, 1], "children": [2]},
            {"mesh": 0},
        ),
        "nodes[1]",
    ),
    "root": (scene_of({}, scenes=[{"nodes": [0, 5]}]), "scenes[0].nodes[1]"),
    "scene": (scene_of({}, scenes=[{"nodes": [0]}], scene=1), "scene"),
    "negative scene": (scene_of({}, scenes=[{"nodes": [0]}], scene=-1), "scene"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_hierarchy_is_refused_by_name(name):
    builder, field = BROKEN[name]
    with pytest.raises(InvalidScene) as raised:
        builder.load()
    assert field in raised.value.field


def test_flattening_transforms_are_fine_but_named():
    builder = scene_of({"mesh": 0, "scale": [0, 0, 0]}, {"mesh": 0, "scale": [1, 1, 0]})
    scene = builder.load()
    assert len(scene.triangles) == 2
    assert np.allclose(scene.normals[3:], [0, 0, 1])
    assert scene.warnings == ("nodes[0], nodes[1]: its transform has no volume and flattens",)


def test_odd_rotations_are_repaired():
    scene = scene_of({"mesh": 0, "rotation": [0, 0, 0, 0]}, {"mesh": 0, "rotation": [0, 0, 0, 9]})
    loaded = scene.load()
    assert np.allclose(loaded.positions, np.tile(TRIANGLE, (2, 1)))
    assert len(loaded.warnings) == 2


def test_a_shared_node_is_shown_once_per_parent_within_the_limit():
    def chain(length):
        nodes = [{"children": [n + 1, n + 1]} for n in range(length)]
        return scene_of(*nodes, {"mesh": 0})

    assert len(chain(5).load().triangles) == 32
    with pytest.raises(LimitExceeded):
        chain(40).load()


def test_depth_nodes_instances_and_triangles_are_limited():
    deep = scene_of(*[{"children": [n + 1]} for n in range(20)], {"mesh": 0})
    assert len(deep.load().triangles) == 1
    for limits in (
        Limits(max_node_depth=20),
        Limits(max_nodes=20),
        Limits(max_triangles=0),
        Limits(max_vertices=2),
    ):
        with pytest.raises(LimitExceeded) as raised:
            deep.load(limits)
        assert raised.value.field
    copies = scene_of({"mesh": 0})
    given = instancing(copies, TRANSLATION=np.zeros((50, 3), "f"))
    copies.tree["nodes"][0]["extensions"] = given
    with pytest.raises(LimitExceeded):
        copies.load(Limits(max_nodes=49))
    with pytest.raises(LimitExceeded):
        copies.load(Limits(max_triangles=49))


def test_without_scenes_all_roots_are_shown():
    builder = scene_of({"mesh": 0}, {"children": [2]}, {"mesh": 0}, scenes=[])
    scene = builder.load()
    assert len(scene.triangles) == 2
    assert "all root nodes" in scene.warnings[0]


def test_the_default_scene_is_shown_and_the_others_named():
    scenes = [{"nodes": [0]}, {"nodes": [0, 1]}]
    builder = scene_of({"mesh": 0}, {"mesh": 0}, scenes=scenes, scene=1)
    scene = builder.load()
    assert len(scene.triangles) == 2
    assert "only scenes[1]" in scene.warnings[0]


def test_skins_and_animations_are_named():
    builder = scene_of({"mesh": 0, "skin": 0}, skins=[{"joints": [0]}], animations=[{}])
    told = "\n".join(builder.load().warnings)
    assert "skins" in told and "animations" in told


def test_an_empty_document_is_an_empty_scene():
    for parts in ({}, {"scenes": [{}]}, {"nodes": [{}]}):
        scene = Builder(**parts).load()
        assert len(scene.triangles) == 0
        assert any("no triangles" in warning for warning in scene.warnings)


def test_sixty_thousand_instances_load_quickly():
    builder = Builder()
    builder.mesh(TRIANGLE)
    builder.tree["nodes"] = [{"mesh": 0, "translation": [n, 0, 0]} for n in range(60_000)]
    scene = builder.load()
    assert len(scene.triangles) == 60_000
    assert scene.positions[::3, 0].tolist() == list(range(60_000))
