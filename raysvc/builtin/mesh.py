"""Pieces of geometry, and how a scene is put together from them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from raysvc.geometry.transform import look_at, unit
from raysvc.scene import Material, PunctualLight, Scene, SceneCamera, Texture
from raysvc.types import Doubles, Floats, Ints

Point = tuple[float, float, float]


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """Indexed triangles with all that a Scene wants per vertex; counter-clockwise is the front.

    Attributes
    ----------
    positions, normals, tangents
        (V, 3), (V, 3) and (V, 4) float64, as in Scene
    uv
        (V, 2) float64, v grows downwards in the texture
    colours
        (V, 3) float64 linear RGB
    triangles
        (F, 3) int32
    """

    positions: Doubles
    normals: Doubles
    tangents: Doubles
    uv: Doubles
    colours: Doubles
    triangles: Ints

    def moved(self, offset: Sequence[float] | Doubles) -> "Mesh":
        """Return the mesh translated by (3,) metres."""
        return replace(self, positions=self.positions + np.asarray(offset, np.float64))

    def scaled(self, factor: float | Sequence[float]) -> "Mesh":
        """Return the mesh scaled about the origin by a positive factor, or one per axis."""
        factors = np.broadcast_to(np.asarray(factor, np.float64), 3)
        return replace(
            self,
            positions=self.positions * factors,
            normals=unit(self.normals / factors),
            tangents=np.column_stack([unit(self.tangents[:, :3] * factors), self.tangents[:, 3]]),
        )

    def turned(self, degrees: float, axis: int) -> "Mesh":
        """Return the mesh turned about axis 0, 1 or 2, counter-clockwise seen from its tip."""
        c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        rotation = np.eye(3)
        first, second = (axis + 1) % 3, (axis + 2) % 3
        rotation[[first, first, second, second], [first, second, first, second]] = c, -s, s, c
        return self._rotated(rotation)

    def upright_along(self, direction: Sequence[float] | Doubles) -> "Mesh":
        """Return the mesh with its +Y turned to (3,) `direction`."""
        up = np.asarray(direction, np.float64) / np.linalg.norm(direction)
        across = np.cross(up, [0.0, 0.0, 1.0] if abs(up[2]) < 0.9 else [1.0, 0.0, 0.0])
        across /= np.linalg.norm(across)
        return self._rotated(np.column_stack([across, up, np.cross(across, up)]))

    def coloured(self, colour: Sequence[float] | Doubles) -> "Mesh":
        """Return the mesh in linear RGB, (3,) for all or (V, 3) for each vertex."""
        wanted = np.broadcast_to(np.asarray(colour, np.float64), self.positions.shape)
        return replace(self, colours=wanted.copy())

    def textured(self, repeats_u: float, repeats_v: float) -> "Mesh":
        """Return the mesh with its texture repeated."""
        return replace(self, uv=self.uv * (repeats_u, repeats_v))

    def textured_at(self, u: float, v: float) -> "Mesh":
        """Return the mesh with the colour that its texture has at one place."""
        return replace(self, uv=np.tile((u, v), (len(self.uv), 1)))

    def _rotated(self, rotation: Doubles) -> "Mesh":
        return replace(
            self,
            positions=self.positions @ rotation.T,
            normals=self.normals @ rotation.T,
            tangents=np.column_stack([self.tangents[:, :3] @ rotation.T, self.tangents[:, 3]]),
        )


def merged(meshes: Sequence[Mesh]) -> Mesh:
    """Return one mesh that holds all of them, triangles in their order."""
    starts = np.cumsum([0, *(len(mesh.positions) for mesh in meshes)])
    return Mesh(
        positions=np.concatenate([mesh.positions for mesh in meshes]),
        normals=np.concatenate([mesh.normals for mesh in meshes]),
        tangents=np.concatenate([mesh.tangents for mesh in meshes]),
        uv=np.concatenate([mesh.uv for mesh in meshes]),
        colours=np.concatenate([mesh.colours for mesh in meshes]),
        triangles=np.concatenate(
            [mesh.triangles + start for mesh, start in zip(meshes, starts, strict=False)]
        ).astype(np.int32),
    )


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """A mesh with one material: one object of a scene."""

    mesh: Mesh
    material: int


def scene_of(
    name: str,
    parts: Sequence[Part],
    materials: Sequence[Material],
    *,
    textures: Sequence[Texture] = (),
    lights: Sequence[PunctualLight] = (),
    cameras: Sequence[SceneCamera] = (),
) -> Scene:
    """Return the scene made of parts, each an object of its own."""
    mesh = merged([part.mesh for part in parts])
    counts = [len(part.mesh.triangles) for part in parts]
    return Scene(
        positions=_floats(mesh.positions),
        normals=_floats(mesh.normals),
        tangents=_floats(mesh.tangents),
        uv=_floats(np.stack([mesh.uv, mesh.uv], axis=1)),
        colours=_floats(np.column_stack([mesh.colours, np.ones(len(mesh.colours))])),
        triangles=mesh.triangles,
        material_of_triangle=np.repeat([part.material for part in parts], counts).astype(np.int32),
        object_of_triangle=np.repeat(np.arange(len(parts)), counts).astype(np.int32),
        materials=tuple(materials),
        textures=tuple(textures),
        lights=tuple(lights),
        cameras=tuple(cameras),
        name=name,
    )


def camera_at(eye: Point, target: Point, fov_y_deg: float, aspect_ratio: float) -> SceneCamera:
    """Return the camera named "default" that every built-in scene has."""
    pose = look_at(np.array(eye), np.array(target), np.array([0.0, 1.0, 0.0]))
    return SceneCamera(pose, fov_y_deg=fov_y_deg, aspect_ratio=aspect_ratio, name="default")


def _floats(array: Doubles) -> Floats:
    return np.ascontiguousarray(array, np.float32)
