"""Geometry of 3MF: a zip of XML with objects, components of objects, and a list of what to build.

3MF Core Specification 1.3. trimesh's reader needs two further packages and follows every path
through the components, of which a small file can have 2^40; this one counts as it goes.
"""

import io
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from xml.etree import ElementTree

import numpy as np

from raysvc.errors import InvalidScene, LimitExceeded
from raysvc.limits import Limits
from raysvc.loading.archive import unpack
from raysvc.loading.mesh_parts import MeshPart
from raysvc.types import Doubles

_METRES = {
    "micron": 1e-6, "millimeter": 1e-3, "centimeter": 1e-2, "inch": 0.0254, "foot": 0.3048,
    "meter": 1.0,
}  # fmt: skip
# 3MF has +Z up; here +Y is.
_UP = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
_MAX_DEPTH = 100


@dataclass(slots=True)
class _Object:
    """A mesh, or a composition of other objects with (4, 4) transforms."""

    positions: Doubles = field(default_factory=lambda: np.zeros((0, 3)))
    triangles: np.ndarray = field(default_factory=lambda: np.zeros((0, 3), np.int64))
    components: list[tuple[str, Doubles]] = field(default_factory=list)


def read_3mf(data: bytes, limits: Limits, name: str, warn: Callable[[str], None]) -> list[MeshPart]:
    """Read what a 3MF file builds, in metres with +Y up: a part, of material 0, for every instance.

    Raises InvalidScene, LimitExceeded, or what a broken file makes Python raise.
    """
    archive = unpack(data, limits)
    models = [key for key in archive if key.lower().endswith("3d/3dmodel.model")]
    if not models:
        raise InvalidScene("holds no 3D/3dmodel.model", name)
    model = archive[models[0]]
    if re.search(rb"<!(DOCTYPE|ENTITY)", model, re.IGNORECASE):
        raise InvalidScene("has a document type in its XML, which 3MF forbids", name)
    objects: dict[str, _Object] = {}
    build: list[tuple[str, Doubles]] = []
    scale = _METRES["millimeter"]
    for _, element in ElementTree.iterparse(io.BytesIO(model), ("end",)):
        tag = _tag(element)
        if tag == "object":
            objects[element.attrib["id"]] = _object(element)
            element.clear()
        elif tag == "build":
            build = [_reference(item) for item in element if _tag(item) == "item"]
        elif tag == "model":
            scale = _METRES[element.attrib.get("unit", "millimeter")]
        elif tag in ("basematerials", "colorgroup", "texture2dgroup"):
            warn(f"3MF's {tag} are not read")
    to_metres = _UP @ np.diag([scale, scale, scale, 1.0])
    parts: list[MeshPart] = []
    triangles = 0
    for reference, transform in build:
        for placed, world in _instances(reference, to_metres @ transform, objects, 0, name):
            triangles += len(placed.triangles)
            if len(parts) >= limits.max_nodes or triangles > limits.max_triangles:
                raise LimitExceeded("has too many instances or triangles", name)
            parts.append(_part(placed, world))
    return parts


def _tag(element: ElementTree.Element) -> str:
    return element.tag.rpartition("}")[2]


def _object(element: ElementTree.Element) -> _Object:
    made = _Object()
    for child in element.iter():
        tag = _tag(child)
        if tag == "vertices":
            rows = [[float(v.attrib[axis]) for axis in "xyz"] for v in child]
            made.positions = np.array(rows).reshape(-1, 3)
        elif tag == "triangles":
            corners = [[int(t.attrib[v]) for v in ("v1", "v2", "v3")] for t in child]
            made.triangles = np.array(corners, np.int64).reshape(-1, 3)
        elif tag == "component":
            made.components.append(_reference(child))
    return made


def _reference(element: ElementTree.Element) -> tuple[str, Doubles]:
    """Which object, and its (4, 4) transform: 3MF writes rows of a matrix for row vectors."""
    matrix = np.eye(4)
    if "transform" in element.attrib:
        values = [float(value) for value in element.attrib["transform"].split()]
        matrix[:3] = np.array(values).reshape(4, 3).T
    return element.attrib["objectid"], matrix


def _instances(
    reference: str, world: Doubles, objects: dict[str, _Object], depth: int, name: str
) -> Iterator[tuple[_Object, Doubles]]:
    """Every mesh below an object with where it stands; what is empty is counted too."""
    if depth > _MAX_DEPTH:
        raise InvalidScene("has objects that contain themselves, or too deep a nesting", name)
    if reference not in objects:
        raise InvalidScene(f"refers to object {reference[:40]!r}, which is not there", name)
    placed = objects[reference]
    yield placed, world
    for component, transform in placed.components:
        yield from _instances(component, world @ transform, objects, depth + 1, name)


def _part(placed: _Object, world: Doubles) -> MeshPart:
    triangles = placed.triangles
    if np.linalg.det(world[:3, :3]) < 0:
        triangles = triangles[:, ::-1]  # a mirror turns triangles inside out
    return MeshPart(placed.positions @ world[:3, :3].T + world[:3, 3], triangles, 0)
