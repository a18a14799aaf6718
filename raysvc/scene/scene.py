"""The scene: one set of world-space triangles with everything needed to shade them."""

from dataclasses import dataclass, field

import numpy as np

from raysvc.errors import InvalidScene
from raysvc.scene.camera import SceneCamera
from raysvc.scene.light import PunctualLight
from raysvc.scene.material import Material
from raysvc.scene.texture import Texture
from raysvc.types import Doubles, Floats, Ints

LARGEST = float(np.finfo(np.float32).max)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Scene:
    """Triangles in world space (+Y up, metres), instances expanded; counter-clockwise is the front.

    Construction checks shapes, dtypes, finiteness and every index, and makes the arrays read-only:
    kernels rely on it. Raises InvalidScene.

    Attributes
    ----------
    positions
        (V, 3) float32
    normals
        (V, 3) float32 unit shading normals
    tangents
        (V, 4) float32, unit tangent and handedness (+1, -1) as in glTF; w = 0 where there is none,
        and the shader then takes the triangle's own from its texture coordinates
    uv
        (V, 2, 2) float32, [:, 0] is TEXCOORD_0 and [:, 1] TEXCOORD_1; v grows downwards in the
        texture
    colours
        (V, 4) float32 linear RGBA that multiply the base colour
    triangles
        (F, 3) int32 indices of vertices
    material_of_triangle, object_of_triangle
        (F,) int32: index into `materials`; number of the instance that the triangle came from
    """

    positions: Floats
    normals: Floats
    tangents: Floats
    uv: Floats
    colours: Floats
    triangles: Ints
    material_of_triangle: Ints
    object_of_triangle: Ints
    materials: tuple[Material, ...]
    textures: tuple[Texture, ...] = ()
    lights: tuple[PunctualLight, ...] = ()
    cameras: tuple[SceneCamera, ...] = ()
    name: str = ""
    warnings: tuple[str, ...] = ()
    _bounds: Doubles = field(init=False, repr=False)

    def __post_init__(self) -> None:
        vertices, triangles = len(self.positions), len(self.triangles)
        expected = {
            "positions": ((vertices, 3), np.float32),
            "normals": ((vertices, 3), np.float32),
            "tangents": ((vertices, 4), np.float32),
            "uv": ((vertices, 2, 2), np.float32),
            "colours": ((vertices, 4), np.float32),
            "triangles": ((triangles, 3), np.int32),
            "material_of_triangle": ((triangles,), np.int32),
            "object_of_triangle": ((triangles,), np.int32),
        }
        for name, (shape, dtype) in expected.items():
            array = getattr(self, name)
            if array.shape != shape or array.dtype != dtype:
                raise InvalidScene(
                    f"needs {np.dtype(dtype)} of shape {shape}, has {array.dtype} of {array.shape}",
                    field=name,
                )
            if not array.flags.c_contiguous:
                raise InvalidScene("must be C-contiguous", field=name)
            if dtype is np.float32 and not np.isfinite(array).all():
                raise InvalidScene("has NaN or infinite values", field=name)
            array.setflags(write=False)
        _check_indices(self.triangles, vertices, "triangles")
        _check_indices(self.material_of_triangle, len(self.materials), "material_of_triangle")
        object.__setattr__(self, "_bounds", _bounds_of(self.positions, self.triangles))
        for number, material in enumerate(self.materials):
            if not all(abs(x) <= LARGEST for x in material.numbers()):
                raise InvalidScene("has numbers beyond float32", f"materials[{number}]")
            for ref in material.texture_refs():
                if ref is not None and not (
                    0 <= ref.texture < len(self.textures) and ref.uv_set in (0, 1)
                ):
                    raise InvalidScene(
                        "refers to a texture that is not there", f"materials[{number}]"
                    )

    def bounds(self) -> Doubles:
        """(2, 3) float64 least and greatest corner of the triangles; a unit box about 0 if none."""
        return self._bounds


def _bounds_of(positions: Floats, triangles: Ints) -> Doubles:
    if not len(triangles):
        return np.array([[-0.5] * 3, [0.5] * 3])
    used = np.zeros(len(positions), np.bool_)
    used[triangles] = True
    corners = positions[used]
    return np.stack([corners.min(axis=0), corners.max(axis=0)]).astype(np.float64)


def _check_indices(indices: Ints, count: int, name: str) -> None:
    if indices.size and (indices.min() < 0 or indices.max() >= count):
        raise InvalidScene(f"has an index outside 0..{count - 1}", field=name)
