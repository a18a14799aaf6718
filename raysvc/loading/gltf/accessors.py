"""Accessors: typed arrays from bytes (specification, section 3.6.2).

Everything is checked before memory is asked for: types, count, stride, the last byte of the last
element, sparse indices.
"""

from collections.abc import Container
from dataclasses import dataclass
from typing import Any

import numpy as np
import pygltflib
from numpy.typing import NDArray

from raysvc.errors import InvalidScene, LimitExceeded
from raysvc.loading.gltf.buffers import Buffers
from raysvc.loading.gltf.document import Document, item
from raysvc.types import Floats, Longs

COMPONENTS: dict[int, np.dtype[Any]] = {
    5120: np.dtype("<i1"),
    5121: np.dtype("<u1"),
    5122: np.dtype("<i2"),
    5123: np.dtype("<u2"),
    5125: np.dtype("<u4"),
    5126: np.dtype("<f4"),
}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}

_INDEX_COMPONENTS = (5121, 5123, 5125)
_LONGEST_WITHOUT_BYTES = 1 << 20
"""Elements that an accessor may have without bytes behind them."""


@dataclass(frozen=True, slots=True)
class _Layout:
    """Where the elements of an array are within a buffer view."""

    view: int
    offset: int
    component: np.dtype[Any]
    width: int
    count: int
    path: str


class Accessors:
    """The accessors of a document, decoded when asked for."""

    def __init__(self, document: Document, buffers: Buffers) -> None:
        self._document, self._buffers = document, buffers
        limits = document.limits
        self._longest = max(limits.max_vertices, 3 * limits.max_triangles)

    def count(self, index: int, path: str) -> int:
        """Return how many elements accessors[index] has, checked against the limits."""
        accessor = item(self._document.gltf.accessors, index, "accessors", path)
        here = f"accessors[{index}].count"
        count: int = accessor.count
        if count < 0:
            raise InvalidScene("is negative", here)
        longest = self._longest if accessor.bufferView is not None else _LONGEST_WITHOUT_BYTES
        if count > longest:
            raise LimitExceeded(f"{count:,} elements; the limit is {longest:,}", here)
        return count

    def floats(self, index: int, path: str, widths: Container[int]) -> Floats:
        """Return an accessor's values, normalised integers as fractions.

        Parameters
        ----------
        index
            into the document's accessors
        path
            who asks, such as `meshes[0].primitives[0].attributes.POSITION`
        widths
            numbers of components that are allowed

        Returns
        -------
        (N, width) float32; may be a read-only view of the file
        """
        raw, accessor = self._raw(index, path, widths)
        if raw.dtype.kind == "f":
            return raw.astype(np.float32, copy=False)
        if accessor.componentType == 5125:
            raise InvalidScene("32-bit integers are for indices only", path)
        return unit_fractions(raw) if accessor.normalized else raw.astype(np.float32)

    def is_unnormalised_integer(self, index: int) -> bool:
        """Whether values are whole numbers, as KHR_mesh_quantization allows."""
        accessor = self._document.gltf.accessors[index]
        return accessor.componentType != 5126 and not accessor.normalized

    def largest(self, index: int) -> int:
        """Return the largest integer that an accessor's components can hold."""
        component = COMPONENTS[self._document.gltf.accessors[index].componentType]
        return int(np.iinfo(component).max)

    def indices(self, index: int, path: str) -> Longs:
        """Return (N,) int64 vertex indices; the caller checks them against its vertices."""
        raw, accessor = self._raw(index, path, (1,))
        if accessor.componentType not in _INDEX_COMPONENTS:
            raise InvalidScene("indices must be unsigned integers", path)
        return raw[:, 0].astype(np.int64)

    def _raw(
        self, index: int, path: str, widths: Container[int]
    ) -> tuple[NDArray[Any], pygltflib.Accessor]:
        count = self.count(index, path)
        accessor = self._document.gltf.accessors[index]
        here = f"accessors[{index}]"
        component = COMPONENTS.get(accessor.componentType)
        if component is None:
            raise InvalidScene(f"{accessor.componentType} is unknown", f"{here}.componentType")
        width = WIDTHS.get(accessor.type)
        if width is None or width not in widths:
            raise InvalidScene(f"{accessor.type[:20]} does not fit {path}", f"{here}.type")
        if accessor.bufferView is None:
            values = np.zeros((count, width), component)
        else:
            values = self._read(
                _Layout(accessor.bufferView, accessor.byteOffset, component, width, count, here)
            )
        if accessor.sparse is not None:
            values = self._with_sparse(values, accessor.sparse, f"{here}.sparse")
        return values, accessor

    def _read(self, layout: _Layout) -> NDArray[Any]:
        """(count, width) view of the file's bytes."""
        data = self._buffers.view(layout.view, f"{layout.path}.bufferView")
        size = layout.component.itemsize
        stride = self._buffers.stride(layout.view) or size * layout.width
        if stride < size * layout.width:
            raise InvalidScene(
                f"{stride} is less than the {size * layout.width} bytes of an element",
                f"bufferViews[{layout.view}].byteStride",
            )
        if layout.offset < 0:
            raise InvalidScene("is negative", f"{layout.path}.byteOffset")
        end = layout.offset + (layout.count - 1) * stride + size * layout.width
        if layout.count and end > len(data):
            raise InvalidScene(
                f"{layout.count:,} elements end at byte {end:,} of a buffer view of {len(data):,}",
                f"{layout.path}.count",
            )
        if layout.offset % size or stride % size:
            self._document.journal.note("is not aligned to its components", layout.path)
        if not layout.count:
            return np.zeros((0, layout.width), layout.component)
        return np.ndarray(
            (layout.count, layout.width),
            layout.component,
            data,
            layout.offset,
            (stride, size),
        )

    def _with_sparse(self, base: NDArray[Any], sparse: pygltflib.Sparse, path: str) -> NDArray[Any]:
        """Replace the elements that a sparse accessor lists."""
        if not 0 <= sparse.count <= len(base):
            raise InvalidScene(f"is not within 0..{len(base)}", f"{path}.count")
        kind = sparse.indices.componentType
        if kind not in _INDEX_COMPONENTS:
            raise InvalidScene(f"{kind} is no unsigned integer", f"{path}.indices.componentType")
        where = self._read(
            _Layout(
                sparse.indices.bufferView,
                sparse.indices.byteOffset,
                COMPONENTS[kind],
                1,
                sparse.count,
                f"{path}.indices",
            )
        )[:, 0].astype(np.int64)
        if where.size and where.max() >= len(base):
            raise InvalidScene(f"has an index outside 0..{len(base) - 1}", f"{path}.indices")
        if (np.diff(where) <= 0).any():
            raise InvalidScene("must increase", f"{path}.indices")
        values = self._read(
            _Layout(
                sparse.values.bufferView,
                sparse.values.byteOffset,
                base.dtype,
                base.shape[1],
                sparse.count,
                f"{path}.values",
            )
        )
        replaced = base.copy()
        replaced[where] = values
        return replaced


def unit_fractions(integers: NDArray[Any]) -> Floats:
    """Return normalised integers as float32 in 0..1 (unsigned) or -1..1 (signed)."""
    largest = np.float32(np.iinfo(integers.dtype).max)
    fractions: Floats = np.maximum(integers.astype(np.float32) / largest, np.float32(-1.0))
    return fractions
