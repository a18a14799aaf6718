"""Finding scenes by name, path, suffix and content."""

import struct
import zipfile

import pytest
from hypothesis import given
from hypothesis import strategies as st

from raysvc.builtin import BUILTIN_SCENES
from raysvc.errors import InvalidInput, InvalidScene, LimitExceeded, NotFound
from raysvc.limits import Limits
from raysvc.loading import load_scene, scene_file
from raysvc.loading.files import Files

OBJ = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
PLY = (
    b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
    b"property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    b"0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
)
OFF = b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
STL_TEXT = (
    b"solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
    b"endloop\nendfacet\nendsolid s\n"
)
STL_BINARY = b"\0" * 80 + struct.pack("<I12fH", 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0)


def in_memory(data: bytes, name: str) -> Files:
    return Files.from_memory({name: data}, name)


@pytest.mark.parametrize("name", ["cornell", "shiny"])
def test_built_in_scenes_are_found_by_name(name):
    scene = load_scene(f"builtin:{name}")
    assert scene.name == name
    assert len(scene.triangles)


@pytest.mark.parametrize("name", ["builtin:", "builtin:park", "builtin:../cornell"])
def test_an_unknown_name_is_answered_with_the_names_that_there_are(name):
    with pytest.raises(NotFound) as caught:
        load_scene(name)
    assert all(known in str(caught.value) for known in BUILTIN_SCENES)


@pytest.mark.parametrize("data", [OBJ, PLY, OFF, STL_TEXT, STL_BINARY])
def test_a_file_without_a_known_suffix_is_known_by_its_content(data):
    assert len(load_scene(in_memory(data, "upload")).triangles) == 1
    assert len(load_scene(in_memory(data, "upload.bin")).triangles) == 1


@pytest.mark.parametrize(
    ("data", "suffix"), [(OBJ, "OBJ"), (PLY, "Ply"), (OFF, "off"), (STL_TEXT, "STL")]
)
def test_suffixes_are_known_in_any_case(tmp_path, data, suffix):
    path = tmp_path / f"scene.{suffix}"
    path.write_bytes(data)
    assert len(load_scene(path).triangles) == 1
    assert len(load_scene(str(path)).triangles) == 1


def test_an_archive_of_a_scene_and_its_side_files_is_a_scene(tmp_path):
    path = tmp_path / "scene.zip"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("model/a.obj", b"mtllib a.mtl\n" + OBJ.replace(b"f ", b"usemtl m\nf "))
        archive.writestr("model/a.mtl", b"newmtl m\nKd 1 0 0\n")
    scene = load_scene(path)
    assert scene.materials[0].base_colour == (1, 0, 0, 1)
    assert scene.warnings == ()


@pytest.mark.parametrize(
    "data", [b"", b"\n", b"hello", b"\x89PNG\r\n\x1a\n", b"<html>", b"\0" * 99]
)
def test_what_is_no_scene_is_refused_with_the_formats_that_are(data):
    with pytest.raises(InvalidScene, match=r"^upload: .*\.gltf.*\.obj"):
        load_scene(in_memory(data, "upload"))


def test_a_missing_file_and_a_folder_are_refused(tmp_path):
    with pytest.raises(InvalidScene, match=r"none\.obj"):
        load_scene(tmp_path / "none.obj")
    with pytest.raises(InvalidScene):
        load_scene(tmp_path)


@pytest.mark.parametrize("error", [ValueError, AssertionError, UnicodeError, RecursionError])
def test_no_other_exception_escapes_from_a_reader(monkeypatch, error):
    def fail(*_: object) -> None:
        raise error("inside")

    monkeypatch.setattr(scene_file, "load_mesh", fail)
    with pytest.raises(InvalidScene, match=rf"a\.obj.*{error.__name__}.*inside"):
        load_scene(in_memory(OBJ, "a.obj"))


def test_running_out_of_memory_is_a_matter_of_limits(monkeypatch):
    def fail(*_: object) -> None:
        raise MemoryError

    monkeypatch.setattr(scene_file, "load_mesh", fail)
    with pytest.raises(LimitExceeded, match=r"a\.obj"):
        load_scene(in_memory(OBJ, "a.obj"))


def test_files_larger_than_the_limit_are_refused(tmp_path):
    path = tmp_path / "a.obj"
    path.write_bytes(OBJ)
    with pytest.raises(LimitExceeded):
        load_scene(path, Limits(max_file_bytes=10))


@given(st.binary(max_size=300), st.sampled_from(["a", "a.obj", "a.ply", "a.stl", "a.off", "a.3mf"]))
def test_any_bytes_are_read_or_refused(data, name):
    try:
        load_scene(in_memory(data, name))
    except InvalidInput as error:
        assert error.field
