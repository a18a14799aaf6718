"""Making small glTF documents in tests."""

import base64
import io
import json
import struct
from typing import Any

import numpy as np
from PIL import Image

from raysvc.limits import DEFAULT_LIMITS, Limits
from raysvc.loading.files import Files
from raysvc.loading.gltf import load_gltf
from raysvc.scene import Scene

COMPONENTS = {"b": 5120, "B": 5121, "h": 5122, "H": 5123, "I": 5125, "f": 5126}
TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}

TRIANGLE = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "f")
QUAD = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], "f")
QUAD_UV = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], "f")
QUAD_INDICES = np.array([0, 1, 2, 0, 2, 3], "H")


class Builder:
    """A document with one buffer; `tree` may be changed at will before loading."""

    def __init__(self, **parts: Any) -> None:
        self.tree: dict[str, Any] = {"asset": {"version": "2.0"}, **parts}
        self.data = b""
        self.files: dict[str, bytes] = {}

    def add(self, kind: str, thing: dict[str, Any]) -> int:
        """Append to one of the document's arrays and return the index."""
        self.tree.setdefault(kind, []).append(thing)
        return len(self.tree[kind]) - 1

    def view(self, data: bytes, **more: Any) -> int:
        self.data += bytes(-len(self.data) % 4)
        thing = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data), **more}
        self.data += data
        return self.add("bufferViews", thing)

    def accessor(self, values: Any, **more: Any) -> int:
        values = np.asarray(values)
        values = values.reshape(len(values), -1)
        thing = {
            "bufferView": self.view(np.ascontiguousarray(values).tobytes()),
            "componentType": COMPONENTS[values.dtype.char],
            "count": len(values),
            "type": TYPES[values.shape[1]],
            **more,
        }
        return self.add("accessors", {k: v for k, v in thing.items() if v is not None})

    def mesh(
        self, positions: Any = TRIANGLE, indices: Any = None, more: Any = None, **attributes: Any
    ) -> int:
        """Add a mesh of one primitive; attributes are arrays or indices of accessors."""
        primitive: dict[str, Any] = {"attributes": {}, **(more or {})}
        for name, values in {"POSITION": positions, **attributes}.items():
            whole = isinstance(values, int)
            primitive["attributes"][name] = values if whole else self.accessor(values)
        if indices is not None:
            primitive["indices"] = self.accessor(indices)
        return self.add("meshes", {"primitives": [primitive]})

    def node(self, **node: Any) -> int:
        return self.add("nodes", node)

    def png(self, pixels: Any, **texture: Any) -> int:
        """Add a picture as an image and a texture; returns the texture."""
        image = self.add("images", {"uri": data_uri(encoded(pixels), "image/png")})
        return self.add("textures", {"source": image, **texture})

    def shown(self) -> None:
        """Put every mesh, camera and root into a scene if none was made."""
        if "nodes" not in self.tree:
            for mesh in range(len(self.tree.get("meshes", []))):
                self.node(mesh=mesh)
        if "scenes" not in self.tree and "nodes" in self.tree:
            inner = {c for node in self.tree["nodes"] for c in node.get("children", [])}
            roots = [n for n in range(len(self.tree["nodes"])) if n not in inner]
            self.tree["scenes"] = [{"nodes": roots}]
            self.tree["scene"] = 0

    def text(self) -> bytes:
        self.shown()
        tree = dict(self.tree)
        if self.data and "buffers" not in tree:
            uri = data_uri(self.data, "application/octet-stream")
            tree["buffers"] = [{"byteLength": len(self.data), "uri": uri}]
        return json.dumps(tree).encode()

    def container(self) -> bytes:
        """Return the document as a .glb."""
        self.shown()
        tree = dict(self.tree)
        if self.data:
            tree["buffers"] = [{"byteLength": len(self.data)}]
        return glb(json.dumps(tree).encode(), self.data)

    def load(self, limits: Limits = DEFAULT_LIMITS) -> Scene:
        return load_text(self.text(), self.files, limits)


def load_text(
    text: bytes, side: dict[str, bytes] | None = None, limits: Limits = DEFAULT_LIMITS
) -> Scene:
    files = Files.from_memory({"scene.gltf": text, **(side or {})}, "scene.gltf", limits)
    return load_gltf(files, limits)


def glb(text: bytes, binary: bytes = b"", *more: tuple[int, bytes]) -> bytes:
    chunks = [(0x4E4F534A, text + b" " * (-len(text) % 4))]
    if binary:
        chunks.append((0x004E4942, binary + bytes(-len(binary) % 4)))
    body = b"".join(struct.pack("<II", len(d), kind) + d for kind, d in [*chunks, *more])
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


def data_uri(data: bytes, kind: str) -> str:
    return f"data:{kind};base64,{base64.b64encode(data).decode()}"


def encoded(pixels: Any, kind: str = "PNG", **options: Any) -> bytes:
    buffer = io.BytesIO()
    image = pixels if isinstance(pixels, Image.Image) else Image.fromarray(np.asarray(pixels))
    image.save(buffer, kind, **options)
    return buffer.getvalue()


def textured(texture: int = 0, **info: Any) -> dict[str, Any]:
    """A material whose base colour reads a texture."""
    return {"pbrMetallicRoughness": {"baseColorTexture": {"index": texture, **info}}}


def triangle_with(**more: Any) -> Builder:
    """One triangle with material 0; `more` are parts of the document."""
    builder = Builder(**more)
    builder.mesh(TRIANGLE, more={"material": 0})
    return builder


def front_faces(scene: Scene) -> np.ndarray:
    """(F, 3) cross products of the edges, which point to the front."""
    corner = scene.positions[scene.triangles].astype(float)
    return np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
