"""Rays from points of the lens through pixels.

The lens is that of `raysvc.lens.coc`: all rays of one point of the picture meet at the focus
distance, on the ray that a pinhole camera has there.
"""

import numpy as np

from raysvc.accel.base import Rays
from raysvc.lens.aperture import DISC, Aperture
from raysvc.scene import Camera
from raysvc.types import Doubles, Longs


def camera_rays(
    camera: Camera, pixel: Longs, within: Doubles, on_lens: Doubles, aperture: Aperture = DISC
) -> Rays:
    """Rays (N) of pixels (N,), flat indices.

    Parameters
    ----------
    within
        (N, 2) place in the pixel, from its centre (x to the right, y down)
    on_lens
        (N, 2) random numbers in 0..1 that choose a point of the lens
    aperture
        the part of the lens that is open
    """
    origins, directions = camera.rays(pixel, within)
    if camera.aperture_radius > 0.0:
        right, up = camera.world_from_camera[:3, 0], camera.world_from_camera[:3, 1]
        place = camera.aperture_radius * on_aperture(aperture, on_lens)
        moved = place[:, :1] * right + place[:, 1:] * up
        along = directions.astype(np.float64)
        along *= camera.focus_distance / (along @ camera.forward)[:, None]
        along -= moved
        along /= np.sqrt(np.einsum("nk,nk->n", along, along))[:, None]
        origins = (origins + moved).astype(np.float32)
        directions = along.astype(np.float32)
    return Rays(origins, directions, np.full(len(pixel), np.inf, np.float32))


def on_aperture(aperture: Aperture, place: Doubles) -> Doubles:
    """Points (N, 2) of an opening of radius 1, x to the right and y up, for points (N, 2) of the
    unit square; areas are kept."""
    if aperture.blades == 0:
        return on_disc(place)
    # A triangle from the middle to two corners for each side, and a point of it.
    side = place[:, 0] * aperture.blades
    number = np.floor(side)
    turn = 2.0 * np.pi / aperture.blades
    angle = np.radians(90.0 + aperture.rotation_deg) + number * turn
    from_middle, along = np.sqrt(place[:, 1]), side - number
    first, second = from_middle * (1.0 - along), from_middle * along
    points: Doubles = np.stack(
        [
            first * np.cos(angle) + second * np.cos(angle + turn),
            first * np.sin(angle) + second * np.sin(angle + turn),
        ],
        axis=1,
    )
    return points


def on_disc(place: Doubles) -> Doubles:
    """Points (N, 2) of the unit disc for points (N, 2) of the unit square, areas kept.

    Shirley and Chiu 1997, "A Low Distortion Map Between Disk and Square".
    """
    x, y = 2.0 * place.T - 1.0
    wide = np.abs(x) > np.abs(y)
    radius = np.where(wide, x, y)
    ratio = np.where(wide, y, x) / np.where(radius == 0.0, 1.0, radius)
    angle = np.where(wide, ratio, 2.0 - ratio) * (np.pi / 4.0)
    points: Doubles = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    return points
