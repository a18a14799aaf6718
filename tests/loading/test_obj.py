"""OBJ and MTL to scenes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from raysvc.errors import InvalidInput, InvalidScene
from raysvc.loading.mtl import PLAIN
from tests.loading.mesh_text import CORNERS, TRIANGLE, loaded, png, used_corners

# --- OBJ ---


def test_an_obj_triangle_keeps_its_corners_and_winding():
    scene = loaded(TRIANGLE + "f 1 2 3\n")
    assert used_corners(scene) == CORNERS
    assert np.allclose(scene.normals, [0, 0, 1])
    assert scene.materials == (PLAIN,)
    assert scene.materials[0].double_sided
    assert scene.name == "a"
    assert scene.warnings == ()


@pytest.mark.parametrize(
    "text",
    [
        TRIANGLE + "f -3 -2 -1\n",
        TRIANGLE + "f -3 -2 -1\nv 9 9 9\n",
        "  v 0 0 0\n\tv\t1 0  0 # comment\r\nv 0 1 0\r\n  f  1\t2 3  # comment\n",
        "v 0 0 0\nv 1 0 \\\n0\nv 0 1 0\nf 1 \\\n2 3",
        TRIANGLE + "f 1// 2// 3//\n",
    ],
)
def test_obj_is_read_however_it_is_written(text):
    assert used_corners(loaded(text)) == CORNERS


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "latin-1"])
def test_obj_is_read_in_many_encodings(encoding):
    text = f"# Größe\n{TRIANGLE}f 1 2 3\n"
    assert used_corners(loaded(text.encode(encoding))) == CORNERS


def test_polygons_become_triangles():
    square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
    assert len(loaded(square + "f 1 2 3 4\n").triangles) == 2
    assert len(loaded(square + "f 1 2 3 4\nf 1 2 3\n").triangles) == 3
    pentagon = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv .5 2 0\nv 0 1 0\n"
    assert len(loaded(pentagon + "f 1 2 3 4 5\n").triangles) == 3


def test_v_of_texture_coordinates_is_turned_over():
    scene = loaded(TRIANGLE + "vt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n")
    uv = scene.uv[scene.triangles[0], 0]
    assert uv.tolist() == [[0, 1], [1, 1], [0, 0]]


def test_normals_of_the_file_are_used_at_unit_length():
    scene = loaded(TRIANGLE + "vn 0 3 4\nf 1//1 2//1 3//1\n")
    assert np.allclose(scene.normals, [0, 0.6, 0.8])


def test_zero_normals_are_replaced_with_a_warning():
    scene = loaded(TRIANGLE + "vn 0 0 0\nf 1//1 2//1 3//1\n")
    assert np.allclose(scene.normals, [0, 0, 1])
    assert "normals" in scene.warnings[0]


def test_colours_of_vertices_are_taken_as_srgb():
    scene = loaded("v 0 0 0 1 0 0.5\nv 1 0 0 1 0 0.5\nv 0 1 0 1 0 0.5\nf 1 2 3\n")
    assert np.allclose(scene.colours, [1, 0, 0.21404, 1], atol=1e-4)


def test_objects_and_materials_are_told_apart():
    scene = loaded(
        "mtllib m.mtl\n" + TRIANGLE + "o one\nusemtl red\nf 1 2 3\nusemtl blue paint\nf 3 2 1\n"
        "o two\nusemtl red\nf 2 3 1\n",
        m_mtl="newmtl red\nKd 1 0 0\nnewmtl blue paint\nKd 0 0 1\n",
    )
    assert [material.name for material in scene.materials] == ["red", "blue paint"]
    assert scene.materials[1].base_colour == (0, 0, 1, 1)
    assert sorted(scene.material_of_triangle) == [0, 0, 1]
    assert len(set(scene.object_of_triangle)) == 3


def test_a_material_that_is_nowhere_is_plain_and_warned_of():
    scene = loaded("mtllib gone.mtl\n" + TRIANGLE + "usemtl what\nf 1 2 3\n")
    assert scene.materials[0].base_colour == PLAIN.base_colour
    assert "gone.mtl is missing" in " ".join(scene.warnings)
    assert "'what'" in " ".join(scene.warnings)


def test_texture_coordinates_without_a_library_are_warned_of():
    scene = loaded(TRIANGLE + "vt 0 0\nf 1/1 2/1 3/1\n", spot_png=png([[(1, 2, 3, 255)]]))
    assert "mtllib" in scene.warnings[0]
    assert scene.textures == ()


def test_points_and_lines_are_warned_of():
    scene = loaded(TRIANGLE + "p 1 2\nl 1 2\nf 1 2 3\n")
    assert scene.warnings == ("points are not drawn", "lines are not drawn")
    assert len(scene.triangles) == 1
    empty = loaded(TRIANGLE)
    assert len(empty.triangles) == 0
    assert "nothing to draw" in empty.warnings[0]


@pytest.mark.parametrize(
    ("faces", "reason"),
    [
        ("f 1 2 4\n", "not there"),
        ("f 0 1 2\n", "index 0"),
        ("f 1 2 0\n", "index 0"),
        ("f 1 2 -4\n", "not there"),
        ("f 1 2\n", "fewer than three"),
        ("f\n", "fewer than three"),
        ("f 1 2 x\n", ""),
        ("f 1/1/1/1/1 2 3\n", ""),
        ("f 99999999999999999999 1 2\n", ""),
    ],
)
def test_faces_of_what_is_not_there_are_refused(faces, reason):
    with pytest.raises(InvalidScene, match=rf"a\.obj.*{reason}"):
        loaded(TRIANGLE + faces)


@pytest.mark.parametrize("value", ["nan", "inf", "-inf", "1e300", "3e38"])
def test_positions_that_cannot_be_computed_with_are_refused(value):
    with pytest.raises(InvalidScene, match=r"a\.obj.*positions"):
        loaded(f"v {value} 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")


@pytest.mark.parametrize("name", ["../../etc/passwd", "/etc/passwd", "http://a/b.mtl", "file:x"])
def test_libraries_and_textures_elsewhere_are_refused(name):
    with pytest.raises(InvalidScene, match="mtllib"):
        loaded(f"mtllib {name}\n{TRIANGLE}f 1 2 3\n")
    with pytest.raises(InvalidScene, match="texture"):
        loaded(f"mtllib m.mtl\n{TRIANGLE}f 1 2 3\n", m_mtl=f"newmtl m\nmap_Kd {name}\n")


def test_binary_data_called_obj_is_refused():
    with pytest.raises(InvalidScene, match="binary"):
        loaded(b"v 0 0 0\n\0\0\0")


@given(st.text(alphabet="vfntusemlib 0123456789./-\n", max_size=200))
def test_any_obj_text_is_read_or_refused(text):
    try:
        loaded(text)
    except InvalidInput as error:
        assert error.field
