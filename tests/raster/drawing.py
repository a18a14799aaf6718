"""Triangles in pixel coordinates, and pictures of them."""

import numpy as np

from raysvc.parallel import Control
from raysvc.raster.rasterise import Raster
from raysvc.scene import Camera
from tests.scenes import mesh


def pixel_camera(width, height):
    """An orthographic camera to which (x, -y, z) is pixel (x, y), and z nearer where greater."""
    pose = np.eye(4)
    pose[:3, 3] = width / 2, -height / 2, 100
    return Camera(pose, width, height, projection="orthographic", half_height=height / 2)


def pixel_scene(points, triangles, **more):
    """A scene of points (x, y) or (x, y, z) in pixels, y downwards."""
    points = np.array([(*p, 0)[:3] for p in points], float) * [1, -1, 1]
    return mesh(points, triangles, **more)


def raster(scene, camera, *, solid=True, double_sided=True, threads=1):
    count = len(scene.triangles)
    return Raster(
        scene,
        np.full(count, solid),
        np.broadcast_to(np.asarray(double_sided), (count,)),
        camera,
        Control(threads=threads),
    )


def drawn(scene, camera, **more):
    """Rows of text: a letter for the triangle of each pixel, a dot for none."""
    seen = raster(scene, camera, **more).visible().reshape(camera.height, camera.width)
    return ["".join("." if t < 0 else chr(ord("a") + t) for t in row) for row in seen]


def times_covered(scene, camera, **more):
    """(H, W) how many fragments each pixel gets."""
    empty = raster(scene, camera, solid=False, **more)
    found = empty.nearer_fragments(np.arange(len(scene.triangles), dtype=np.int32))
    counts = np.bincount(found.pixel, minlength=camera.width * camera.height)
    return counts.reshape(camera.height, camera.width)
