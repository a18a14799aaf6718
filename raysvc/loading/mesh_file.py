"""OBJ, PLY, STL and OFF, parsed by trimesh, and 3MF, to a scene.

These formats (but for 3MF) know neither units nor an upward axis: numbers are taken as metres with
+Y up. None knows sides, so every material is double-sided. Normals of the file are used where it
has them; else they are smooth, with creases at edges sharper than 60 degrees (see `welding`).
Texture coordinates are turned over: v grows downwards here. Vertex colours are taken as sRGB.
"""

import dataclasses
import io
import os
import re
import warnings as python_warnings
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import trimesh.exchange.obj
import trimesh.exchange.off
import trimesh.exchange.ply
import trimesh.exchange.stl

from raysvc.errors import InvalidScene, LimitExceeded, RaysvcError
from raysvc.limits import Limits
from raysvc.loading.files import Files
from raysvc.loading.mesh_headers import check_off, check_stl, read_ply_header
from raysvc.loading.mesh_parts import MeshPart, linear_colours, scene_from_parts
from raysvc.loading.mtl import PLAIN, MaterialLibrary
from raysvc.loading.obj_text import read_obj_text
from raysvc.loading.threemf_file import read_3mf
from raysvc.scene import Material, Scene
from raysvc.types import Doubles


def load_mesh(files: Files, kind: str, limits: Limits) -> Scene:
    """Load `files.main`, which is in the format `kind`: obj, ply, stl, off or 3mf.

    Raises InvalidScene, Unsupported, LimitExceeded.
    """
    library = MaterialLibrary(files, limits)
    data = files.read(files.main, files.main)
    if not data.strip():
        raise InvalidScene("is empty", files.main)
    parts, materials = _READERS[kind](data, files, library, limits)
    triangles = sum(len(part.triangles) for part in parts)
    vertices = sum(len(part.positions) for part in parts)
    if triangles > limits.max_triangles or vertices > limits.max_vertices:
        raise LimitExceeded(f"{triangles:,} triangles of {vertices:,} vertices", files.main)
    return scene_from_parts(
        parts,
        materials,
        tuple(library.textures),
        library.warnings,
        name=os.path.splitext(os.path.basename(files.main))[0],
        field=files.main,
    )


Parsed = tuple[list[MeshPart], list[Material]]


def _read_obj(data: bytes, files: Files, library: MaterialLibrary, limits: Limits) -> Parsed:
    obj = read_obj_text(data, limits, files.main)
    for name in obj.libraries:
        library.read(name)
    for kind in obj.ignored:
        library.warnings.append(f"{kind} are not drawn")
    materials = [_named_material(name, library) for name in obj.materials]
    if obj.has_uv and not obj.libraries:
        library.warnings.append(
            "has texture coordinates but no mtllib: without a texture, since none is guessed"
        )
    # trimesh tells materials apart only if it has read them, so it gets a library of their names.
    names = "".join(f"newmtl m{number}\n" for number in range(len(materials))).encode()
    parsed = _parsed(
        lambda: trimesh.exchange.obj.load_obj(
            io.BytesIO(f"mtllib materials\n{obj.text}".encode()),
            resolver={"materials": names},
            split_objects=True,
        ),
        files.main,
    )
    if "geometry" not in parsed:
        library.warnings.append("holds points but no faces; there is nothing to draw")
        return [], []
    parts = []
    for mesh in reversed(parsed["geometry"].values()):
        name = str(getattr(getattr(mesh.get("visual"), "material", None), "name", None))
        # Faces before the first usemtl have none of our names.
        is_named = re.fullmatch(r"m\d+", name) is not None
        part = _part(mesh, int(name[1:]) if is_named else len(materials))
        if (obj.has_uv and part.uv is None) or (obj.has_normals and part.normals is None):
            library.warnings.append("some faces have no texture coordinates or normals")
        parts.append(part)
    needs_plain = any(part.material == len(materials) for part in parts)
    return parts, [*materials, PLAIN] if needs_plain else materials


def _read_ply(data: bytes, files: Files, library: MaterialLibrary, limits: Limits) -> Parsed:
    header = read_ply_header(data, limits, files.main)
    parsed = _parsed(
        lambda: trimesh.exchange.ply.load_ply(
            io.BytesIO(data), skip_materials=True, fix_texture=False
        ),
        files.main,
    )
    if not ("face" in header.elements and header.elements["face"].count):
        library.warnings.append("holds points but no faces; there is nothing to draw")
        return [], []
    _check_polygons(parsed, files.main)
    part = _part(parsed, 0)
    if len(part.triangles) < header.elements["face"].count:
        raise InvalidScene("has fewer faces of three corners than it says", files.main)
    face_uv = _wedge_uv(parsed, len(part.triangles))
    if face_uv is not None:
        part = part.unshared()
        part.uv = face_uv
    if parsed.get("vertex_colors") is None and parsed.get("face_colors") is not None:
        colours = linear_colours(parsed["face_colors"])
        if len(colours) == len(part.triangles):
            part = part.unshared()
            part.colours = np.repeat(colours, 3, axis=0)
        else:
            library.warnings.append("colours of faces with more than three corners are not used")
    material = PLAIN if part.colours is None else _like_plain((1.0, 1.0, 1.0, 1.0))
    if header.texture_file is not None:
        texture = library.texture(header.texture_file)
        if texture is not None and part.uv is not None:
            material = _like_plain((1.0, 1.0, 1.0, 1.0), base_colour_texture=texture)
    return [part], [material]


def _read_stl(data: bytes, files: Files, library: MaterialLibrary, limits: Limits) -> Parsed:
    check_stl(data, limits, files.main)
    parsed = _parsed(lambda: trimesh.exchange.stl.load_stl(io.BytesIO(data)), files.main)
    meshes = list(parsed["geometry"].values()) if "geometry" in parsed else [parsed]
    if not meshes:
        library.warnings.append("holds no triangles; there is nothing to draw")
    return [_part(mesh, 0) for mesh in meshes], [PLAIN]


def _read_off(data: bytes, files: Files, library: MaterialLibrary, limits: Limits) -> Parsed:
    faces = check_off(data, limits, files.main)
    parsed = _parsed(lambda: trimesh.exchange.off.load_off(io.BytesIO(data)), files.main)
    if len(parsed["faces"]) < faces:
        raise InvalidScene(f"says {faces} faces, but has fewer of three corners", files.main)
    if not faces:
        library.warnings.append("holds points but no faces; there is nothing to draw")
        return [], []
    if data.lstrip()[:4].upper() == b"COFF":
        library.warnings.append("colours of vertices (COFF) are not read")
    return [_part(parsed, 0)], [PLAIN]


def _read_3mf(data: bytes, files: Files, library: MaterialLibrary, limits: Limits) -> Parsed:
    warn = library.warnings.append
    return _parsed(lambda: read_3mf(data, limits, files.main, warn), files.main), [PLAIN]


_READERS: Mapping[str, Callable[[bytes, Files, MaterialLibrary, Limits], Parsed]] = {
    "obj": _read_obj,
    "ply": _read_ply,
    "stl": _read_stl,
    "off": _read_off,
    "3mf": _read_3mf,
}


def _parsed(parse: Callable[[], Any], name: str) -> Any:
    """Call trimesh; whatever it raises, and numbers that NumPy could not read, are InvalidScene."""
    try:
        with python_warnings.catch_warnings():
            # What is left after the last number that could be read gives this warning.
            python_warnings.simplefilter("error", DeprecationWarning)
            return parse()
    except RaysvcError:
        raise
    except MemoryError:
        raise LimitExceeded("does not fit into memory", name) from None
    except DeprecationWarning:
        raise InvalidScene("has text where a number should be", name) from None
    except IndexError:
        raise InvalidScene("refers to a vertex, or to a line, that is not there", name) from None
    except Exception as error:  # trimesh raises nearly every built-in exception for broken files
        reason = f"{type(error).__name__}: {error}"[:200]
        raise InvalidScene(f"cannot be read ({reason})", name) from None


def _named_material(name: str, library: MaterialLibrary) -> Material:
    if name in library.materials:
        return library.materials[name]
    library.warnings.append(f"material {name[:80]!r} is not in any mtllib; a plain one is used")
    return _like_plain(PLAIN.base_colour, name=name)


def _like_plain(colour: tuple[float, float, float, float], **changes: Any) -> Material:
    return dataclasses.replace(PLAIN, base_colour=colour, **changes)


def _part(mesh: Mapping[str, Any], material: int) -> MeshPart:
    """Arrays that trimesh parsed, checked and with its v turned over."""
    faces = mesh["faces"]
    # Lists and arrays of lists are polygons of different sizes.
    is_plain = isinstance(faces, np.ndarray) and faces.dtype.kind in "iu" and faces.ndim == 2
    if not is_plain or faces.shape[1] != 3:
        faces = trimesh.geometry.triangulate_quads(faces)
    uv = getattr(mesh.get("visual"), "uv", None)
    positions = np.asarray(mesh["vertices"], np.float64)
    part = MeshPart(positions, np.asarray(faces).reshape(-1, 3), material)
    normals, colours = mesh.get("vertex_normals"), mesh.get("vertex_colors")
    if normals is not None and np.shape(normals) == positions.shape:
        part.normals = np.asarray(normals, np.float64)
    if uv is not None and np.shape(uv) == (len(positions), 2):
        part.uv = np.asarray(uv, np.float64) * (1.0, -1.0) + (0.0, 1.0)
    if colours is not None and len(colours) == len(positions):
        part.colours = linear_colours(colours)
    return part


def _check_polygons(parsed: Mapping[str, Any], name: str) -> None:
    """Refuse binary PLY with faces of different sizes, which trimesh reads as if all were alike."""
    faces = parsed["metadata"]["_ply_raw"]["face"]["data"]
    for list_name in getattr(getattr(faces, "dtype", None), "names", None) or ():
        fields = faces[list_name].dtype.names
        if fields and len(np.unique(faces[list_name][fields[0]])) > 1:
            raise InvalidScene("mixes triangles and other polygons in binary PLY", name)


def _wedge_uv(parsed: Mapping[str, Any], triangles: int) -> Doubles | None:
    """(3F, 2) texture coordinates that PLY has for every corner of every face, v downwards."""
    faces = parsed["metadata"]["_ply_raw"]["face"]["data"]
    try:
        wedges = np.asarray(faces["texcoord"])
        wedges = wedges["f1"] if wedges.dtype.names else wedges
        values = np.asarray(wedges, np.float64)
    except (KeyError, ValueError, TypeError, IndexError):
        return None
    if values.shape != (triangles, 6):
        return None
    return values.reshape(-1, 2) * (1.0, -1.0) + (0.0, 1.0)
