"""The shape in which a scene was made, and how its normals go along when vertices move."""

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from raysvc.errors import InvalidScene
from raysvc.geometry.places import welded
from raysvc.scene.carrying_kernels import carry, settle_normals, settle_tangents, smooth_groups
from raysvc.types import Floats, Ints, Longs

LARGEST_COORDINATE = 1e18
"""In metres. Squares of coordinates and their products must fit into float32's range, with some
room."""
SAME_PLACE = 4 * 1.1920929e-07
"""Vertices that were at one place still are if they are no farther apart than this part of the
largest coordinate: four steps of float32."""


class RestShape:
    """What all deformed shapes of a scene have in common: they are carried from here, each alone.

    So a shape does not depend on the shapes before it, and none of them has to be kept.
    """

    def __init__(
        self, positions: Floats, normals: Floats, tangents: Floats, triangles: Ints
    ) -> None:
        """Take the arrays of a checked `Scene`."""
        self.positions = positions
        self._normals, self._tangents, self._triangles = normals, tangents, triangles

    def carried(self, positions: Floats, normals: Floats | None = None) -> tuple[Floats, Floats]:
        """Normals and tangents at moved positions.

        Where none of a vertex's triangles has changed, nothing does, to the bit. Vertices that were
        at one place with one normal, as at the seam of a texture, keep one; hard edges stay hard. A
        vertex of which all triangles are without area, before or after, keeps its normal.

        Parameters
        ----------
        positions
            (V, 3) float32, finite
        normals
            (V, 3) float32 unit, if they are known

        Returns
        -------
        (V, 3) float32 unit normals, those given if they were; (V, 4) float32 tangents, w = 0 where
        there is none
        """
        vertices = len(positions)
        group, tangent_group = np.empty(vertices, np.int64), np.empty(vertices, np.int64)
        reach = SAME_PLACE * float(np.abs(positions).max(initial=0.0))
        order, starts = self._places
        smooth_groups(
            order, starts, self._normals, self._tangents, positions, reach, group, tangent_group
        )
        moved = np.zeros(vertices, np.bool_)
        normal_sums, tangent_sums = np.zeros((vertices, 3)), np.zeros((vertices, 3))
        carry(
            self.positions,
            positions,
            self._normals,
            self._tangents,
            self._triangles,
            group,
            tangent_group,
            moved,
            normal_sums,
            tangent_sums,
        )
        if normals is None:
            normals = self._normals.copy()
            settle_normals(group, moved, normal_sums, normals)
        else:
            moved[group] = True
        tangents = self._tangents.copy()
        settle_tangents(group, tangent_group, moved, tangent_sums, normals, tangents)
        return normals, tangents

    @cached_property
    def _places(self) -> tuple[Longs, Longs]:
        """(V,) vertices place by place, and (P + 1,) where each place begins."""
        place = welded(self.positions)
        order = np.argsort(place, kind="stable")
        counts = np.bincount(place) if len(place) else np.zeros(0, np.int64)
        return order, np.concatenate([[0], np.cumsum(counts)])


def moved_positions(positions: ArrayLike, vertices: int) -> Floats:
    """(V, 3) float32, a copy. Raises InvalidScene for another shape, NaN, or what is too far."""
    moved = _floats(positions, vertices, "positions")
    if len(moved) and np.abs(moved).max() > LARGEST_COORDINATE:
        raise InvalidScene(f"has a coordinate beyond {LARGEST_COORDINATE:g}", field="positions")
    return moved


def given_normals(normals: ArrayLike, vertices: int) -> Floats:
    """(V, 3) float32 at unit length, a copy. Raises InvalidScene for what has no direction."""
    given = _floats(normals, vertices, "normals").astype(np.float64)
    lengths = np.sqrt(np.einsum("vk,vk->v", given, given))[:, None]
    if (lengths <= 0.0).any():
        at = int(np.flatnonzero(lengths[:, 0] <= 0.0)[0])
        raise InvalidScene(f"has no direction at vertex {at}", field="normals")
    return np.ascontiguousarray(given / lengths, np.float32)


def _floats(values: ArrayLike, vertices: int, field: str) -> Floats:
    try:
        array = np.asarray(values)
    except ValueError:
        raise InvalidScene("is not an array of numbers", field=field) from None
    if array.dtype.kind not in "fiu":
        raise InvalidScene(f"needs real numbers, has {array.dtype}", field=field)
    if array.shape != (vertices, 3):
        raise InvalidScene(f"needs the shape {(vertices, 3)}, has {array.shape}", field=field)
    with np.errstate(over="ignore"):
        floats = np.array(array, np.float32, order="C")
    if not np.isfinite(floats).all():
        at = int(np.flatnonzero(~np.isfinite(floats).all(axis=1))[0])
        raise InvalidScene(f"has NaN or infinite values at vertex {at}", field=field)
    return floats
