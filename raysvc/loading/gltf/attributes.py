"""A primitive's vertex attributes, checked and brought into the scene's form."""

from dataclasses import dataclass, replace

import numpy as np

from raysvc.errors import InvalidScene
from raysvc.loading.gltf.accessors import Accessors
from raysvc.loading.gltf.directions import (
    face_normals,
    smooth_normals,
    unit,
    without_area,
)
from raysvc.loading.gltf.journal import Journal
from raysvc.loading.gltf.tangents import tangents
from raysvc.scene import TextureRef
from raysvc.scene.rest_shape import LARGEST_COORDINATE
from raysvc.types import Floats, Longs

LARGEST_UV = 1e6
LARGEST_COLOUR = 1e6
KNOWN = frozenset({"POSITION", "NORMAL", "TANGENT", "TEXCOORD_0", "TEXCOORD_1", "COLOR_0"})
_UNIT_TOLERANCE = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """Triangles of one primitive in the space of its mesh; arrays as in `raysvc.scene.Scene`."""

    positions: Floats
    normals: Floats
    tangents: Floats
    uv: Floats
    colours: Floats
    triangles: Longs


class AttributeReader:
    """Reads the attributes of one primitive at the vertices that its triangles use."""

    def __init__(
        self, attributes: dict[str, int], path: str, accessors: Accessors, journal: Journal
    ) -> None:
        self._attributes, self._accessors, self._journal = attributes, accessors, journal
        self._path = f"{path}.attributes"
        self._vertices = accessors.count(attributes["POSITION"], self._place("POSITION"))

    def read(self, triangles: Longs) -> Shape:
        """Return the shape with vertices that are not used left out.

        `triangles` is (F, 3) int64 with every index below the number of vertices.
        """
        used, triangles = _compacted(triangles, self._vertices)
        positions = self._positions(used)
        count = len(positions)
        shape = Shape(
            positions,
            normals=np.zeros((count, 3), np.float32),
            tangents=np.zeros((count, 4), np.float32),
            uv=self._uv(used),
            colours=self._colours(used),
            triangles=triangles,
        )
        if without_area(positions, triangles):
            self._journal.note("has triangles without area", self._path.rpartition(".")[0])
        if "NORMAL" not in self._attributes:
            return _flat(shape)
        normals = self._normals(used, positions, triangles)
        return replace(shape, normals=normals, tangents=self._tangents(used))

    def _place(self, name: str) -> str:
        return f"{self._path}.{name}"

    def _values(self, name: str, widths: tuple[int, ...], used: Longs) -> Floats:
        place = self._place(name)
        index = self._attributes[name]
        count = self._accessors.count(index, place)
        if count != self._vertices:
            raise InvalidScene(f"has {count:,} elements, POSITION has {self._vertices:,}", place)
        return self._accessors.floats(index, place, widths)[used]

    def _finite(self, name: str, widths: tuple[int, ...], used: Longs) -> Floats:
        values = self._values(name, widths, used)
        if not np.isfinite(values).all():
            where = f"accessors[{self._attributes[name]}]"
            raise InvalidScene(f"has NaN or infinite values ({self._place(name)})", where)
        return values

    def _positions(self, used: Longs) -> Floats:
        positions = self._finite("POSITION", (3,), used)
        if positions.size and np.abs(positions).max() > LARGEST_COORDINATE:
            raise InvalidScene(
                f"has a coordinate beyond {LARGEST_COORDINATE:g}",
                f"accessors[{self._attributes['POSITION']}]",
            )
        return positions

    def _uv(self, used: Longs) -> Floats:
        uv = np.zeros((len(used), 2, 2), np.float32)
        for number in (0, 1):
            if f"TEXCOORD_{number}" in self._attributes:
                name = f"TEXCOORD_{number}"
                values = self._values(name, (2,), used)
                good = (np.abs(values) <= LARGEST_UV).all(axis=1, keepdims=True)
                if not good.all():
                    self._journal.note(
                        f"NaN, or beyond {LARGEST_UV:g}: set to 0", self._place(name)
                    )
                uv[:, number] = np.where(good, values, 0)
        return uv

    def _colours(self, used: Longs) -> Floats:
        colours = np.ones((len(used), 4), np.float32)
        if "COLOR_0" in self._attributes:
            values = self._finite("COLOR_0", (3, 4), used)
            index = self._attributes["COLOR_0"]
            if self._accessors.is_unnormalised_integer(index):
                values = values / np.float32(self._accessors.largest(index))
                self._journal.note("is read as normalised integers", self._place("COLOR_0"))
            if values.size and not 0 <= values.min() <= values.max() <= LARGEST_COLOUR:
                values = np.clip(values, 0, LARGEST_COLOUR)
                self._journal.note(
                    f"is brought within 0..{LARGEST_COLOUR:g}", self._place("COLOR_0")
                )
            colours[:, : values.shape[1]] = values
        return colours

    def _normals(self, used: Longs, positions: Floats, triangles: Longs) -> Floats:
        given = self._values("NORMAL", (3,), used).astype(np.float64)
        normals, good = unit(given)
        if not good.all():
            self._journal.note(
                "zero, NaN or infinite normals are made from the triangles", self._place("NORMAL")
            )
            normals[~good] = smooth_normals(positions, triangles)[~good]
        with np.errstate(over="ignore", invalid="ignore"):
            length = np.sqrt((given[good] ** 2).sum(axis=1))
        if (np.abs(length - 1) > _UNIT_TOLERANCE).any():
            self._journal.note("normals are not unit and are made so", self._place("NORMAL"))
        return normals.astype(np.float32)

    def _tangents(self, used: Longs) -> Floats:
        if "TANGENT" not in self._attributes:
            return np.zeros((len(used), 4), np.float32)
        given = self._values("TANGENT", (4,), used).astype(np.float64)
        direction, good = unit(given[:, :3])
        good &= np.abs(given[:, 3]) > 0.5
        if not good.all():
            self._journal.note(
                "zero, NaN or infinite tangents are left to the texture coordinates",
                self._place("TANGENT"),
            )
        sign = np.where(good, np.where(given[:, 3] > 0, 1.0, -1.0), 0.0)
        whole = np.concatenate([direction * good[:, None], sign[:, None]], axis=1)
        return whole.astype(np.float32)


def with_tangents(shape: Shape, normal_map: TextureRef) -> Shape:
    """Return the shape with tangents made for a normal map, where it has none at all."""
    if shape.tangents.any():
        return shape
    a, b, c, d, e, f = normal_map.uv_transform
    u, v = shape.uv[:, normal_map.uv_set, 0], shape.uv[:, normal_map.uv_set, 1]
    placed = np.stack([a * u + b * v + c, d * u + e * v + f], axis=1).astype(np.float32)
    made = tangents(shape.positions, shape.normals, placed, shape.triangles)
    return replace(shape, tangents=made)


def _compacted(triangles: Longs, vertices: int) -> tuple[Longs, Longs]:
    """Numbers of the vertices that are used, ascending, and triangles that index into those."""
    if vertices > 4 * triangles.size:
        used, renamed = np.unique(triangles, return_inverse=True)
        return used, renamed.reshape(triangles.shape)
    marked = np.zeros(vertices, bool)
    marked[triangles] = True
    used = np.flatnonzero(marked)
    return used, (np.cumsum(marked) - 1)[triangles]


def _flat(shape: Shape) -> Shape:
    """Give every triangle its own three vertices with its own normal; there are no tangents."""
    corners = shape.triangles.reshape(-1)
    normals = face_normals(shape.positions, shape.triangles)
    return Shape(
        shape.positions[corners],
        np.repeat(normals, 3, axis=0),
        np.zeros((len(corners), 4), np.float32),
        shape.uv[corners],
        shape.colours[corners],
        np.arange(len(corners)).reshape(-1, 3),
    )
