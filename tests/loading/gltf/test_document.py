"""The document and its container: text, versions, lengths, extensions."""

import json
import struct

import numpy as np
import pytest

from raysvc.errors import InvalidInput, InvalidScene, LimitExceeded, Unsupported
from raysvc.limits import DEFAULT_LIMITS, Limits
from raysvc.loading.files import Files
from raysvc.loading.gltf import assemble, load_gltf
from tests.loading.gltf.building import TRIANGLE, Builder, glb, load_text, triangle_with


def plain() -> Builder:
    builder = Builder()
    builder.mesh(TRIANGLE)
    return builder


def load_glb(data: bytes, limits=DEFAULT_LIMITS):
    return load_gltf(Files.from_memory({"scene.glb": data}), limits)


def test_a_container_and_a_text_make_the_same_scene():
    one, two = plain().load(), load_glb(plain().container())
    assert np.array_equal(one.positions, two.positions)
    assert one.warnings == two.warnings == ()
    assert (one.name, two.name) == ("scene.gltf", "scene.glb")


def test_a_byte_order_mark_is_skipped_and_named():
    scene = load_text(b"\xef\xbb\xbf" + plain().text())
    assert len(scene.triangles) == 1
    assert "byte order mark" in scene.warnings[0]


def test_unknown_chunks_and_trailing_bytes_are_named():
    scene = load_glb(plain().container() + b"more")
    assert "after the end" in scene.warnings[0]
    builder = plain()
    builder.tree["buffers"] = [{"byteLength": len(builder.data)}]
    builder.shown()
    text = json.dumps(builder.tree).encode()
    more = [(0x004E4942, b"two."), (0x12345678, b"????")]
    scene = load_glb(glb(text, builder.data, *more))
    assert len(scene.triangles) == 1
    assert len(scene.warnings) == 2


def header(version=2, length=None, chunks=b""):
    length = 12 + len(chunks) if length is None else length
    return struct.pack("<4sII", b"glTF", version, length) + chunks


CONTAINERS = {
    "only magic": (b"glTF", "glb"),
    "short header": (b"glTF\2\0\0\0", "glb"),
    "version 1": (header(version=1), "glb.version"),
    "no chunks": (header(), "glb.chunks[0]"),
    "longer than the file": (header(length=1 << 31), "glb.length"),
    "length 0": (header(length=0), "glb.chunks[0]"),
    "chunk too long": (
        header(chunks=struct.pack("<II", 0xFFFFFFF0, 0x4E4F534A)),
        "glb.chunks[0].length",
    ),
    "binary first": (header(chunks=struct.pack("<II", 0, 0x004E4942)), "glb.chunks[0]"),
    "empty text": (header(chunks=struct.pack("<II", 0, 0x4E4F534A)), "json"),
    "many chunks": (
        header(chunks=struct.pack("<II", 0, 0x4E4F534A) * 100),
        "glb.chunks",
    ),
}


@pytest.mark.parametrize("name", CONTAINERS)
def test_a_container_that_lies_is_refused_by_name(name):
    data, field = CONTAINERS[name]
    with pytest.raises(InvalidInput) as raised:
        load_glb(data)
    assert raised.value.field == field


def test_every_truncation_of_a_container_is_refused():
    whole = plain().container()
    for size in range(len(whole)):
        with pytest.raises(InvalidInput):
            load_glb(whole[:size])


ASSET = b'"asset": {"version": "2.0"}'
TEXTS = {
    "nothing": (b"", "scene.gltf"),
    "HTML": (b"<html></html>", "json"),
    "a list": (b"[]", "json"),
    "a number": (b"1", "json"),
    "cut off": (plain().text()[:100], "json"),
    "not UTF-8": (b'{"asset": {"version": "2.0", "generator": "\xff"}}', "json"),
    "UTF-16": ("{}".encode("utf-16"), "json"),
    "huge number": (b'{"scene": ' + b"9" * 5000 + b"}", "json"),
    "deep": (b"[" * 100_000 + b"]" * 100_000, "json"),
    "deep in extras": (b'{"extras": ' + b"[" * 65 + b"]" * 65 + b"}", "json"),
    "no asset": (b"{}", "asset.version"),
    "asset of text": (b'{"asset": "2.0"}', "asset"),
    "version of number": (b'{"asset": {"version": 2.0}}', "asset.version"),
    "no version": (b'{"asset": {}}', "asset.version"),
    "version 1": (b'{"asset": {"version": "1.0"}}', "asset.version"),
    "newer": (b'{"asset": {"version": "2.1", "minVersion": "2.1"}}', "asset.version"),
    "nodes of object": (b"{" + ASSET + b', "nodes": {}}', "nodes"),
    "node of number": (b"{" + ASSET + b', "nodes": [1]}', "nodes[0]"),
    "used of numbers": (b"{" + ASSET + b', "extensionsRequired": [1]}', "extensionsRequired[0]"),
    "extensions of list": (b"{" + ASSET + b', "extensions": []}', "extensions"),
    "required": (
        b"{" + ASSET + b', "extensionsRequired": ["KHR_draco_mesh_compression"]}',
        "extensionsRequired[0]",
    ),
}


@pytest.mark.parametrize("name", TEXTS)
def test_a_faulty_text_is_refused_by_name(name):
    text, field = TEXTS[name]
    with pytest.raises(InvalidInput) as raised:
        load_text(text)
    assert raised.value.field == field


def test_brackets_in_strings_are_no_nesting():
    builder = plain()
    builder.tree["extras"] = {"odd": '"[{\\' + "[" * 200}
    assert len(builder.load().triangles) == 1


def test_a_newer_minor_version_is_read():
    builder = plain()
    builder.tree["asset"] = {"version": "2.9", "minVersion": "2.0"}
    assert len(builder.load().triangles) == 1


def test_the_number_of_values_is_bounded():
    with pytest.raises(LimitExceeded, match="values"):
        load_text(b"[" + b"[]," * 5000 + b"[]]", limits=Limits(max_nodes=10))


def test_unsupported_extensions_are_named_where_they_are():
    builder = triangle_with(materials=[{}])
    builder.tree["meshes"][0]["primitives"][0]["extensions"] = {"KHR_materials_variants": {}}
    builder.tree["bufferViews"][0]["extensions"] = {"EXT_meshopt_compression": {}}
    builder.tree["extensions"] = {"VENDOR_x": {}}
    told = builder.load().warnings
    assert [warning.partition(":")[0] for warning in told] == [
        "document",
        "bufferViews[0]",
        "meshes[0].primitives[0]",
    ]


def test_null_counts_as_absent():
    builder = plain()
    builder.tree |= {"scene": None, "cameras": None, "extensions": None}
    builder.tree["nodes"] = [{"mesh": 0, "matrix": None, "children": None}]
    builder.tree["scenes"] = [{"nodes": [0]}]
    assert len(builder.load().triangles) == 1


def test_required_extensions_that_are_supported_are_fine():
    builder = plain()
    builder.tree["extensionsRequired"] = ["KHR_texture_transform", "KHR_materials_unlit"]
    assert builder.load().warnings == ()
    builder.tree["extensionsRequired"].append("KHR_materials_sheen")
    with pytest.raises(Unsupported, match="KHR_materials_sheen"):
        builder.load()


def test_running_out_of_memory_is_the_inputs_fault(monkeypatch):
    def exhausted(*_):
        raise MemoryError

    monkeypatch.setattr(assemble, "read_hierarchy", exhausted)
    with pytest.raises(LimitExceeded) as raised:
        plain().load()
    assert raised.value.field == "scene.gltf"
    assert not isinstance(raised.value, InvalidScene)
