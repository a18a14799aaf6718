"""A pinhole anywhere on the lens shows what is in focus where the camera does."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from raysvc.raster.project import project
from raysvc.scene import Camera

PLACES = st.tuples(st.floats(-1, 1), st.floats(-1, 1))


def camera(projection: str, rng: np.random.Generator) -> Camera:
    turned, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    pose = np.eye(4)
    pose[:3, :3] = turned * np.linalg.det(turned)
    pose[:3, 3] = rng.normal(size=3)
    return Camera(pose, 40, 30, projection, 0.7, aperture_radius=0.2, focus_distance=3.0)


@pytest.mark.parametrize("projection", ["perspective", "orthographic"])
@given(place=PLACES, seed=st.integers(0, 1000))
def test_rays_of_a_pixel_meet_in_focus_wherever_they_start(projection, place, seed) -> None:
    rng = np.random.default_rng(seed)
    middle, pixel = camera(projection, rng), rng.integers(0, 1200, 20)
    through = middle.through_lens(*place).shifted(0.3, -0.2)
    points = []
    for each in (middle.shifted(0.3, -0.2), through):
        origins, directions = each.rays(pixel)
        along = 3.0 / (directions @ each.forward)
        points.append(origins + along[:, None] * directions)
    assert np.allclose(*points, atol=1e-5)
    axes = middle.world_from_camera[:3, :2]
    assert np.allclose((through.eye - middle.eye) @ axes, 0.2 * np.array(place))
    assert through.aperture_radius == 0


@pytest.mark.parametrize("projection", ["perspective", "orthographic"])
@given(place=PLACES, seed=st.integers(0, 1000))
def test_what_rays_show_is_drawn_in_their_pixels(projection, place, seed) -> None:
    rng = np.random.default_rng(seed)
    through = camera(projection, rng).through_lens(*place)
    pixel = rng.integers(0, 1200, 20)
    origins, directions = through.rays(pixel)
    points = origins + rng.uniform(1.0, 9.0, (20, 1)) * directions
    x, y, w, depth = project(points.astype(np.float32), through).T
    assert np.allclose(x / w, pixel % 40 + 0.5, atol=1e-3)
    assert np.allclose(y / w, pixel // 40 + 0.5, atol=1e-3)
    assert np.allclose(depth, (points - through.eye) @ through.forward, atol=1e-5)
