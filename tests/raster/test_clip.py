"""Triangles that reach behind the camera or far beside the picture."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from raysvc.accel.base import Rays, Triangles
from raysvc.accel.registry import build
from raysvc.raster.clip import GUARD_PX, clip
from raysvc.raster.project import project
from tests.raster.drawing import raster, times_covered
from tests.scenes import camera, mesh, soup

SEEDS = st.integers(0, 2**32 - 1)


def plane(n, half, height=0.0):
    """A square ground of n x n cells in triangles, y = height, front upwards."""
    at = np.linspace(-half, half, n + 1)
    x, z = np.meshgrid(at, at)
    points = np.stack([x.ravel(), np.full(x.size, height), z.ravel()], axis=1)
    corner = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    a, b, c, d = corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]
    return mesh(
        points,
        np.concatenate(
            [np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)]
        ),
    )


@pytest.mark.parametrize("cells", [1, 7])
@pytest.mark.parametrize("half", [10.0, 1e5])
def test_ground_under_the_camera_fills_the_picture_below_the_horizon_once(cells, half):
    view = camera((0.1, 1.5, 0.2), (0.4, 1.5, -4), width=40, height=30)
    counts = times_covered(plane(cells, half), view, double_sided=False)
    rows = np.arange(30)
    # The horizon lies at row 15; the ground ends a little below it.
    assert (counts[rows < 15] == 0).all()
    assert (counts[rows > 20] == 1).all()
    assert counts.max() == 1


def test_a_camera_in_the_plane_of_the_ground_sees_no_pixel_of_it_twice():
    view = camera((0, 0, 0), (0, 0, -1), width=20, height=20)
    assert times_covered(plane(3, 50.0), view).max() <= 1


@settings(deadline=None, max_examples=40)
@given(SEEDS)
def test_a_closed_room_around_the_camera_covers_every_pixel_once(seed):
    rng = np.random.default_rng(seed)
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))]
    scene = mesh(corners * rng.uniform(0.1, 1e3), triangles)
    reach = np.abs(scene.positions).max()
    eye = rng.uniform(-0.9, 0.9, 3) * reach
    target = eye + rng.normal(size=3)
    view = camera(eye, target, width=33, height=21, half_height=rng.uniform(0.05, 3))
    assert (times_covered(scene, view, double_sided=True) == 1).all()


@settings(deadline=None, max_examples=40)
@given(SEEDS)
def test_clipped_triangles_keep_their_orientation_and_their_plane(seed):
    rng = np.random.default_rng(seed)
    positions, triangles = soup(rng, 30, size=2.0)
    view = camera((0, 0, 0.5), (0, 0, -1), width=40, height=30)
    corners = project(positions, view)[triangles]
    parts, source = clip(corners, 1e-3, 40, 30)
    assert (parts[:, :, 3] >= 1e-3 * (1 - 1e-9)).all()
    pixels = parts[:, :, :2] / parts[:, :, 2:3]
    assert np.abs(pixels).max(initial=0) <= GUARD_PX * (1 + 1e-9)
    # In homogeneous coordinates a part lies in the plane of its source, on the same side.
    for part, whole in zip(parts[:, :, [0, 1, 2]], corners[source][:, :, [0, 1, 2]], strict=True):
        weights = np.linalg.solve(whole.T, part.T)
        assert (weights > -1e-7).all()
        assert weights.sum(axis=0) == pytest.approx([1, 1, 1])
        assert np.linalg.det(weights) > -1e-9


def test_triangles_behind_or_beside_are_dropped():
    view = camera((0, 0, 0), (0, 0, -1), width=10, height=10)
    behind = [(-1, -1, 1), (1, -1, 1), (0, 1, 2)]
    beside = [(50, -1, -5), (52, -1, -5), (51, 1, -5)]
    seen = [(-1, -1, -5), (1, -1, -5), (0, 1, -5)]
    corners = project(np.array([behind, beside, seen], np.float32).reshape(-1, 3), view)
    parts, source = clip(corners.reshape(3, 3, 4), 0.1, 10, 10)
    assert source.tolist() == [2]
    assert len(parts) == 1


@settings(deadline=None, max_examples=25)
@given(SEEDS, st.sampled_from(["perspective", "orthographic"]), st.booleans())
def test_random_scenes_show_what_rays_meet(seed, projection, shifted):
    rng = np.random.default_rng(seed)
    positions, triangles = soup(rng, 40, size=1.0)
    scene = mesh(positions, triangles)
    view = camera(
        rng.uniform(-1, 1, 3),
        rng.uniform(-1, 1, 3) * 3,
        width=48,
        height=40,
        half_height=0.7,
        projection=projection,
    )
    if shifted:
        view = view.shifted(*rng.uniform(-0.5, 0.5, 2))
    seen = raster(scene, view).visible()
    origins, directions = view.rays(np.arange(48 * 40))
    asked = Rays(origins, directions, np.full(48 * 40, np.inf, np.float32))
    expected = build("brute", Triangles(scene.positions, scene.triangles)).nearest_triangle(asked)
    assert (seen != expected).mean() < 2e-3


def test_a_shifted_camera_moves_the_picture_by_whole_pixels(rng):
    positions, triangles = soup(rng, 40)
    scene = mesh(positions, triangles)
    for projection in ("perspective", "orthographic"):
        view = camera((0, 0, 3), width=32, height=24, half_height=0.5, projection=projection)
        seen = raster(scene, view).visible().reshape(24, 32)
        moved = raster(scene, view.shifted(3, -2)).visible().reshape(24, 32)
        assert (moved[2:, :-3] == seen[:-2, 3:]).all()


@pytest.mark.parametrize("projection", ["perspective", "orthographic"])
def test_a_point_is_projected_to_the_pixel_whose_ray_meets_it(rng, projection):
    view = camera((1, 2, 3), (0, 0.5, -1), width=64, height=36, projection=projection)
    view = replace(view.shifted(0.25, -0.125), half_height=0.8)
    pixel = np.arange(64 * 36)
    origins, directions = view.rays(pixel)
    points = origins + directions * rng.uniform(0.5, 20, (len(pixel), 1)).astype(np.float32)
    x, y, w, depth = project(points, view).T
    row, col = np.divmod(pixel, 64)
    # The offset moves the samples, so that the centres of pixels are where they always are.
    assert np.abs(x / w - (col + 0.5)).max() < 1e-3
    assert np.abs(y / w - (row + 0.5)).max() < 1e-3
    expected = (points - view.eye) @ view.forward
    assert np.allclose(depth, expected)
