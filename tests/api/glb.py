"""A small glTF, made in code: one triangle, in one file or with its buffer beside it."""

import json
import struct

import numpy as np

POSITIONS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32).tobytes()


def document(uri: str | None = None) -> dict[str, object]:
    buffer: dict[str, object] = {"byteLength": len(POSITIONS)}
    if uri is not None:
        buffer["uri"] = uri
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": 5126,
                "count": 3,
                "type": "VEC3",
                "min": [0, 0, 0],
                "max": [1, 1, 0],
            }
        ],
        "bufferViews": [{"buffer": 0, "byteLength": len(POSITIONS)}],
        "buffers": [buffer],
    }


def gltf(uri: str) -> bytes:
    return json.dumps(document(uri)).encode()


def glb() -> bytes:
    text = json.dumps(document()).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    chunks += struct.pack("<I4s", len(POSITIONS), b"BIN\0") + POSITIONS
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
