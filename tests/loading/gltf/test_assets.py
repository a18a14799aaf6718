"""Real glTF files, and crafted ones that lie."""

import time
from pathlib import Path

import numpy as np
import pytest

from raysvc.errors import InvalidInput
from raysvc.loading.files import Files
from raysvc.loading.gltf import load_gltf
from raysvc.scene import Scene
from tests.loading.gltf.building import TRIANGLE

pytestmark = pytest.mark.assets


def load(path: Path) -> Scene:
    return load_gltf(Files.from_path(path))


def listed(assets: Path) -> dict[str, str]:
    """Path and number of triangles (of all instances) of every glTF file of the index."""
    lines = (assets / "INDEX.tsv").read_text().splitlines()[1:]
    rows = [line.split("\t") for line in lines if line.startswith("gltf/")]
    return {row[0]: row[2].rpartition("/")[2].removesuffix("inst") for row in rows}


def test_every_real_file_has_its_triangles_and_no_warnings(assets):
    files = listed(assets)
    assert len(files) >= 13
    for name, triangles in files.items():
        scene = load(assets / name)
        assert len(scene.triangles) == int(triangles), name
        assert scene.warnings == (), name


def test_every_hostile_file_loads_or_is_refused_within_seconds(assets):
    folder = assets / "hostile"
    paths = [p for p in folder.rglob("*") if p.suffix in (".gltf", ".glb")]
    assert len(paths) > 50
    for path in paths:
        began = time.monotonic()
        try:
            load(path)
        except InvalidInput as error:
            assert error.field, path.name
            assert not path.name.startswith("valid_")
        assert time.monotonic() - began < 5, path.name


REFUSED = {
    "accessor_count_4e8_no_bufferview.gltf": "accessors[0].count",
    "bufferview_negative_offset.gltf": "bufferViews[0].byteOffset",
    "ext_required_unknown.gltf": "extensionsRequired[0]",
    "glb_chunklen_4G.glb": "glb.chunks[0].length",
    "glb_totallen_4G.glb": "glb.length",
    "glb_v1.glb": "glb.version",
    "huge_3e38_positions.gltf": "accessors[0]",
    "index_count_2e40.gltf": "accessors[1].count",
    "index_oob_u32.gltf": "meshes[0].primitives[0].indices",
    "material_oob.gltf": "meshes[0].primitives[0].material",
    "matrix_nan.gltf": "nodes[0].matrix",
    "nan_inf_positions.gltf": "accessors[0]",
    "no_position.gltf": "meshes[0].primitives[0].attributes.POSITION",
    "node_chain_20000_deep.gltf": "nodes[999].children",
    "node_cycle.gltf": "nodes[0].children",
    "node_self_cycle.gltf": "nodes[0].children",
    "node_dag_2e40_paths.gltf": "nodes",
    "scene_oob.gltf": "scene",
    "texture_garbage.gltf": "images[0]",
    "texture_png_bomb.gltf": "images[0]",
    "texture_source_oob.gltf": "textures[0].source",
    "uri_dev_zero.gltf": "buffers[0].uri",
    "uri_http_loopback.gltf": "buffers[0].uri",
    "uri_path_traversal.gltf": "buffers[0].uri",
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_refusal_names_what_is_wrong(assets, name):
    with pytest.raises(InvalidInput) as raised:
        load(assets / "hostile/crafted" / name)
    assert raised.value.field == REFUSED[name]


@pytest.fixture
def crafted(assets):
    return lambda name: load(assets / "hostile/crafted" / name)


def assert_is_the_triangle(scene: Scene, count: int = 1):
    assert len(scene.triangles) == count
    corners = scene.positions[scene.triangles[0]]
    assert any(np.array_equal(np.roll(corners, turn, axis=0), TRIANGLE) for turn in range(3))


def test_harmless_oddities_still_show_the_triangle(crafted):
    for name in ("glb_ok.glb", "bom_utf8.gltf", "stride_zero.gltf", "valid_triangle_fan.gltf"):
        assert_is_the_triangle(crafted(name))
    assert crafted("valid_triangle_fan.gltf").warnings == ()


def test_a_mirrored_triangle_still_faces_forwards(crafted):
    scene = crafted("scale_negative.gltf")
    a, b, c = scene.positions[scene.triangles[0]]
    assert np.cross(b - a, c - a)[2] > 0
    assert np.array_equal(scene.normals[0], [0, 0, 1])


def test_sixty_thousand_instances_are_shown(crafted):
    assert len(crafted("instances_60000.gltf").triangles) == 60_000


def test_a_camera_and_a_mesh_on_one_node_are_both_there(crafted):
    scene = crafted("valid_camera_and_mesh_same_node.gltf")
    assert_is_the_triangle(scene, 3)
    moved = scene.positions[scene.triangles[1:]] - TRIANGLE
    assert np.array_equal(moved, np.broadcast_to([1, 2, 8], (2, 3, 3)))
    assert np.array_equal(scene.cameras[0].world_from_camera[:3, 3], [1, 2, 8])


@pytest.mark.parametrize(
    ("name", "aspect"),
    [
        ("valid_camera_nested_noaspect.gltf", None),
        ("valid_camera_nested_with_child_mesh.gltf", 1.5),
    ],
)
def test_a_nested_camera_stands_in_the_world(crafted, name, aspect):
    scene = crafted(name)
    assert_is_the_triangle(scene, 2)
    (camera,) = scene.cameras
    assert np.array_equal(camera.world_from_camera[:3, 3], [1, 2, 8])
    assert np.array_equal(camera.world_from_camera[:3, :3], np.eye(3))
    assert camera.fov_y_deg == pytest.approx(np.degrees(0.8))
    assert camera.aspect_ratio == aspect


def test_an_orthographic_camera_is_there(crafted):
    (camera,) = crafted("valid_camera_ortho.gltf").cameras
    assert (camera.fov_y_deg, camera.height_m, camera.aspect_ratio) == (None, 2, 1)


def test_vertex_colours_are_exact(crafted):
    assert np.allclose(crafted("valid_color_f32.gltf").colours, [0.001, 0.5, 2, 1], rtol=1e-6)
    assert crafted("valid_color_u16.gltf").colours.tolist() == [[1, 0, 0, 1]] * 3


def test_dark_factors_and_emissive_strength_are_exact(crafted):
    (material,) = crafted("valid_dark_factor_emissive_strength.gltf").materials
    assert material.base_colour == (0.001, 0.002, 0.003, 1)
    assert material.emissive == (25, 25, 25)


def test_a_document_without_geometry_is_an_empty_scene(crafted):
    scene = crafted("valid_no_geometry.gltf")
    assert len(scene.triangles) == 0
    assert "no triangles" in scene.warnings[0]


def test_normalised_texture_coordinates_are_fractions(crafted):
    scene = crafted("valid_uv_u16_normalized.gltf")
    assert scene.uv[:, 0].tolist() == [[0, 0], [1, 0], [0, 1]]


def test_the_flight_helmet_is_textured_and_tangent(assets):
    scene = load(assets / "gltf/FlightHelmet/FlightHelmet.gltf")
    assert len(scene.textures) == 15 and len(scene.materials) == 6
    assert set(np.unique(scene.tangents[:, 3])) <= {-1, 0, 1}
    length = np.linalg.norm(scene.tangents[scene.tangents[:, 3] != 0, :3], axis=1)
    assert np.allclose(length, 1, atol=1e-5)


def test_multi_uv_reads_the_second_set(assets):
    scene = load(assets / "gltf/MultiUVTest/MultiUVTest.gltf")
    (material,) = scene.materials
    assert {ref.uv_set for ref in material.texture_refs() if ref is not None} == {0, 1}
    assert not np.array_equal(scene.uv[:, 0], scene.uv[:, 1])
