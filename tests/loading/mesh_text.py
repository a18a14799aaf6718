"""Small mesh files written in the tests."""

import io
import struct

import numpy as np
from PIL import Image

from raysvc.loading import load_scene
from raysvc.loading.files import Files
from raysvc.scene import Scene

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
CORNERS = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]


def loaded(main: str | bytes, name: str = "a.obj", **side: str | bytes) -> Scene:
    """Load files in memory; side files are given as NAME_SUFFIX."""
    files = {name: main, **{key.replace("_", "."): value for key, value in side.items()}}
    as_bytes = {k: v.encode() if isinstance(v, str) else v for k, v in files.items()}
    return load_scene(Files.from_memory(as_bytes, name))


def png(rgba: list[list[tuple[int, int, int, int]]]) -> bytes:
    buffer = io.BytesIO()
    Image.fromarray(np.array(rgba, np.uint8)).save(buffer, "PNG")
    return buffer.getvalue()


def ply(vertices: str, count: int, properties: str, faces: str, face_count: int) -> bytes:
    return (
        f"ply\nformat ascii 1.0\nelement vertex {count}\n{properties}"
        f"element face {face_count}\nproperty list uchar int vertex_indices\n"
        f"end_header\n{vertices}{faces}"
    ).encode()


XYZ = "property float x\nproperty float y\nproperty float z\n"


def stl(triangles: np.ndarray) -> bytes:
    """Binary STL of (F, 3, 3) corners."""
    records = np.zeros(
        len(triangles), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")]
    )
    records["corners"] = triangles
    return b"\0" * 80 + struct.pack("<I", len(triangles)) + records.tobytes()


def cube() -> tuple[np.ndarray, np.ndarray]:
    """Corners and triangles of the unit cube about the origin."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 2
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return corners, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


def used_corners(scene: Scene) -> list[list[float]]:
    return scene.positions[scene.triangles].reshape(-1, 3).tolist()
