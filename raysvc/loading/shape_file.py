"""Positions of vertices from a file: NumPy's .npy or .npz, or bare numbers.

What is claimed is checked before memory is asked for it, and nothing is unpickled.
"""

import dataclasses
import io
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from raysvc.errors import InvalidScene
from raysvc.limits import DEFAULT_LIMITS
from raysvc.loading.archive import unpack
from raysvc.loading.files import read_regular
from raysvc.loading.npy_file import LONGEST_HEADER, WIDEST_NUMBER, npy_array

NPY_MAGIC = b"\x93NUMPY"
ZIP_MAGIC = b"PK"


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """Where the V vertices of a known scene are, (V, 3) real numbers, and their normals if known.

    `raysvc.scene.Scene.deformed` checks the values.
    """

    positions: NDArray[Any]
    normals: NDArray[Any] | None = None


def largest_shape_file(vertices: int) -> int:
    """Bytes that a file of positions and normals may have: float64, headers, and some room."""
    return 2 * _largest_array(vertices) + (16 << 10)


def load_shape(path: str | os.PathLike[str], vertices: int) -> Shape:
    """Read a file on disk; see `read_shape`."""
    return read_shape(read_regular(Path(path), largest_shape_file(vertices), "positions"), vertices)


def read_shape(data: bytes | bytearray, vertices: int) -> Shape:
    """Read an .npy of positions, an .npz with `positions` and perhaps `normals`, or bare float32.

    Bare numbers are little-endian, x y z of vertex after vertex. Raises InvalidScene for what is
    none of them or has not the shape (vertices, 3), and LimitExceeded for an archive that unpacks
    to more than so many vertices could take.
    """
    if data.startswith(NPY_MAGIC):
        return Shape(_npy(data, vertices, "positions"))
    if data.startswith(ZIP_MAGIC) and len(data) != 12 * vertices:
        return _npz(bytes(data), vertices)
    if len(data) != 12 * vertices:
        raise InvalidScene(
            f"needs an .npy or .npz file, or {12 * vertices:,} bytes: three float32 for each of "
            f"{vertices:,} vertices; has {len(data):,} bytes",
            field="positions",
        )
    return Shape(np.frombuffer(data, "<f4").reshape(vertices, 3))


def npz_of(shape: Shape) -> bytes:
    """Return an .npz file that `read_shape` reads."""
    file = io.BytesIO()
    if shape.normals is None:
        np.savez(file, positions=shape.positions)
    else:
        np.savez(file, positions=shape.positions, normals=shape.normals)
    return file.getvalue()


def npy_of(positions: NDArray[Any]) -> bytes:
    """Return an .npy file that `read_shape` reads."""
    file = io.BytesIO()
    np.save(file, positions, allow_pickle=False)
    return file.getvalue()


def _npz(data: bytes, vertices: int) -> Shape:
    limits = dataclasses.replace(
        DEFAULT_LIMITS,
        max_files=2,
        max_file_bytes=_largest_array(vertices),
        max_scene_bytes=largest_shape_file(vertices),
        max_archive_ratio=float("inf"),  # what is unpacked is bounded by the vertices
    )
    files = unpack(data, limits)
    unknown = files.keys() - {"positions.npy", "normals.npy"}
    if unknown:
        shown = ascii(min(unknown))[:120]
        raise InvalidScene(f"holds {shown}; known are positions and normals", field="positions")
    if "positions.npy" not in files:
        raise InvalidScene("is missing from the archive", field="positions")
    arrays = {
        name: _npy(files[f"{name}.npy"], vertices, name)
        for name in ("positions", "normals")
        if f"{name}.npy" in files
    }
    return Shape(**arrays)


def _npy(data: bytes | bytearray, vertices: int, field: str) -> NDArray[Any]:
    try:
        return npy_array(data, (vertices, 3))
    except ValueError as error:
        raise InvalidScene(str(error), field) from None


def _largest_array(vertices: int) -> int:
    return 3 * vertices * WIDEST_NUMBER + LONGEST_HEADER + 128
