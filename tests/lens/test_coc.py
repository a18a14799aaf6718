"""Circles of confusion against explicit rays through the edge of the lens."""

import numpy as np
import pytest

from raysvc.lens.coc import LARGEST_COC_PX, coc_px
from raysvc.scene import Camera


def camera(**changes):
    given = {"width": 1920, "height": 1080, "half_height": 0.2, "aperture_radius": 0.014}
    return Camera(np.eye(4), **{**given, "focus_distance": 2.0, **changes})


def pixel_of_ray(camera, lens_x, depth):
    """Column, from the middle, that a point on the axis has, seen through (lens_x, 0) of the lens.

    The ray from the point through the lens crosses the plane of focus where the pixel's own ray,
    through the middle of the lens, crosses it too: all rays of a pixel meet there.
    """
    slope = lens_x / depth
    at_focus = lens_x - slope * camera.focus_distance
    return at_focus / camera.focus_distance / (2 * camera.half_height / camera.height)


@pytest.mark.parametrize("depth", [0.3, 1.0, 1.99, 2.0, 2.5, 10.0, 1e6])
def test_two_rays_through_the_lens_land_one_diameter_apart(depth):
    lens = camera()
    left = pixel_of_ray(lens, -lens.aperture_radius, depth)
    right = pixel_of_ray(lens, lens.aperture_radius, depth)
    coc = coc_px(lens, np.float32([depth]))[0]
    assert abs(coc) == pytest.approx(abs(right - left), rel=1e-4, abs=1e-5)


def test_the_textbook_example_has_its_textbook_diameters():
    # 50 mm at f/1.8 focused at 2 m on a 36 x 20.25 mm sensor of 1920 x 1080 pixels; the image
    # plane lies f z / (z - f) behind the lens, so the field of view is a little less than 50 mm's.
    focal, focus, sensor = 0.050, 2.0, 0.02025
    image_plane = focal * focus / (focus - focal)
    lens = camera(half_height=sensor / 2 / image_plane, aperture_radius=focal / 1.8 / 2)
    coc = coc_px(lens, np.float32([1.0, 10.0, np.inf]))
    assert coc == pytest.approx([-37.99, 30.39, 37.99], abs=5e-3)


def test_nearer_is_negative_focus_is_zero_and_farther_is_positive():
    near, focus, far = coc_px(camera(), np.float32([1.0, 2.0, 3.0]))
    assert near < 0 < far
    assert focus == 0


def test_a_pinhole_blurs_nothing():
    depth = np.float32([[0.1, 5.0, np.inf]])
    assert np.array_equal(coc_px(camera(aperture_radius=0.0), depth), np.zeros((1, 3)))


def test_an_orthographic_lens_grows_linearly_with_the_distance_from_the_focus():
    lens = camera(projection="orthographic", half_height=1.08, aperture_radius=0.01)
    coc = coc_px(lens, np.float32([1.0, 2.0, 4.0, np.inf]))
    assert coc == pytest.approx([-5.0, 0.0, 10.0, LARGEST_COC_PX])


def test_a_point_on_the_lens_is_blurred_finitely():
    assert coc_px(camera(), np.float32([0.0]))[0] == -LARGEST_COC_PX
