"""Shapes put into the world: all instances of one primitive at a time."""

from dataclasses import dataclass

import numpy as np

from raysvc.errors import InvalidScene
from raysvc.loading.gltf.attributes import Shape
from raysvc.loading.gltf.directions import AT_ONCE, blocks, cross, unit
from raysvc.loading.gltf.instances import Placement
from raysvc.scene.rest_shape import LARGEST_COORDINATE
from raysvc.types import Bools, Doubles, Floats, Ints


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
    instances = len(placement.nodes)
    mirrored = determinants(placement.world) < 0
    rows = slice(first_vertex, first_vertex + instances * vertices)
    out = [
        array[rows].reshape(instances, vertices, -1)
        for array in (arrays.positions, arrays.normals, arrays.tangents, arrays.uv, arrays.colours)
    ]
    flat_uv, tangent = shape.uv.reshape(vertices, 4), bool(shape.tangents.any())
    for some in blocks(instances, AT_ONCE // max(1, vertices)):
        world, flipped = placement.world[some], mirrored[some]
        for part in blocks(vertices):
            positions = _positions(shape.positions[part], world)
            _check_reach(positions, placement, some.start)
            out[0][some, part] = positions
            out[1][some, part] = _normals(shape.normals[part], world, flipped)
            out[2][some, part] = _tangents(shape.tangents[part], world, flipped) if tangent else 0.0
        out[3][some] = flat_uv
        out[4][some] = shape.colours
    faces = slice(first_triangle, first_triangle + instances * triangles)
    turned = arrays.triangles[faces].reshape(instances, triangles, 3)
    starts = first_vertex + vertices * np.arange(instances)
    np.add(shape.triangles, starts[:, None, None], out=turned, casting="unsafe")
    turned[mirrored] = turned[mirrored][:, :, [0, 2, 1]]


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


def _positions(positions: Floats, world: Doubles) -> Doubles:
    local = positions.astype(np.float64)
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


def _normals(normals: Floats, world: Doubles, flipped: Bools) -> Doubles:
    """Normals go by the inverse transpose, which is the cofactors up to the determinant's sign."""
    x, y, z = np.moveaxis(_linear(world), 2, 0)
    cofactors = np.stack([cross(y, z), cross(z, x), cross(x, y)], axis=2)
    cofactors[flipped] *= -1
    turned = normals.astype(np.float64) @ np.swapaxes(cofactors, 1, 2)
    directions, good = unit(turned.reshape(-1, 3))
    directions[~good] = (0.0, 1.0, 0.0)
    return directions.reshape(turned.shape)


def _tangents(tangents: Floats, world: Doubles, flipped: Bools) -> Doubles:
    turned = tangents[:, :3].astype(np.float64) @ np.swapaxes(_linear(world), 1, 2)
    directions, good = unit(turned.reshape(-1, 3))
    sign = np.where(flipped, -1.0, 1.0)[:, None] * tangents[None, :, 3]
    sign = np.where(good.reshape(sign.shape), sign, 0.0)
    return np.concatenate([directions.reshape(turned.shape), sign[:, :, None]], axis=2)
