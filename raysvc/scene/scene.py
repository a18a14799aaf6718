"""The scene: one set of world-space triangles with everything needed to shade them."""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike

from raysvc.errors import InvalidScene
from raysvc.scene.camera import SceneCamera
from raysvc.scene.light import PunctualLight
from raysvc.scene.material import Material
from raysvc.scene.rest_shape import RestShape, given_normals, moved_positions
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
    rest
        the shape that this scene, and those that are deformed from it, were first made in
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
    rest: RestShape = field(init=False, repr=False)
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
        rest = RestShape(self.positions, self.normals, self.tangents, self.triangles)
        object.__setattr__(self, "rest", rest)
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

    @property
    def is_deformed(self) -> bool:
        """Is this a shape that `deformed` returned?"""
        return self.rest.positions is not self.positions

    def deformed(self, positions: ArrayLike, normals: ArrayLike | None = None) -> "Scene":
        """Return the scene with its vertices elsewhere; all else, and this scene, stay as they are.

        It does not matter whether it is asked of the scene as it was made or of a deformed one:
        normals and tangents are always carried from the shape at rest (see `RestShape`), so that
        nothing adds up over the frames of an animation. Its structures are refitted from those of
        another shape where there are any.

        Parameters
        ----------
        positions
            (V, 3) numbers, in the order of `positions`, in metres
        normals
            (V, 3) directions of any length, if they are known; for this shape only

        Raises
        ------
        InvalidScene
            another shape than (V, 3); NaN or infinite; a coordinate beyond 1e18 m; a normal of
            length 0
        """
        moved = moved_positions(positions, len(self.positions))
        known = None if normals is None else given_normals(normals, len(self.positions))
        carried, tangents = self.rest.carried(moved, known)
        scene = replace(self, positions=moved, normals=carried, tangents=tangents)
        object.__setattr__(scene, "rest", self.rest)
        return scene


def _bounds_of(positions: Floats, triangles: Ints) -> Doubles:
    if not len(triangles):
        return np.array([[-0.5] * 3, [0.5] * 3])
    used = np.zeros(len(positions), np.bool_)
    used[triangles] = True
    by_axis = np.ascontiguousarray(positions[used].T)  # NumPy's minimum over rows takes far longer
    return np.stack([by_axis.min(axis=1), by_axis.max(axis=1)]).astype(np.float64)


def _check_indices(indices: Ints, count: int, name: str) -> None:
    if indices.size and (indices.min() < 0 or indices.max() >= count):
        raise InvalidScene(f"has an index outside 0..{count - 1}", field=name)
