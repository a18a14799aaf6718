"""PLY, STL, OFF and 3MF to scenes, and what holds for every mesh file."""

import io
import struct
import time
import zipfile
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from raysvc.errors import InvalidInput, InvalidScene, LimitExceeded, Unsupported
from raysvc.limits import Limits
from raysvc.loading import load_scene
from raysvc.loading.files import Files
from tests.loading.mesh_text import (
    CORNERS,
    TRIANGLE,
    XYZ,
    cube,
    loaded,
    ply,
    png,
    stl,
    used_corners,
)

# --- PLY ---


def test_ply_in_text_and_in_binary_is_the_same():
    text = ply("0 0 0\n1 0 0\n0 1 0\n", 3, XYZ, "3 0 1 2\n", 1)
    head = text[: text.index(b"end_header\n") + 11]
    for order in "<>":
        kind = b"binary_little_endian" if order == "<" else b"binary_big_endian"
        body = struct.pack(f"{order}9fB3i", 0, 0, 0, 1, 0, 0, 0, 1, 0, 3, 0, 1, 2)
        scene = loaded(head.replace(b"ascii", kind) + body, "a.ply")
        assert used_corners(scene) == CORNERS
    assert used_corners(loaded(text, "a.ply")) == CORNERS


def test_ply_colours_of_vertices_are_linear_and_translucent_ones_blend():
    colour = "".join(f"property uchar {c}\n" for c in ("red", "green", "blue", "alpha"))
    rows = "0 0 0 255 0 188 51\n1 0 0 255 0 188 51\n0 1 0 255 0 188 51\n"
    scene = loaded(ply(rows, 3, XYZ + colour, "3 0 1 2\n", 1), "a.ply")
    assert np.allclose(scene.colours, [1, 0, 0.50289, 0.2], atol=1e-4)
    material = scene.materials[scene.material_of_triangle[0]]
    assert material.alpha_mode == "blend"
    assert material.base_colour == (1, 1, 1, 1)


def test_ply_colours_of_faces_are_not_smeared_over_their_neighbours():
    data = (
        b"ply\nformat ascii 1.0\nelement vertex 4\n" + XYZ.encode() + b"element face 2\n"
        b"property list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\n"
        b"property uchar blue\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
        b"3 0 1 2 255 0 0\n3 0 2 3 0 0 255\n"
    )
    scene = loaded(data, "a.ply")
    assert np.allclose(scene.colours[scene.triangles[0]], [1, 0, 0, 1])
    assert np.allclose(scene.colours[scene.triangles[1]], [0, 0, 1, 1])


def test_ply_normals_and_texture_coordinates_are_read():
    more = "property float nx\nproperty float ny\nproperty float nz\n" + (
        "property float s\nproperty float t\n"
    )
    rows = "0 0 0 0 2 0 0 0\n1 0 0 0 2 0 1 0\n0 1 0 0 2 0 0 1\n"
    data = ply(rows, 3, XYZ + more, "3 0 1 2\n", 1).replace(
        b"element vertex", b"comment TextureFile t.png\nelement vertex"
    )
    scene = loaded(data, "a.ply", t_png=png([[(9, 8, 7, 255)]]))
    assert np.allclose(scene.normals, [0, 1, 0])
    assert scene.uv[scene.triangles[0], 0].tolist() == [[0, 1], [1, 1], [0, 0]]
    assert scene.textures[0].texels.tolist() == [[[9, 8, 7, 255]]]
    assert scene.materials[0].base_colour_texture is not None


def test_ply_texture_coordinates_of_corners_split_vertices():
    data = (
        b"ply\nformat ascii 1.0\nelement vertex 4\n" + XYZ.encode() + b"element face 2\n"
        b"property list uchar int vertex_indices\nproperty list uchar float texcoord\n"
        b"end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
        b"3 0 1 2 6 0 0 .5 0 .5 1\n3 0 2 3 6 .5 0 1 1 .5 1\n"
    )
    scene = loaded(data, "a.ply")
    assert scene.uv[scene.triangles[0], 0].tolist() == [[0, 1], [0.5, 1], [0.5, 0]]
    assert scene.uv[scene.triangles[1], 0].tolist() == [[0.5, 1], [1, 0], [0.5, 0]]


def test_a_point_cloud_is_an_empty_scene_with_a_warning():
    scene = loaded(ply("0 0 0\n1 0 0\n", 2, XYZ, "", 0), "a.ply")
    assert len(scene.triangles) == 0
    assert "points" in scene.warnings[0]


def test_triangle_strips_are_unsupported_rather_than_dropped():
    data = (
        f"ply\nformat ascii 1.0\nelement vertex 3\n{XYZ}element tristrips 1\n"
        "property list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
    )
    with pytest.raises(Unsupported, match="tristrips"):
        loaded(data, "a.ply")


def test_polygons_of_different_sizes_in_binary_ply_are_refused():
    text = ply("", 4, XYZ, "", 2).replace(b"ascii", b"binary_little_endian")
    square = struct.pack("<12f", 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0)
    faces = struct.pack("<B3iB3i", 3, 0, 1, 2, 4, 0, 2, 3)
    with pytest.raises(InvalidScene, match="polygons"):
        loaded(text + square + faces, "a.ply")


@pytest.mark.parametrize("face", ["3 0 1 3\n", "3 0 1 -1\n", "3 0 1\n", "3 0 1 nan\n", "x\n", ""])
def test_ply_faces_of_what_is_not_there_are_refused(face):
    with pytest.raises(InvalidScene, match=r"a\.ply"):
        loaded(ply("0 0 0\n1 0 0\n0 1 0\n", 3, XYZ, face, 1), "a.ply")


@pytest.mark.parametrize("kind", [b"ascii", b"binary_little_endian"])
@pytest.mark.parametrize("element", [b"vertex 3", b"face 1"])
def test_ply_counts_larger_than_the_file_are_refused_at_once(kind, element):
    data = ply("0 0 0\n1 0 0\n0 1 0\n", 3, XYZ, "3 0 1 2\n", 1).replace(b"ascii", kind)
    start = time.perf_counter()
    with pytest.raises(InvalidScene, match="more than its bytes can hold"):
        loaded(data.replace(element, element[:-1] + b"2000000000"), "a.ply")
    assert time.perf_counter() - start < 0.5


# --- STL ---


def test_an_stl_soup_is_welded_and_keeps_its_sharp_edges():
    corners, triangles = cube()
    scene = loaded(stl(corners[triangles]), "a.stl")
    assert len(scene.triangles) == 12
    assert len(scene.positions) == 24
    assert np.allclose(np.abs(scene.normals).max(axis=1), 1)


def test_stl_in_text_with_two_solids_is_read():
    solid = (
        "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
        "endloop\nendfacet\nendsolid s\n"
    )
    scene = loaded(solid + solid.replace("1 0 0", "2 0 0"), "a.stl")
    assert len(scene.triangles) == 2
    assert scene.bounds()[1].tolist() == [2, 1, 0]


@pytest.mark.parametrize("count", [0, 1, 3, 2**32 - 1])
def test_stl_of_another_length_than_it_says_is_refused(count):
    corners, triangles = cube()
    data = bytearray(stl(corners[triangles[:2]]))
    data[80:84] = struct.pack("<I", count)
    with pytest.raises(InvalidScene, match=r"a\.stl.*count"):
        loaded(bytes(data), "a.stl")


# --- OFF ---


def test_off_with_comments_and_quads_is_read():
    scene = loaded("# c\nOFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0 # d\n4 0 1 2 3\n", "a.off")
    assert len(scene.triangles) == 2
    assert np.allclose(scene.normals, [0, 0, 1])


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("OFF\n999999999999999999 1 0\n0 0 0\n", "can hold"),
        ("OFF\n" + "9" * 400 + " 1 0\n0 0 0\n", "can hold"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", ""),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", ""),
        ("OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "faces"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 nan 0\n3 0 1 2\n", "NaN"),
        ("OFF\n", "begin"),
    ],
)
def test_off_that_lies_is_refused(text, reason):
    with pytest.raises(InvalidScene, match=rf"a\.off.*{reason}"):
        loaded(text, "a.off")


# --- 3MF ---

MODEL = (
    '<model unit="{unit}" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">'
    "<resources>{objects}</resources><build>{items}</build></model>"
)
MESH = (
    '<object id="1"><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/>'
    '<vertex x="0" y="0" z="1"/></vertices><triangles><triangle v1="0" v2="1" v3="2"/>'
    "</triangles></mesh></object>"
)


def threemf(objects: str, items: str, unit: str = "meter", doctype: str = "") -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        model = MODEL.format(unit=unit, objects=objects, items=items)
        archive.writestr("3D/3dmodel.model", doctype + model)
    return buffer.getvalue()


def test_3mf_is_turned_upright_and_scaled_to_metres():
    scene = loaded(threemf(MESH, '<item objectid="1"/>', "centimeter"), "a.3mf")
    assert np.allclose(used_corners(scene), [[0, 0, 0], [0.01, 0, 0], [0, 0.01, 0]])
    assert np.allclose(scene.normals, [0, 0, 1])


def test_3mf_items_and_components_are_placed():
    group = (
        '<object id="2"><components><component objectid="1" transform="1 0 0 0 1 0 0 0 1 5 0 0"/>'
        '<component objectid="1"/></components></object>'
    )
    items = '<item objectid="2" transform="2 0 0 0 2 0 0 0 2 0 0 1"/>'
    scene = loaded(threemf(MESH + group, items), "a.3mf")
    assert len(scene.triangles) == 2
    assert scene.bounds().tolist() == [[0, 1, 0], [12, 3, 0]]


def test_mirrored_3mf_instances_are_not_inside_out():
    items = '<item objectid="1" transform="-1 0 0 0 1 0 0 0 1 0 0 0"/>'
    assert np.allclose(loaded(threemf(MESH, items), "a.3mf").normals, [0, 0, 1])


def test_3mf_bombs_and_cycles_are_refused():
    cycle = '<object id="1"><components><component objectid="1"/></components></object>'
    with pytest.raises(InvalidScene, match="contain themselves"):
        loaded(threemf(cycle, '<item objectid="1"/>'), "a.3mf")
    doubling = MESH + "".join(
        f'<object id="{n}"><components>{f"<component objectid={chr(34)}{n - 1}{chr(34)}/>" * 2}'
        "</components></object>"
        for n in range(2, 42)
    )
    with pytest.raises(LimitExceeded):
        loaded(threemf(doubling, '<item objectid="41"/>'), "a.3mf")
    laughs = '<!DOCTYPE lolz [<!ENTITY a "b">]>'
    with pytest.raises(InvalidScene, match="document type"):
        loaded(threemf(MESH, '<item objectid="1"/>', doctype=laughs), "a.3mf")


@pytest.mark.parametrize(
    ("objects", "items"),
    [
        ("", '<item objectid="9"/>'),
        (MESH.replace('v3="2"', 'v3="3"'), '<item objectid="1"/>'),
        (MESH.replace('x="1"', 'x="one"'), '<item objectid="1"/>'),
        (MESH, '<item objectid="1" transform="1 2 3"/>'),
        ("<object", ""),
    ],
)
def test_broken_3mf_is_refused(objects, items):
    with pytest.raises(InvalidScene, match=r"a\.3mf"):
        loaded(threemf(objects, items), "a.3mf")


# --- All ---


SOUND: dict[str, Callable[[], bytes]] = {
    "a.obj": lambda: (TRIANGLE + "f 1 2 3\n").encode(),
    "a.ply": lambda: ply("0 0 0\n1 0 0\n0 1 0\n", 3, XYZ, "3 0 1 2\n", 1),
    "a.stl": lambda: stl(np.array([CORNERS])),
    "a.off": lambda: b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
    "a.3mf": lambda: threemf(MESH, '<item objectid="1"/>'),
}


@pytest.mark.parametrize("name", SOUND)
def test_every_truncation_is_read_or_refused_by_name(name):
    whole = SOUND[name]()
    for length in range(0, len(whole), 1 + len(whole) // 60):
        try:
            loaded(whole[:length], name)
        except InvalidInput as error:
            assert error.field


@pytest.mark.parametrize("name", SOUND)
@given(st.integers(min_value=0), st.integers(min_value=0, max_value=255))
def test_every_changed_byte_is_read_or_refused(name, place, value):
    data = bytearray(SOUND[name]())
    data[place % len(data)] = value
    try:
        loaded(bytes(data), name)
    except InvalidInput as error:
        assert error.field


@pytest.mark.parametrize("name", SOUND)
def test_limits_are_kept(name):
    files = Files.from_memory({name: SOUND[name]()}, name)
    with pytest.raises(LimitExceeded):
        load_scene(files, Limits(max_triangles=0))


@pytest.mark.assets
def test_the_dragon_is_smooth(assets):
    scene = load_scene(assets / "mesh" / "dragon_res2.ply")
    assert len(scene.triangles) == 202_520
    assert len(scene.positions) < 1.15 * 100_250
    assert scene.warnings == ()


@pytest.mark.assets
def test_spot_has_texture_coordinates_and_a_warning(assets):
    scene = load_scene(assets / "mesh" / "spot_textured" / "spot_triangulated.obj")
    assert len(scene.triangles) == 5_856
    assert -0.1 < scene.uv.min() < 0.1
    assert 0.9 < scene.uv.max() < 1.1
    assert "mtllib" in scene.warnings[0]


@pytest.mark.assets
def test_hostile_meshes_are_read_or_refused_in_little_time(assets):
    hostile = assets / "hostile"
    paths = [
        *(hostile / "assimp" / "OBJ").glob("*.obj"),
        *(hostile / "assimp" / "OFF").iterdir(),
        *(hostile / "assimp" / "PLY").iterdir(),
        *(hostile / "assimp" / "STL").iterdir(),
        *(hostile / "assimp" / "invalid").iterdir(),
        *(p for p in (hostile / "crafted").iterdir() if p.suffix in (".obj", ".ply", ".stl")),
    ]
    refused = set()
    for path in paths:
        start = time.perf_counter()
        try:
            load_scene(path)
        except InvalidInput as error:
            assert error.field
            refused.add(path.name)
        assert time.perf_counter() - start < 2.0
    assert refused >= {p.name for p in paths if p.parent.name in ("invalid", "crafted")}
    assert refused >= {"invalid.off", "obj_index_zero.obj", "stl_count_bomb.stl"}
    assert not refused & {"box_UTF16BE.obj", "regr01.obj", "sphereWithHole.stl", "formatDetection"}
