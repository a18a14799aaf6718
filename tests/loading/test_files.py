"""The set of files of a scene, and everything it must not read."""

import io
import os
import struct
import zipfile
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from raysvc.errors import InvalidInput, InvalidScene, LimitExceeded, Unsupported
from raysvc.limits import Limits
from raysvc.loading.files import Files

SMALL = Limits(max_file_bytes=1000, max_scene_bytes=1500, max_files=4)


def zipped(files: dict[str, bytes], method: int = zipfile.ZIP_DEFLATED) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", method) as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return buffer.getvalue()


def test_an_upload_reads_what_was_sent():
    files = Files.from_memory({"a.gltf": b"{}", "tex/b.png": b"png"})
    assert files.main == "a.gltf"
    assert files.read("a.gltf") == b"{}"
    assert files.read("./tex/../tex/b.png") == b"png"
    assert files.read("tex\\b.png") == b"png"
    assert files.names() == ("a.gltf", "tex/b.png")
    assert "tex/b.png" in files and "b.png" not in files and "../a.gltf" not in files


def test_names_are_relative_to_the_folder_of_the_main_file():
    files = Files.from_memory({"source/a.gltf": b"{}", "textures/b.png": b"png"})
    assert files.main == "a.gltf"
    assert files.read("../textures/b.png") == b"png"
    assert files.names() == ("../textures/b.png", "a.gltf")


def test_an_upload_without_folders_finds_side_files_by_base_name():
    files = Files.from_memory({"a.gltf": b"{}", "b.png": b"png"})
    assert files.read("textures/b.png") == b"png"


@pytest.mark.parametrize("sent", [["a.obj", "b.ply"], ["readme.txt"], []])
def test_the_main_file_must_be_said_where_it_is_not_obvious(sent):
    with pytest.raises(InvalidScene) as raised:
        Files.from_memory(dict.fromkeys(sent, b""))
    assert raised.value.field == "main"
    assert all(name in raised.value.message for name in sent if name != "readme.txt")


def test_the_main_file_must_be_among_the_files():
    with pytest.raises(InvalidScene, match=r"no file c\.obj"):
        Files.from_memory({"a.obj": b""}, main="c.obj")


BAD_NAMES = [
    "http://127.0.0.1/x",
    "HTTPS://example.org/x",
    "file:///etc/passwd",
    "//server/share",
    "\\\\server\\share",
    "C:\\windows\\x",
    "/etc/passwd",
    "..",
    "../x",
    "a/../../x",
    "a\\..\\..\\x",
    "",
    ".",
    "a\0b",
    "missing.bin",
    "x" * 5000,
]


@pytest.mark.parametrize("name", BAD_NAMES)
def test_nothing_but_the_files_is_read(name, tmp_path):
    (tmp_path / "x").write_bytes(b"secret")
    folder = tmp_path / "scene"
    folder.mkdir()
    (folder / "a.gltf").write_bytes(b"{}")
    for files in (Files.from_memory({"a.gltf": b"{}"}), Files.from_path(folder / "a.gltf")):
        assert name not in files
        with pytest.raises(InvalidScene) as raised:
            files.read(name, field="buffers[0].uri")
        assert raised.value.field == "buffers[0].uri"
        assert len(str(raised.value)) < 400


@given(st.text(max_size=30))
def test_any_name_is_found_or_refused(name):
    files = Files.from_memory({"a.gltf": b"{}"})
    try:
        assert files.read(name) == b"{}"
    except InvalidScene as error:
        assert error.field == "uri"


def test_a_file_on_disk_reads_its_side_files(tmp_path):
    (tmp_path / "a.gltf").write_bytes(b"{}")
    (tmp_path / "tex").mkdir()
    (tmp_path / "tex" / "b.png").write_bytes(b"png")
    files = Files.from_path(tmp_path / "a.gltf")
    assert files.read(files.main) == b"{}"
    assert files.read("tex/b.png") == b"png"
    assert "tex/b.png" in files and "tex" not in files
    assert files.names() == ("a.gltf",)


def test_a_symbolic_link_may_not_leave_the_folder(tmp_path):
    (tmp_path / "secret").write_bytes(b"secret")
    folder = tmp_path / "scene"
    folder.mkdir()
    (folder / "a.gltf").write_bytes(b"{}")
    (folder / "inner").write_bytes(b"inner")
    (folder / "good").symlink_to("inner")
    (folder / "bad").symlink_to("../secret")
    (folder / "loop").symlink_to("loop")
    (folder / "up").symlink_to("..")
    files = Files.from_path(folder / "a.gltf")
    assert files.read("good") == b"inner"
    for name in ("bad", "loop", "up/secret"):
        with pytest.raises(InvalidScene):
            files.read(name)


def test_devices_and_pipes_are_not_opened(tmp_path):
    os.mkfifo(tmp_path / "pipe.glb")
    (tmp_path / "a.gltf").write_bytes(b"{}")
    files = Files.from_path(tmp_path / "a.gltf")
    with pytest.raises(InvalidScene, match="not a regular file"):
        files.read("pipe.glb")
    for path in (tmp_path / "pipe.glb", Path("/dev/zero"), tmp_path, tmp_path / "none.glb"):
        with pytest.raises(InvalidScene):
            Files.from_path(path)


def test_sizes_on_disk_are_limited(tmp_path):
    (tmp_path / "a.gltf").write_bytes(b"{}")
    (tmp_path / "large").write_bytes(bytes(1001))
    (tmp_path / "b").write_bytes(bytes(800))
    (tmp_path / "c").write_bytes(bytes(800))
    files = Files.from_path(tmp_path / "a.gltf", SMALL)
    with pytest.raises(LimitExceeded, match="1,001 bytes"):
        files.read("large")
    files.read("b")
    files.read("b")
    with pytest.raises(LimitExceeded):
        files.read("c")


def test_sizes_of_uploads_are_limited():
    with pytest.raises(LimitExceeded):
        Files.from_memory({"a.obj": bytes(1001)}, limits=SMALL)
    with pytest.raises(LimitExceeded):
        Files.from_memory({"a.obj": bytes(800), "b": bytes(800)}, limits=SMALL)
    with pytest.raises(LimitExceeded):
        Files.from_memory({f"{n}": b"" for n in range(5)}, limits=SMALL)
    with pytest.raises(InvalidScene, match="two files"):
        Files.from_memory({"a.obj": b"", "./a.obj": b""})


def test_an_archive_reads_like_an_upload(tmp_path):
    data = zipped({"m/a.gltf": b"{}", "m/t/b.png": b"png", "__MACOSX/m/._a.gltf": b"junk"})
    (tmp_path / "scene.ZIP").write_bytes(data)
    for files in (Files.from_zip(data), Files.from_path(tmp_path / "scene.ZIP")):
        assert files.main == "a.gltf"
        assert files.read("t/b.png") == b"png"


def test_archives_that_expand_too_far_are_refused_before_they_are_unpacked():
    with pytest.raises(LimitExceeded, match="200 times"):
        Files.from_zip(zipped({"a.obj": bytes(1 << 20)}))
    with pytest.raises(LimitExceeded):
        Files.from_zip(zipped({"a.obj": bytes(2000)}), SMALL)
    with pytest.raises(LimitExceeded):
        Files.from_zip(zipped({"a.obj": bytes(800), "b": bytes(800)}), SMALL)
    with pytest.raises(LimitExceeded):
        Files.from_zip(zipped({f"{n}.obj": b"" for n in range(5)}), SMALL)


def test_an_archive_that_lies_about_a_size_is_refused():
    data = bytearray(zipped({"a.obj": bytes(range(200))}, zipfile.ZIP_STORED))
    directory = data.index(b"PK\x01\x02")
    struct.pack_into("<I", data, directory + 24, 100)
    with pytest.raises(InvalidScene):
        Files.from_zip(bytes(data))


@pytest.mark.parametrize(
    "name", ["../a.obj", "/a.obj", "m/../../a.obj", "C:/a.obj", "\\\\s\\a.obj"]
)
def test_archives_whose_names_leave_the_folder_are_refused(name):
    with pytest.raises(InvalidScene):
        Files.from_zip(zipped({name: b""}))


def test_encrypted_nested_linked_and_odd_archives_are_refused():
    encrypted = bytearray(zipped({"a.obj": b"v"}))
    encrypted[6] |= 1
    encrypted[encrypted.index(b"PK\x01\x02") + 8] |= 1
    with pytest.raises(InvalidScene, match="encrypted"):
        Files.from_zip(bytes(encrypted))
    with pytest.raises(InvalidScene, match="within an archive"):
        Files.from_zip(zipped({"a.obj": b"", "b.zip": zipped({"c.obj": b""})}))
    link = zipfile.ZipInfo("a.obj")
    link.external_attr = 0o120777 << 16
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        archive.writestr(link, "/etc/passwd")
    with pytest.raises(InvalidScene, match="symbolic link"):
        Files.from_zip(buffer.getvalue())
    with pytest.raises(Unsupported):
        Files.from_zip(zipped({"a.obj": b"v"}, zipfile.ZIP_LZMA))


def test_a_damaged_archive_never_raises_anything_else(rng):
    whole = zipped({"m/a.obj": bytes(rng.integers(0, 9, 300, dtype="u1")), "b.png": b"png"})
    for size in range(0, len(whole), 7):
        with pytest.raises(InvalidInput):
            Files.from_zip(whole[:size])
    for _ in range(500):
        damaged = bytearray(whole)
        for at in rng.integers(0, len(whole), 3):
            damaged[at] = rng.integers(256)
        try:
            Files.from_zip(bytes(damaged))
        except InvalidInput as error:
            assert error.field
