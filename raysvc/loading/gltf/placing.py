"""Shapes put into the world: all instances of one primitive at a time."""

from dataclasses import dataclass

import numpy as np

from raysvc.errors import InvalidScene
from raysvc.loading.gltf.attributes import LARGEST_COORDINATE, Shape
from raysvc.loading.gltf.directions import cross, unit
from raysvc.loading.gltf.instances import Placement
from raysvc.types import Bools, Doubles, Floats, Ints

_VERTICES_AT_ONCE = 1 << 20


@dataclass(frozen=True, slots=True, eq=False)
class Arrays:
    """The scene's arrays while they are filled; shapes as in `raysvc.scene.Scene`."""

    positions: Floats
    normals: Floats
    tangents: Floats
    uv: Floats
    colours: Floats
    triangles: Ints
    material_of_triangle: Ints
    object_of_triangle: Ints

    @classmethod
    def empty(cls, vertices: int, triangles: int) -> "Arrays":
        """Make room for so many vertices and triangles."""
        return cls(
            np.empty((vertices, 3), np.float32),
            np.empty((vertices, 3), np.float32),
            np.empty((vertices, 4), np.float32),
            np.empty((vertices, 2, 2), np.float32),
            np.empty((vertices, 4), np.float32),
            np.empty((triangles, 3), np.int32),
            np.empty(triangles, np.int32),
            np.empty(triangles, np.int32),
        )


def place(
    shape: Shape,
    placement: Placement,
    arrays: Arrays,
    first_vertex: int,
    first_triangle: int,
) -> None:
    """Write all instances of `shape` behind one another, from the given vertex and triangle on.

    A mirroring transform turns the winding round, so that counter-clockwise stays the front, and
    the tangents' handedness. Raises InvalidScene for a position that is too far out.
    """
    vertices, triangles = len(shape.positions), len(shape.triangles)
    mirrored = determinants(placement.world) < 0
    at_once = max(1, _VERTICES_AT_ONCE // max(1, vertices))
    for begin in range(0, len(placement.nodes), at_once):
        end = min(begin + at_once, len(placement.nodes))
        world, flipped = placement.world[begin:end], mirrored[begin:end]
        rows = slice(first_vertex + begin * vertices, first_vertex + end * vertices)
        positions = _positions(shape, world)
        _check_reach(positions, placement, begin)
        arrays.positions[rows] = positions.reshape(-1, 3)
        arrays.normals[rows] = _normals(shape, world, flipped)
        arrays.tangents[rows] = _tangents(shape, world, flipped)
        count = end - begin
        arrays.uv[rows] = np.broadcast_to(shape.uv, (count, vertices, 2, 2)).reshape(-1, 2, 2)
        arrays.colours[rows] = np.broadcast_to(shape.colours, (count, vertices, 4)).reshape(-1, 4)
        starts = first_vertex + vertices * np.arange(begin, end)
        corners = shape.triangles[None] + starts[:, None, None]
        corners[flipped] = corners[flipped][:, :, [0, 2, 1]]
        faces = slice(first_triangle + begin * triangles, first_triangle + end * triangles)
        arrays.triangles[faces] = corners.reshape(-1, 3)


def determinants(world: Doubles) -> Doubles:
    """Return (N,) determinants of the 3x3 parts, divided by the cube of their largest entries."""
    x, y, z = np.moveaxis(_linear(world), 2, 0)
    determinant: Doubles = np.einsum("nk,nk->n", x, cross(y, z))
    return determinant


def _linear(world: Doubles) -> Doubles:
    """(N, 3, 3) the linear parts divided by their largest entries, so that nothing overflows."""
    linear = world[:, :3, :3]
    largest = np.abs(linear).max(axis=(1, 2), keepdims=True)
    scaled: Doubles = linear / np.where(largest > 0, largest, 1.0)
    return scaled


def _positions(shape: Shape, world: Doubles) -> Doubles:
    local = shape.positions.astype(np.float64)
    with np.errstate(over="ignore", invalid="ignore"):
        return local @ np.swapaxes(world[:, :3, :3], 1, 2) + world[:, None, :3, 3]


def _check_reach(positions: Doubles, placement: Placement, begin: int) -> None:
    with np.errstate(invalid="ignore"):
        near = (np.abs(positions) <= LARGEST_COORDINATE).all(axis=(1, 2))
    if not near.all():
        node = placement.nodes[begin + int(np.argmin(near))]
        raise InvalidScene(
            f"moves meshes[{placement.mesh}] beyond {LARGEST_COORDINATE:g}", f"nodes[{node}]"
        )


def _normals(shape: Shape, world: Doubles, flipped: Bools) -> Floats:
    """Normals go by the inverse transpose, which is the cofactors up to the determinant's sign."""
    x, y, z = np.moveaxis(_linear(world), 2, 0)
    cofactors = np.stack([cross(y, z), cross(z, x), cross(x, y)], axis=2)
    cofactors[flipped] *= -1
    turned = shape.normals.astype(np.float64) @ np.swapaxes(cofactors, 1, 2)
    normals, good = unit(turned.reshape(-1, 3))
    normals[~good] = (0.0, 1.0, 0.0)
    return normals.astype(np.float32)


def _tangents(shape: Shape, world: Doubles, flipped: Bools) -> Floats:
    made = np.zeros((len(world), len(shape.positions), 4), np.float32)
    if not shape.tangents.any():
        return made.reshape(-1, 4)
    local = shape.tangents[:, :3].astype(np.float64)
    turned = local @ np.swapaxes(_linear(world), 1, 2)
    directions, good = unit(turned.reshape(-1, 3))
    made[:, :, :3] = directions.reshape(turned.shape)
    sign = np.where(flipped, -1.0, 1.0)[:, None] * shape.tangents[None, :, 3]
    made[:, :, 3] = np.where(good.reshape(sign.shape), sign, 0.0)
    return made.reshape(-1, 4)
