import dataclasses
import json

import numpy as np
import pytest

import raysvc
from raysvc.compare.picture_comparison import (
    compare_pictures,
    difference_picture,
    difference_png,
    frame_difference,
    reference_settings,
)
from raysvc.compare.picture_difference import EPSILON, picture_difference
from raysvc.errors import InvalidInput, InvalidSetting
from raysvc.frame.settings import Settings
from raysvc.frame.view import View
from raysvc.imaging.flip import flip

SHAPE = (40, 50, 4)
VIEW = View(gltf_camera=0, width=32, height=24)


def plain(*colour):
    return np.full(SHAPE, colour, np.float32)


def between(picture, reference, **more):
    return picture_difference(picture, reference, more.pop("tone_map", "linear"), **more)


@pytest.fixture(scope="module")
def cornell():
    return raysvc.load("builtin:cornell")


def test_a_picture_is_as_its_reference_when_it_is_the_same(rng):
    picture = rng.random(SHAPE, np.float32)
    found = between(picture, picture.copy())
    assert dataclasses.astuple(found.figures) == (0.0, 0.0, 0.0, 0.0, 1.0)
    assert not found.flip_map.any()


def test_relative_squares_are_of_the_reference():
    found = between(plain(0.3, 0.2, 0.1, 1), plain(0.1, 0.2, 0.4, 1)).figures
    expected = (0.04 / (0.01 + EPSILON) + 0 + 0.09 / (0.16 + EPSILON)) / 3
    assert found.rel_mse == pytest.approx(expected, rel=1e-5)
    assert found.rel_mse_trimmed == pytest.approx(expected, rel=1e-5)
    assert found.mean_ratio == pytest.approx(0.6 / 0.7, rel=1e-5)


def test_the_worst_thousandth_is_trimmed():
    picture, reference = plain(1, 1, 1, 1), plain(1, 1, 1, 1)
    picture[0, :2, :3] = 1000.0
    found = between(picture, reference).figures
    assert found.rel_mse > 100 and found.rel_mse_trimmed == 0.0
    picture[0, 2, :3] = 1000.0
    assert between(picture, reference).figures.rel_mse_trimmed > 100


def test_flip_is_of_the_pictures_as_displayed_at_an_exposure(rng):
    one, other = (4 * rng.random(SHAPE, np.float32) for _ in range(2))
    one[..., 3] = other[..., 3] = 1.0
    found = between(one, other, exposure_stops=-1.0, tone_map="reinhard")
    assert found.picture.dtype == np.uint8 and found.picture.shape == (40, 50, 3)
    shown = [each.astype(np.float32) / 255 for each in (found.picture, found.reference)]
    np.testing.assert_array_equal(found.flip_map, flip(*shown))
    assert found.figures.flip == pytest.approx(found.flip_map.mean(), rel=1e-5)
    assert found.figures.flip != between(one, other, tone_map="reinhard").figures.flip


def test_what_is_blown_out_differs_only_in_hdr():
    found = between(plain(40, 40, 40, 1), plain(80, 80, 80, 1)).figures
    assert found.flip == 0.0
    assert found.hdr_flip > 0.1


def test_what_is_transparent_is_compared_as_black():
    nothing, half = plain(0, 0, 0, 0), plain(0.25, 0.25, 0.25, 0.5)
    assert not between(nothing, half).picture.any()
    assert between(nothing, plain(0, 0, 0, 1)).figures.flip == 0.0
    # sRGB of 0.5 is 188, and half of that shows over black.
    assert (between(half, nothing).picture == 94).all()


def test_beside_black_there_is_no_ratio():
    assert between(plain(1, 1, 1, 1), plain(0, 0, 0, 1)).figures.mean_ratio is None


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_pictures_with_pixels_that_are_no_numbers_are_refused(value):
    broken = plain(1, 1, 1, 1)
    broken[3, 4, 1] = value
    for pair in ((broken, plain(1, 1, 1, 1)), (plain(1, 1, 1, 1), broken)):
        with pytest.raises(InvalidInput, match="not finite"):
            between(*pair)


def test_pictures_of_two_sizes_are_refused():
    with pytest.raises(InvalidInput):
        between(plain(1, 1, 1, 1), plain(1, 1, 1, 1)[1:])
    with pytest.raises(InvalidSetting):
        between(plain(1, 1, 1, 1), plain(1, 1, 1, 1), tone_map="sepia")


def test_the_difference_is_shown_beside_both_pictures():
    picture, reference = plain(0, 0, 0, 1), plain(0, 0, 0, 1)
    picture[:, 25:] = (0, 1, 0, 1)
    reference[:, 25:] = (0, 0, 1, 1)
    found = between(picture, reference)
    shown = difference_picture(found)
    assert shown.shape == (40, 150, 3)
    np.testing.assert_array_equal(shown[:, :50], found.picture)
    np.testing.assert_array_equal(shown[:, 50:100], found.reference)
    # The ends of the map called magma: green for blue is as unlike as can be.
    assert shown[20, 100].tolist() == [0, 0, 3]
    assert shown[20, -1].tolist() == [251, 252, 191]
    assert difference_png(found) == difference_png(found)


def test_two_frames_are_compared_as_the_first_displays_them(cornell):
    def frame(**settings):
        return raysvc.render(cornell, camera=VIEW, settings=settings)

    dim = frame(exposure_stops=-2.0, tone_map="aces")
    found = frame_difference(dim, frame(aa="full"))
    np.testing.assert_array_equal(found.picture, dim.display()[..., :3])
    assert 0.0 < found.figures.flip < 0.2


def test_a_picture_is_compared_with_its_reference(cornell):
    settings = {"occlusion_samples": 4, "threads": 2}
    environment = raysvc.load_environment("builtin:gradient")
    compared = compare_pictures(cornell, environment, VIEW, settings, 2)
    plain_figures = compared.to_dict()
    json.dumps(plain_figures, allow_nan=False)
    assert plain_figures["width"] == 32 and plain_figures["camera"]["gltf_camera"] == 0
    assert plain_figures["settings"]["occlusion_samples"] == 4
    assert plain_figures["reference_settings"]["threads"] == 2
    assert (plain_figures["scene"], plain_figures["environment"]) == ("cornell", "gradient")
    assert 0.0 < plain_figures["flip"] < 0.9 and 0.2 < plain_figures["mean_ratio"] < 5.0
    assert plain_figures["seconds"] > 0 and plain_figures["reference_seconds"] > 0
    frame = raysvc.render(cornell, environment, VIEW, settings)
    np.testing.assert_array_equal(compared.difference.picture, frame.display()[..., :3])


def test_the_default_light_is_named(cornell):
    compared = compare_pictures(cornell, camera=VIEW, samples=1, source="builtin:cornell")
    assert compared.environment == "builtin:clear_sky"
    assert compared.scene == "builtin:cornell"


def test_the_reference_shows_the_same_thing_in_its_own_way():
    asked = Settings(
        bounces=0, exposure_stops=1.0, background=(1.0, 0.0, 0.0), lens="none", threads=3
    )
    true = reference_settings(asked, 7)
    assert true.mode == "reference" and true.samples == 7
    assert true.bounces == Settings().bounces
    for name in ("exposure_stops", "background", "lens", "threads"):
        assert getattr(true, name) == getattr(asked, name)
    assert reference_settings(asked).samples == Settings().samples
