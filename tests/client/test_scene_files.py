import json
import struct
from pathlib import Path

import pytest

from raysvc.client.scene_files import main_among, scene_files
from raysvc.errors import InvalidScene

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


def sent(path: Path) -> list[str]:
    files = scene_files(path)
    assert all(file.is_file() for file in files.values())
    return list(files)


def test_buffers_and_pictures_of_a_gltf_go_along(tmp_path: Path) -> None:
    document = {
        "buffers": [{"uri": "mesh.bin"}, {"uri": "data:;base64,AA=="}, {}],
        "images": [{"uri": "textures/a%20b.png"}, {"uri": "missing.png"}, {"bufferView": 0}],
    }
    (tmp_path / "scene.gltf").write_text(json.dumps(document))
    (tmp_path / "mesh.bin").write_bytes(b"")
    (tmp_path / "textures").mkdir()
    (tmp_path / "textures" / "a b.png").write_bytes(b"")
    (tmp_path / "other.png").write_bytes(b"")
    assert sent(tmp_path / "scene.gltf") == ["scene.gltf", "mesh.bin", "textures/a b.png"]


def test_pictures_beside_a_glb_go_along(tmp_path: Path) -> None:
    text = json.dumps({"images": [{"uri": "a.png"}]}).encode()
    header = struct.pack("<4sII", b"glTF", 2, 20 + len(text)) + struct.pack(
        "<I4s", len(text), b"JSON"
    )
    (tmp_path / "scene.glb").write_bytes(header + text)
    (tmp_path / "a.png").write_bytes(b"")
    assert sent(tmp_path / "scene.glb") == ["scene.glb", "a.png"]


def test_materials_and_pictures_of_an_obj_go_along(tmp_path: Path) -> None:
    (tmp_path / "scene.obj").write_text(f"mtllib my stuff.mtl\r\nmtllib gone.mtl\n{TRIANGLE}")
    lines = ["newmtl a", "map_Kd -s 2 2 1 oak wood.png", "\tmap_Bump bump.png", "Kd 1 1 1"]
    (tmp_path / "my stuff.mtl").write_text("\n".join(lines))
    (tmp_path / "oak wood.png").write_bytes(b"")
    (tmp_path / "bump.png").write_bytes(b"")
    expected = ["scene.obj", "my stuff.mtl", "oak wood.png", "bump.png"]
    assert sent(tmp_path / "scene.obj") == expected


@pytest.mark.parametrize(
    "uri", ["../secret.txt", "%2e%2e/secret.txt", "link.txt", "file:secret.txt"]
)
def test_nothing_outside_of_the_folder_is_sent(tmp_path: Path, uri: str) -> None:
    (tmp_path / "secret.txt").write_text("secret")
    folder = tmp_path / "scene"
    folder.mkdir()
    (folder / "link.txt").symlink_to(tmp_path / "secret.txt")
    (folder / "scene.gltf").write_text(json.dumps({"images": [{"uri": uri}]}))
    (folder / "scene.obj").write_text(f"mtllib {uri}\n{TRIANGLE}")
    assert sent(folder / "scene.gltf") == ["scene.gltf"]
    assert sent(folder / "scene.obj") == ["scene.obj"]


@pytest.mark.parametrize(
    "text", ["", "[]", "{", '{"images": 7}', '{"images": [7, {"uri": 7}]}', "[" * 100_000]
)
def test_what_is_wrong_with_a_file_the_service_says(tmp_path: Path, text: str) -> None:
    (tmp_path / "scene.gltf").write_text(text)
    (tmp_path / "scene.glb").write_text(text[:1000])
    assert sent(tmp_path / "scene.gltf") == ["scene.gltf"]
    assert sent(tmp_path / "scene.glb") == ["scene.glb"]


@pytest.mark.parametrize("name", ["none.glb", "none.zip", "."])
def test_a_file_that_is_not_there_is_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(InvalidScene):
        scene_files(tmp_path / name)


@pytest.mark.parametrize(
    ("names", "main"),
    [
        (["a.gltf", "a.bin"], None),
        (["a.zip"], None),
        (["a.gltf", "b.ply"], "a.gltf"),
        (["scene"], "scene"),
        (["scene", "b.ply"], "scene"),
    ],
)
def test_the_scene_is_named_where_it_could_be_another(names: list[str], main: str | None) -> None:
    assert main_among(names) == main
