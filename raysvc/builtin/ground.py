"""The park's lawn as a height above (x, z), and the path that winds over it."""

import numpy as np

from raysvc.builtin.mesh import Mesh
from raysvc.builtin.shapes import sheet
from raysvc.types import Bools, Doubles

PATH_WIDTH = 1.7
SANDSTONE = (0.60, 0.53, 0.43)
_PATH_Z = (27.0, -29.0)
_ABOVE_LAWN = 0.035


def height_of_ground(x: Doubles, z: Doubles) -> tuple[Doubles, Doubles]:
    """Heights (N,) and unit normals (N, 3) of the lawn: flat in the middle, with high banks."""
    step = 1e-3
    along_x = (_height(x + step, z) - _height(x - step, z)) / (2 * step)
    along_z = (_height(x, z + step) - _height(x, z - step)) / (2 * step)
    normals = np.column_stack([-along_x, np.ones(len(x)), -along_z])
    return _height(x, z), normals / np.linalg.norm(normals, axis=1, keepdims=True)


def path_mesh() -> Mesh:
    """Strip of paving along the path, just above the lawn."""
    strip = sheet(1.0, 1.0, 6, 240)
    across, along = strip.positions[:, 0], strip.positions[:, 2] + 0.5
    z = _PATH_Z[0] + along * (_PATH_Z[1] - _PATH_Z[0])
    x = _path_x(z) - across * PATH_WIDTH
    height, normals = height_of_ground(x, z)
    tangents = np.column_stack([-normals[:, 1], normals[:, 0], np.zeros(len(x))])
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    length = abs(_PATH_Z[1] - _PATH_Z[0])
    return Mesh(
        positions=np.column_stack([x, height + _ABOVE_LAWN, z]),
        normals=normals,
        tangents=np.column_stack([tangents, np.ones(len(x))]),
        uv=strip.uv * (PATH_WIDTH / 2.4, length / 2.4),
        colours=np.full((len(x), 3), SANDSTONE),
        triangles=strip.triangles,
    )


def beside_path(x: Doubles, z: Doubles) -> Bools:
    """Whether points are off the path."""
    return np.asarray(np.abs(x - _path_x(z)) > 0.5 * PATH_WIDTH + 0.04)


def _path_x(z: Doubles) -> Doubles:
    return np.asarray(-3.3 + 4.4 * (1.0 - np.cos(z / 8.0)) * np.where(z < 0, 1.0, 0.35))


def _height(x: Doubles, z: Doubles) -> Doubles:
    radius, turn = np.hypot(x, z), np.arctan2(z, x)
    rolling = 0.22 * np.sin(0.45 * x + 1.0) * np.cos(0.38 * z) + 0.1 * np.sin(0.21 * z - 0.3 * x)
    banks = 2.3 + 0.9 * np.sin(2.0 * turn + 1.0) + 0.5 * np.sin(5.0 * turn)
    return np.asarray(_rise(radius, 3.2, 10.0) * rolling + _rise(radius, 11.0, 31.0) * banks)


def _rise(value: Doubles, start: float, end: float) -> Doubles:
    """Smooth step from 0 to 1, twice differentiable."""
    t = np.clip((value - start) / (end - start), 0.0, 1.0)
    return np.asarray(t**3 * (t * (6.0 * t - 15.0) + 10.0))
