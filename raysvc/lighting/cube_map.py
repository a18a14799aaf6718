"""What six pictures from one point show of all directions, as a lat-long map.

Each face of the cube is a picture of `size` x `size` pixels with a border of one more: it shows
what the next face does, so that an interpolation never has to look for it there, and there are no
seams.
"""

import numpy as np

from raysvc.lighting.cube_map_kernels import BORDER, resample_cube
from raysvc.parallel import Control, for_chunks
from raysvc.scene import Camera
from raysvc.types import Doubles, Floats

ROWS = 16
"""Of the map, at a time."""
DETAIL = 2
"""Along both sides of a texel: it covers up to three pixels at the corners of the cube."""


def _face(forward: tuple[int, int, int], up: tuple[int, int, int]) -> Doubles:
    return np.array([np.cross(forward, up), up, forward], np.float64)


FACES = np.stack(
    [
        _face((1, 0, 0), (0, 1, 0)),
        _face((-1, 0, 0), (0, 1, 0)),
        _face((0, 1, 0), (0, 0, 1)),
        _face((0, -1, 0), (0, 0, -1)),
        _face((0, 0, 1), (0, 1, 0)),
        _face((0, 0, -1), (0, 1, 0)),
    ]
)
"""(6, 3, 3): right, up and forward of each face."""


def face_cameras(at: Doubles, size: int) -> tuple[Camera, ...]:
    """Six cameras at a point (3,), each of a face with its border: `size` + 2 BORDER pixels."""
    side = size + 2 * BORDER
    cameras = []
    for right, up, forward in FACES:
        pose = np.eye(4)
        pose[:3, 0], pose[:3, 1], pose[:3, 2], pose[:3, 3] = right, up, -forward, at
        cameras.append(Camera(pose, side, side, half_height=side / size))
    return tuple(cameras)


def pixel_half_width_rad(size: int) -> float:
    """Half the angle of the cone that covers as much as a pixel in the middle of a face."""
    return 2.0 / size / float(np.sqrt(np.pi))


def lat_long_of_faces(faces: Floats, control: Control) -> Floats:
    """Resample pictures of the six faces.

    Parameters
    ----------
    faces
        (6, S + 2 BORDER, S + 2 BORDER, 3) float32, as `face_cameras` see them

    Returns
    -------
    (2 S, 4 S, 3) float32, as `raysvc.scene.Environment` holds it: texels at the horizon are a
    little smaller than the largest pixels. Every texel is the mean of DETAIL x DETAIL bilinear
    lookups.
    """
    size = faces.shape[1] - 2 * BORDER
    result = np.empty((2 * size, 4 * size, 3), np.float32)

    def some(begin: int, end: int) -> None:
        resample_cube(faces, FACES, DETAIL, begin, end, result)

    for_chunks(len(result), ROWS, some, control)
    return result
