"""Primitives of meshes: how much they hold, and their triangles (specification, section 3.7)."""

import numpy as np
import pygltflib

from raysvc.errors import InvalidScene
from raysvc.loading.gltf import topology
from raysvc.loading.gltf.accessors import Accessors
from raysvc.loading.gltf.attributes import KNOWN, AttributeReader, Shape
from raysvc.loading.gltf.document import Document, item
from raysvc.loading.gltf.extensions import note_unsupported
from raysvc.scene import Material


class Primitives:
    """Reads the primitives of a document."""

    def __init__(self, document: Document, accessors: Accessors) -> None:
        self._document, self._accessors = document, accessors

    def size(self, primitive: pygltflib.Primitive, path: str) -> tuple[int, int]:
        """Return a bound on vertices and the number of triangles, without decoding anything.

        Triangles are 0 for points and lines. Raises InvalidScene where POSITION is missing or the
        mode unknown.
        """
        if primitive.mode not in topology.NAMES and primitive.mode not in topology.MODES:
            raise InvalidScene(f"{primitive.mode} is unknown", f"{path}.mode")
        if primitive.mode in topology.NAMES:
            return 0, 0
        attributes = primitive.attributes
        if "POSITION" not in attributes:
            raise InvalidScene("is missing", f"{path}.attributes.POSITION")
        vertices = self._accessors.count(attributes["POSITION"], f"{path}.attributes.POSITION")
        drawn = vertices
        if primitive.indices is not None:
            drawn = self._accessors.count(primitive.indices, f"{path}.indices")
        triangles = topology.triangle_count(primitive.mode, drawn)
        return 3 * triangles if "NORMAL" not in attributes else min(
            vertices, 3 * triangles
        ), triangles

    def read(self, primitive: pygltflib.Primitive, path: str) -> Shape:
        """Return a primitive's triangles, every index checked."""
        vertices = self._accessors.count(
            primitive.attributes["POSITION"], f"{path}.attributes.POSITION"
        )
        if primitive.indices is None:
            indices = np.arange(vertices)
        else:
            indices = self._accessors.indices(primitive.indices, f"{path}.indices")
            if indices.size and indices.max() >= vertices:
                raise InvalidScene(
                    f"has index {indices.max()}; there are {vertices} vertices", f"{path}.indices"
                )
        triangles = topology.triangles_of(primitive.mode, indices)
        reader = AttributeReader(
            primitive.attributes, path, self._accessors, self._document.journal
        )
        return reader.read(triangles)

    def note_missing_uv(
        self, primitive: pygltflib.Primitive, path: str, material: Material
    ) -> None:
        """Warn where the material reads texture coordinates that the primitive does not have."""
        for ref in material.texture_refs():
            if ref is not None and f"TEXCOORD_{ref.uv_set}" not in primitive.attributes:
                self._document.journal.note(
                    f"has no TEXCOORD_{ref.uv_set}, which its material reads", path
                )

    def note_missing_tangents(self, shape: Shape, path: str) -> None:
        """Warn where nothing gives a direction to an anisotropic material."""
        if not shape.tangents.any():
            self._document.journal.note(
                "has neither tangents nor texture coordinates to make them from, which its "
                "material's anisotropy wants: it is left out",
                path,
            )

    def note_missing(self, primitive: pygltflib.Primitive, path: str) -> None:
        """Warn of everything of a primitive that will not be seen."""
        journal = self._document.journal
        note_unsupported(primitive, path, journal)
        if primitive.mode in topology.NAMES:
            journal.note(f"{topology.NAMES[primitive.mode]} are not triangles: not shown", path)
            return
        if primitive.targets:
            journal.note("morph targets are not supported: shown without", path)
        for name in primitive.attributes:
            if name not in KNOWN and not name.startswith(("_", "JOINTS_", "WEIGHTS_")):
                journal.note(f"{name[:80]} is not used", path)
        drawn = primitive.attributes["POSITION"] if primitive.indices is None else primitive.indices
        count = item(self._document.gltf.accessors, drawn, "accessors", path).count
        if count < 3 or (primitive.mode == topology.LIST and count % 3):
            journal.note("the last triangle is incomplete and left out", path)
