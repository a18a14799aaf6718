"""Tiny scenes built in code."""

import numpy as np

from raysvc.accel.base import Rays
from raysvc.geometry.transform import look_at
from raysvc.scene import Camera, Material, Scene, Texture, TextureRef

WHITE = Material(metallic=0.0)
QUAD_UV = ((0, 1), (1, 1), (1, 0), (0, 0))
"""Texture coordinates of a quad's corners from the lower left, anticlockwise: v grows downwards."""


def mesh(
    positions,
    triangles,
    *,
    uv=None,
    uv1=None,
    normals=None,
    tangents=None,
    colours=None,
    materials=(WHITE,),
    material_of_triangle=None,
    object_of_triangle=None,
    textures=(),
    lights=(),
):
    """A scene from whatever is given of it; normals are those of the last triangle at a vertex."""
    positions = np.ascontiguousarray(positions, np.float32).reshape(-1, 3)
    triangles = np.ascontiguousarray(triangles, np.int32).reshape(-1, 3)
    vertices, count = len(positions), len(triangles)
    if normals is None:
        p = positions[triangles].astype(float)
        across = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
        length = np.linalg.norm(across, axis=1, keepdims=True)
        normals = np.tile([0.0, 0.0, 1.0], (vertices, 1))
        normals[triangles] = (across / np.where(length > 0, length, 1))[:, None]
    both = np.zeros((vertices, 2, 2))
    both[:, 0] = 0 if uv is None else uv
    both[:, 1] = both[:, 0] if uv1 is None else uv1

    def array(values, shape, dtype):
        return np.array(np.broadcast_to(np.asarray(values, dtype), shape), order="C")

    return Scene(
        positions=positions,
        normals=array(normals, (vertices, 3), np.float32),
        tangents=array(0 if tangents is None else tangents, (vertices, 4), np.float32),
        uv=both.astype(np.float32),
        colours=array(1 if colours is None else colours, (vertices, 4), np.float32),
        triangles=triangles,
        material_of_triangle=array(
            0 if material_of_triangle is None else material_of_triangle, (count,), np.int32
        ),
        object_of_triangle=array(
            0 if object_of_triangle is None else object_of_triangle, (count,), np.int32
        ),
        materials=tuple(materials),
        textures=tuple(textures),
        lights=tuple(lights),
    )


def quad(material=WHITE, *, z=0.0, half=1.0, **more):
    """A square about the z axis that faces +Z, its texture upright."""
    corners = [(-half, -half, z), (half, -half, z), (half, half, z), (-half, half, z)]
    return mesh(
        corners, [[0, 1, 2], [0, 2, 3]], **{"uv": QUAD_UV, "materials": (material,), **more}
    )


def joined(*scenes):
    """Scenes side by side, each keeping its materials and textures."""
    parts: dict[str, list] = {}
    materials, textures, vertices = [], [], 0
    for number, scene in enumerate(scenes):
        for name in ("positions", "normals", "tangents", "uv", "colours"):
            parts.setdefault(name, []).append(getattr(scene, name))
        parts.setdefault("triangles", []).append(scene.triangles + np.int32(vertices))
        parts.setdefault("material_of_triangle", []).append(
            scene.material_of_triangle + np.int32(len(materials))
        )
        parts.setdefault("object_of_triangle", []).append(
            np.full(len(scene.triangles), number, np.int32)
        )
        if scene.textures:
            assert not textures, "only one of the scenes may have textures"
            textures = list(scene.textures)
        materials += scene.materials
        vertices += len(scene.positions)
    return Scene(
        **{name: np.concatenate(values) for name, values in parts.items()},
        materials=tuple(materials),
        textures=tuple(textures),
    )


def soup(rng, count, *, size=0.3, middle=(0.0, 0.0, 0.0), scale=1.0):
    """Positions (3 count, 3) float32 and indices (count, 3) of random triangles in a cube."""
    centres = rng.uniform(-1, 1, (count, 1, 3))
    corners = centres + rng.uniform(-size, size, (count, 3, 3))
    positions = (corners * scale + np.asarray(middle)).astype(np.float32).reshape(-1, 3)
    return positions, np.arange(3 * count, dtype=np.int32).reshape(-1, 3)


def chequered(*codes):
    """A texture from rows of grey levels (or RGBA tuples)."""
    rows = np.array(codes, np.uint8)
    if rows.ndim == 2:
        rows = np.concatenate(
            [np.repeat(rows[..., None], 3, axis=2), np.full((*rows.shape, 1), 255, np.uint8)],
            axis=2,
        )
    return rows


def masked_quad(alpha_codes, *, z=0.0, half=1.0, **material):
    """A quad with holes: rows of alpha codes from the top, read without interpolation."""
    texels = np.full((*np.shape(alpha_codes), 4), 255, np.uint8)
    texels[..., 3] = alpha_codes
    settings = {"alpha_mode": "mask", "double_sided": True, **material}
    return quad(
        Material(base_colour_texture=TextureRef(0), metallic=0.0, **settings),
        z=z,
        half=half,
        textures=(Texture(texels, "clamp", "clamp", nearest=True),),
    )


def stairs(steps):
    """Unit-wide treads at z = 0, 1, 2 ... that face +Z, going to the right from x = 0."""
    positions, triangles = [], []
    for k in range(steps):
        triangles += [[4 * k, 4 * k + 1, 4 * k + 2], [4 * k, 4 * k + 2, 4 * k + 3]]
        positions += [(k, 0, k), (k + 1, 0, k), (k + 1, 1, k), (k, 1, k)]
    return mesh(positions, triangles)


def camera(eye=(0, 0, 5), target=(0, 0, 0), up=(0, 1, 0), width=16, height=12, **more):
    """A camera, by default a perspective one that looks along -Z."""
    pose = look_at(np.array(eye, float), np.array(target, float), np.array(up, float))
    return Camera(pose, width, height, **{"half_height": 0.4, **more})


def rays(origins, directions, t_max=np.inf):
    """Rays from anything that broadcasts."""
    origins, directions = np.broadcast_arrays(
        np.atleast_2d(np.asarray(origins, np.float32)),
        np.atleast_2d(np.asarray(directions, np.float32)),
    )
    reach = np.broadcast_to(np.asarray(t_max, np.float32), len(origins))
    return Rays(*(np.array(array, order="C") for array in (origins, directions, reach)))
