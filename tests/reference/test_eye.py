"""Rays through the lens: they meet in focus, and part as `coc_px` says elsewhere."""

import numpy as np
import pytest

from raysvc.lens.aperture import Aperture, extent
from raysvc.lens.coc import coc_px
from raysvc.reference.eye import camera_rays, on_aperture, on_disc
from tests.scenes import camera

LENS = {"aperture_radius": 0.08, "focus_distance": 3.0}
KINDS = {
    "perspective": {"half_height": 0.3},
    "orthographic": {"half_height": 1.5, "projection": "orthographic"},
}


def points_at(view, rays, depth):
    """(N, 3) where rays are at a depth along the view axis."""
    origins, directions = rays.origins.astype(float), rays.directions.astype(float)
    t = (depth - (origins - view.eye) @ view.forward) / (directions @ view.forward)
    return origins + t[:, None] * directions


@pytest.mark.parametrize("kind", KINDS)
def test_without_an_aperture_rays_are_the_cameras(rng, kind):
    view = camera(eye=(1, 2, 3), **KINDS[kind])
    pixel, within = rng.integers(0, 192, 50), rng.random((50, 2)) - 0.5
    rays = camera_rays(view, pixel, within, rng.random((50, 2)))
    origins, directions = view.rays(pixel, within)
    np.testing.assert_array_equal(rays.origins, origins)
    np.testing.assert_array_equal(rays.directions, directions)
    assert (rays.t_max == np.inf).all()


@pytest.mark.parametrize("kind", KINDS)
def test_all_rays_of_a_place_meet_in_focus_and_start_on_the_lens(rng, kind):
    view = camera(eye=(1, 2, 3), target=(0, 1, -2), **LENS, **KINDS[kind])
    pixel, within = np.full(500, 77), np.tile([0.2, -0.3], (500, 1))
    rays = camera_rays(view, pixel, within, rng.random((500, 2)))
    np.testing.assert_allclose(np.linalg.norm(rays.directions, axis=1), 1, rtol=1e-6)
    meet = points_at(view, rays, view.focus_distance)
    origins, directions = view.rays(pixel[:1], within[:1])
    t = view.focus_distance / (directions[0] @ view.forward)
    np.testing.assert_allclose(meet, np.tile(origins[0] + t * directions[0], (500, 1)), atol=2e-6)
    off = rays.origins - origins[0]
    assert np.abs(off @ view.forward).max() < 1e-6
    radius = np.linalg.norm(off, axis=1)
    assert 0.95 * view.aperture_radius < radius.max() <= view.aperture_radius * (1 + 1e-5)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("depth", [0.5, 2.0, 3.0, 12.0])
def test_a_point_out_of_focus_covers_its_circle_of_confusion(kind, depth):
    """Rays through the rim of the lens that cross at the point come from pixels that far apart."""
    view = camera(width=200, height=100, **LENS, **KINDS[kind])
    pixel = np.arange(200 * 100)
    per_pixel = view.metres_per_pixel_at_unit_depth
    # At `depth`, one pixel's rays spread over a disc; its size in pixels there is the blur
    rim = np.stack([np.zeros(len(pixel)), np.full(len(pixel), 0.5)], axis=1)
    other = np.stack([np.ones(len(pixel)), np.full(len(pixel), 0.5)], axis=1)
    still = np.zeros((len(pixel), 2))
    left = points_at(view, camera_rays(view, pixel, still, rim), depth)
    right = points_at(view, camera_rays(view, pixel, still, other), depth)
    width = per_pixel * (depth if kind == "perspective" else 1.0)
    apart = np.linalg.norm(right - left, axis=1) / width
    np.testing.assert_allclose(apart, abs(coc_px(view, np.float32([depth]))[0]), atol=2e-3)


def test_the_disc_is_covered_evenly(rng):
    points = on_disc(rng.random((200_000, 2)))
    radius, angle = np.linalg.norm(points, axis=1), np.arctan2(points[:, 1], points[:, 0])
    assert radius.max() <= 1
    rings = np.histogram2d(radius**2, angle, [8, 16], [[0, 1], [-np.pi, np.pi]])[0]
    np.testing.assert_allclose(rings, 200_000 / 128, rtol=0.12)


def test_the_middle_of_the_square_is_the_middle_of_the_disc():
    assert (on_disc(np.array([[0.5, 0.5]])) == 0).all()


@pytest.mark.parametrize("aperture", [Aperture(3), Aperture(5, 17.0), Aperture(8, -30.0)])
def test_a_polygon_is_covered_evenly_and_to_its_corners(rng, aperture):
    x, y = on_aperture(aperture, rng.random((200_000, 2))).T
    left, right = extent(aperture, y)
    assert np.all((x >= left - 1e-9) & (x <= right + 1e-9))
    assert np.hypot(x, y).max() == pytest.approx(1.0, abs=0.02)
    # Of each height there is as much as the polygon is wide there.
    edges = np.linspace(-1, 1, 41)
    middle = (edges[1:] + edges[:-1]) / 2
    low, high = extent(aperture, middle)
    wide = np.maximum(high - low, 0)
    found = np.histogram(y, edges)[0] / len(y)
    np.testing.assert_allclose(found, wide / wide.sum(), atol=0.004)


def test_one_corner_is_up():
    corner = on_aperture(Aperture(5), np.array([[0.0, 1.0]]))
    np.testing.assert_allclose(corner, [[0.0, 1.0]], atol=1e-12)
