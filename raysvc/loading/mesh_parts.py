"""From arrays that a mesh file holds to a checked scene."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from raysvc.errors import InvalidScene
from raysvc.geometry.places import welded
from raysvc.loading.welding import crease_normals
from raysvc.scene import Material, Scene, Texture
from raysvc.types import Doubles, Ints, Longs

MAX_COORDINATE = 1e9
"""In metres. Beyond it, products of four lengths leave the range of float32."""


@dataclass(slots=True, eq=False)
class MeshPart:
    """Triangles of one material as a file has them, unchecked.

    Attributes
    ----------
    positions
        (V, 3) float64
    triangles
        (F, 3) integers
    normals
        (V, 3) float64 of any length, or None
    uv
        (V, 2) float64, v downwards, or None
    colours
        (V, 4) float64 linear RGBA, or None
    """

    positions: Doubles
    triangles: Ints | Longs
    material: int
    normals: Doubles | None = None
    uv: Doubles | None = None
    colours: Doubles | None = None

    def picked(self, vertices: Ints | Longs, triangles: Ints | Longs) -> "MeshPart":
        """Return the part with vertices chosen by (N,) numbers, and new triangles."""
        normals, uv, colours = (
            None if array is None else array[vertices]
            for array in (self.normals, self.uv, self.colours)
        )
        return MeshPart(self.positions[vertices], triangles, self.material, normals, uv, colours)

    def unshared(self) -> "MeshPart":
        """Return the part with vertices for every corner of every triangle."""
        corners = self.triangles.reshape(-1)
        return self.picked(corners, np.arange(len(corners)).reshape(-1, 3))


def linear_colours(colours: np.ndarray) -> Doubles:
    """(N, 4) float64 linear RGBA of (N, 3 or 4) sRGB colours: integers of any size, or 0..1."""
    values = np.asarray(colours, np.float64)
    if np.issubdtype(colours.dtype, np.integer):
        values = values / np.iinfo(colours.dtype).max
    elif len(values) and np.nanmax(values) > 1.0:
        values = values / 255.0
    values = np.nan_to_num(np.clip(values, 0.0, 1.0), nan=1.0)
    rgb = values[:, :3]
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    alpha = values[:, 3] if values.shape[1] > 3 else np.ones(len(values))
    return np.column_stack([linear, alpha])


def scene_from_parts(
    parts: Sequence[MeshPart],
    materials: Sequence[Material],
    textures: tuple[Texture, ...],
    warnings: Sequence[str],
    name: str,
    field: str,
) -> Scene:
    """Check parts, give them normals, and join them, each an object of its own.

    Parameters
    ----------
    field
        what errors name

    Raises
    ------
    InvalidScene
        an index that is not there; a position that is NaN, infinite or beyond MAX_COORDINATE
    """
    said = list(dict.fromkeys(warnings))
    ready = [_with_normals(_checked(part, said, field), said) for part in parts]
    ready = [part for part in ready if len(part.triangles)]
    materials, parts_materials = _with_blending(ready, materials)
    counts = [len(part.positions) for part in ready]
    starts = np.cumsum([0, *counts])
    triangle_counts = [len(part.triangles) for part in ready]
    uv = _joined([part.uv for part in ready], counts, (0.0, 0.0))
    return Scene(
        positions=_joined([part.positions for part in ready], counts, (0.0,) * 3),
        normals=_joined([part.normals for part in ready], counts, (0.0, 1.0, 0.0)),
        tangents=np.zeros((starts[-1], 4), np.float32),
        uv=np.ascontiguousarray(np.stack([uv, uv], axis=1)),
        colours=_joined([part.colours for part in ready], counts, (1.0,) * 4),
        triangles=np.concatenate(
            [np.zeros((0, 3)), *(part.triangles + starts[i] for i, part in enumerate(ready))]
        ).astype(np.int32),
        material_of_triangle=np.repeat(parts_materials, triangle_counts).astype(np.int32),
        object_of_triangle=np.repeat(np.arange(len(ready)), triangle_counts).astype(np.int32),
        materials=tuple(materials),
        textures=textures,
        name=name,
        warnings=tuple(dict.fromkeys(said)),
    )


def _checked(part: MeshPart, warnings: list[str], field: str) -> MeshPart:
    """Check indices and numbers, and keep only the vertices that triangles use."""
    count = len(part.positions)
    if len(part.triangles) and not (part.triangles.min() >= 0 and part.triangles.max() < count):
        bad = part.triangles[(part.triangles < 0) | (part.triangles >= count)][0]
        raise InvalidScene(f"a face uses vertex {bad}, but there are {count}", field)
    used, inverse = np.unique(part.triangles, return_inverse=True)
    part = part.picked(used.astype(np.int64), inverse.reshape(-1, 3))
    if not np.isfinite(part.positions).all():
        raise InvalidScene("has positions that are NaN or infinite", field)
    if len(used) and np.abs(part.positions).max() > MAX_COORDINATE:
        raise InvalidScene(f"has positions farther than {MAX_COORDINATE:g} from the origin", field)
    if part.uv is not None:
        with np.errstate(over="ignore"):
            faulty = ~np.isfinite(part.uv.astype(np.float32))
        if faulty.any():
            part.uv = np.where(faulty, 0.0, part.uv)
            warnings.append("texture coordinates that are not finite are now 0")
    return part


def _with_normals(part: MeshPart, warnings: list[str]) -> MeshPart:
    """Take the part's own normals at unit length, or make some."""
    if part.normals is not None:
        with np.errstate(over="ignore", invalid="ignore"):
            lengths = np.linalg.norm(part.normals, axis=1, keepdims=True)
            if np.all((lengths > 1e-12) & np.isfinite(lengths)):
                part.normals = part.normals / lengths
                return part
        warnings.append("has normals that are zero or not finite; all are made anew")
    if part.uv is None and part.colours is None:
        # Nothing else tells vertices at one place apart, so a soup need not stay one.
        _, first, inverse = (
            np.unique(welded(part.positions), return_index=True, return_inverse=True)
            if len(part.positions)
            else (None, np.zeros(0, np.int64), np.zeros(0, np.int64))
        )
        part = part.picked(first, inverse[part.triangles])
    source, triangles, normals = crease_normals(part.positions, part.triangles)
    part = part.picked(source, triangles)
    part.normals = normals
    return part


def _with_blending(
    parts: Sequence[MeshPart], materials: Sequence[Material]
) -> tuple[list[Material], list[int]]:
    """Materials, with ones that blend for translucent vertex colours; and which each part has."""
    chosen, numbers = list(materials), []
    for part in parts:
        number = part.material
        translucent = part.colours is not None and bool((part.colours[:, 3] < 1.0).any())
        if translucent and chosen[number].alpha_mode != "blend":
            chosen.append(replace(chosen[number], alpha_mode="blend"))
            number = len(chosen) - 1
        numbers.append(number)
    return chosen, numbers


def _joined(
    arrays: Sequence[Doubles | None], counts: Sequence[int], default: tuple[float, ...]
) -> np.ndarray:
    """(V, len(default)) float32 of all parts, with the default where a part has none."""
    rows = [
        np.tile(np.array(default, np.float32), (count, 1)) if array is None else array
        for array, count in zip(arrays, counts, strict=True)
    ]
    return np.ascontiguousarray(
        np.concatenate([np.zeros((0, len(default))), *rows]), dtype=np.float32
    )
