"""Small files of every kind, read once before the first upload: libraries import their parts, and
decoders load theirs, only when they are needed."""

import base64
import contextlib
import io
import json

import numpy as np
from PIL import Image

from raysvc.errors import InvalidInput
from raysvc.limits import Limits
from raysvc.loading import load_environment, load_scene
from raysvc.loading.files import Files

_OBJ = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
_OFF = b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
_PLY = (
    b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
    b"property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    b"0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
)
_HDR = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n" + bytes([128, 128, 128, 129] * 2)


def rehearse(limits: Limits) -> None:
    """Read them all; what cannot be read here will not be read later either."""
    for name, data in (
        ("rehearsal.obj", _OBJ),
        ("rehearsal.off", _OFF),
        ("rehearsal.ply", _PLY),
        ("rehearsal.stl", _stl()),
        ("rehearsal.gltf", _gltf()),
    ):
        with contextlib.suppress(InvalidInput):
            load_scene(Files.from_memory({name: data}, name, limits), limits)
    with contextlib.suppress(InvalidInput):
        load_environment({"rehearsal.hdr": _HDR}, limits)


def _stl() -> bytes:
    corners = np.array([[0, 0, 1], [0, 0, 0], [1, 0, 0], [0, 1, 0]], "<f4")
    return bytes(80) + (1).to_bytes(4, "little") + corners.tobytes() + bytes(2)


def _gltf() -> bytes:
    """A triangle with a texture."""
    picture = io.BytesIO()
    Image.new("RGB", (2, 2)).save(picture, "PNG")
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "<f4").tobytes()
    document = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "scene": 0,
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"source": 0}],
        "images": [{"uri": "data:image/png;base64," + _base64(picture.getvalue())}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": len(corners)}],
        "buffers": [
            {
                "uri": "data:application/octet-stream;base64," + _base64(corners),
                "byteLength": len(corners),
            }
        ],
    }
    return json.dumps(document).encode()


def _base64(data: bytes) -> str:
    return base64.b64encode(data).decode("ascii")
