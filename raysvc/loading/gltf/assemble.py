"""A glTF document put together into a scene."""

from dataclasses import dataclass

import numpy as np
import pygltflib

from raysvc.errors import LimitExceeded
from raysvc.limits import DEFAULT_LIMITS, Limits
from raysvc.loading.files import Files
from raysvc.loading.gltf.accessors import Accessors
from raysvc.loading.gltf.attributes import Shape, with_tangents
from raysvc.loading.gltf.buffers import Buffers
from raysvc.loading.gltf.document import Document, item, read_document
from raysvc.loading.gltf.extensions import note_unsupported
from raysvc.loading.gltf.instances import Placement, read_placements
from raysvc.loading.gltf.materials import read_materials
from raysvc.loading.gltf.nodes import read_hierarchy
from raysvc.loading.gltf.placing import Arrays, determinants, place
from raysvc.loading.gltf.primitives import Primitives
from raysvc.loading.gltf.textures import Textures
from raysvc.loading.gltf.views import read_cameras, read_lights
from raysvc.scene import Material, Scene, TextureRef

_SINGULAR = 1e-12


def load_gltf(files: Files, limits: Limits = DEFAULT_LIMITS) -> Scene:
    """Load a .gltf or .glb with what it refers to.

    Parameters
    ----------
    files
        the main file and its side files
    limits
        on everything that is counted

    Returns
    -------
    Scene
        in world space; `warnings` lists what is not shown and what was repaired

    Raises
    ------
    InvalidScene
        broken or contradictory; `field` is a path into the document
    Unsupported
        a required extension, or a version other than 2
    LimitExceeded
        larger than `limits`
    """
    try:
        return _assembled(read_document(files, limits))
    except MemoryError:
        raise LimitExceeded("does not fit into memory", files.main) from None


def _assembled(document: Document) -> Scene:
    buffers = Buffers(document)
    accessors, textures = Accessors(document, buffers), Textures(document, buffers)
    hierarchy = read_hierarchy(document)
    placements = read_placements(document, hierarchy, accessors)
    _note_flattened(document, placements)
    materials = read_materials(document, textures)
    primitives = Primitives(document, accessors)
    parts, materials = _parts(document, placements, primitives, materials)
    arrays = _filled(parts, primitives, materials)
    _note_animations(document)
    if not len(arrays.triangles):
        document.journal.note("there are no triangles to show", "document")
    return Scene(
        **{name: getattr(arrays, name) for name in Arrays.__slots__},
        materials=materials,
        textures=textures.all(),
        lights=read_lights(document, hierarchy),
        cameras=read_cameras(document, hierarchy),
        name=document.files.main,
        warnings=document.journal.warnings(),
    )


@dataclass(frozen=True, slots=True)
class _Part:
    """A primitive with triangles and the instances of its mesh."""

    primitive: pygltflib.Primitive
    path: str
    placement: Placement
    material: int
    first_object: int
    objects_per_instance: int


def _parts(
    document: Document,
    placements: list[Placement],
    primitives: Primitives,
    materials: tuple[Material, ...],
) -> tuple[list[_Part], tuple[Material, ...]]:
    """What there is to read, within the limits, and the materials with the default if needed."""
    parts: list[_Part] = []
    vertices = triangles = objects = 0
    limits, default = document.limits, len(materials)
    for placement in placements:
        mesh = document.gltf.meshes[placement.mesh]
        mesh_path, count = f"meshes[{placement.mesh}]", len(placement.nodes)
        note_unsupported(mesh, mesh_path, document.journal)
        for number, primitive in enumerate(mesh.primitives):
            path = f"{mesh_path}.primitives[{number}]"
            more_vertices, more_triangles = primitives.size(primitive, path)
            primitives.note_missing(primitive, path)
            vertices += count * more_vertices
            triangles += count * more_triangles
            if triangles > limits.max_triangles:
                raise LimitExceeded(f"more than {limits.max_triangles:,} triangles", path)
            if vertices > limits.max_vertices:
                raise LimitExceeded(f"more than {limits.max_vertices:,} vertices", path)
            material = default
            if primitive.material is not None:
                item(materials, primitive.material, "materials", f"{path}.material")
                material = primitive.material
            if more_triangles:
                first = objects + number
                parts.append(
                    _Part(primitive, path, placement, material, first, len(mesh.primitives))
                )
        objects += count * len(mesh.primitives)
        if objects > np.iinfo(np.int32).max:
            raise LimitExceeded("too many objects", mesh_path)
    if any(part.material == default for part in parts):
        materials = (*materials, Material(name="default"))
    return parts, materials


def _filled(parts: list[_Part], primitives: Primitives, materials: tuple[Material, ...]) -> Arrays:
    """Decode every primitive and write all of its instances."""
    shapes: list[Shape] = []
    for part in parts:
        shape = primitives.read(part.primitive, part.path)
        material = materials[part.material]
        reads_tangents = (
            material.normal_texture
            or material.clearcoat_normal_texture
            or material.anisotropy_texture
            or (TextureRef(0) if material.anisotropy > 0.0 else None)
        )
        if reads_tangents is not None:
            shape = with_tangents(shape, reads_tangents)
        if material.anisotropy > 0.0:
            primitives.note_missing_tangents(shape, part.path)
        shapes.append(shape)
        primitives.note_missing_uv(part.primitive, part.path, material)
    counts = [len(part.placement.nodes) for part in parts]
    arrays = Arrays.empty(
        sum(n * len(shape.positions) for n, shape in zip(counts, shapes, strict=True)),
        sum(n * len(shape.triangles) for n, shape in zip(counts, shapes, strict=True)),
    )
    vertex = triangle = 0
    for part, shape, count in zip(parts, shapes, counts, strict=True):
        place(shape, part.placement, arrays, vertex, triangle)
        end = triangle + count * len(shape.triangles)
        numbers = part.first_object + part.objects_per_instance * np.arange(count)
        arrays.material_of_triangle[triangle:end] = part.material
        arrays.object_of_triangle[triangle:end] = np.repeat(numbers, len(shape.triangles))
        vertex += count * len(shape.positions)
        triangle = end
    return arrays


def _note_flattened(document: Document, placements: list[Placement]) -> None:
    for placement in placements:
        flattened = np.abs(determinants(placement.world)) < _SINGULAR
        for node in np.unique(placement.nodes[flattened]).tolist():
            document.journal.note("its transform has no volume and flattens", f"nodes[{node}]")


def _note_animations(document: Document) -> None:
    if document.gltf.animations:
        document.journal.note("animations are not supported: shown as at rest", "animations")
