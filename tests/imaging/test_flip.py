"""FLIP and HDR-FLIP against what their authors' package (flip-evaluator 1.7) gives."""

import numpy as np
import pytest

from raysvc.errors import Cancelled, InvalidInput
from raysvc.imaging.flip import PIXELS_PER_DEGREE, flip
from raysvc.imaging.hdr_flip import exposures_of, filmic, hdr_flip
from raysvc.parallel import Control
from tests.imaging.flip_pictures import colours, display_pairs, plain, scene_pairs

# Mean, greatest, and the values of pixels (0, 0) and (20, 32).
FLIP = {
    ("grain", 67.02064): (0.169840, 0.475664, 0.214415, 0.071259),
    ("moved", 67.02064): (0.287061, 0.971005, 0.967312, 0.339017),
    ("dotted", 67.02064): (0.001720, 0.395113, 0.000000, 0.133213),
    ("inverted", 67.02064): (0.566091, 0.967240, 0.967240, 0.271081),
    ("black and white", 67.02064): (0.967365, 0.967388, 0.967388, 0.967388),
    ("green and blue", 67.02064): (1.0, 1.0, 1.0, 1.0),
    ("grain", 30.0): (0.303286, 0.662307, 0.282276, 0.208711),
    ("moved", 30.0): (0.321796, 0.972713, 0.968380, 0.391591),
    ("dotted", 30.0): (0.001139, 0.888587, 0.000000, 0.035578),
    ("inverted", 30.0): (0.939192, 0.967389, 0.967383, 0.869236),
}
HDR_FLIP = {
    "dim": (0.065717, 0.221487, 0.064568, 0.068063),
    "sun": (0.087770, 0.799062, 0.073409, 0.070125),
}
EXPOSURES = {"dim": (-1.1721041, 1.2043056, 3), "sun": (-11.2044153, 1.1854076, 13)}


def told(errors):
    return errors.mean(dtype=np.float64), errors.max(), errors[0, 0], errors[20, 32]


@pytest.mark.parametrize(("name", "pixels_per_degree"), FLIP)
def test_flip_is_that_of_its_authors(name, pixels_per_degree):
    found = told(flip(*display_pairs()[name], pixels_per_degree))
    assert found == pytest.approx(FLIP[name, pixels_per_degree], abs=2e-4)


@pytest.mark.parametrize("name", HDR_FLIP)
def test_hdr_flip_is_that_of_its_authors(name):
    measured = hdr_flip(*scene_pairs()[name])
    assert told(measured.errors) == pytest.approx(HDR_FLIP[name], abs=2e-4)
    stops = measured.exposures_stops
    assert (stops[0], stops[-1], len(stops)) == pytest.approx(EXPOSURES[name], abs=1e-4)


def test_the_screen_is_the_papers():
    assert pytest.approx(67.02, abs=0.005) == PIXELS_PER_DEGREE


def test_a_picture_does_not_differ_from_itself():
    assert not flip(colours(), colours()).any()
    assert not hdr_flip(colours(), colours()).errors.any()


def test_flip_does_not_mind_the_order():
    one, other = display_pairs()["grain"]
    np.testing.assert_array_equal(flip(one, other), flip(other, one))


def test_an_error_that_one_exposure_hides_is_found_at_another():
    one, other = plain(40, 40, 40), plain(80, 80, 80)
    one[:24], other[:24] = 0.02, 0.02
    shown = [np.clip(each, 0, 1) for each in (one, other)]
    assert not flip(*shown).any()
    assert hdr_flip(one, other).errors[40, 32] > 0.1


def test_the_number_of_threads_does_not_matter():
    pair = scene_pairs()["sun"]
    few, many = (hdr_flip(*pair, control=Control(threads)).errors for threads in (1, 3))
    np.testing.assert_array_equal(few, many)


def test_pictures_without_light_have_an_exposure():
    assert exposures_of(plain(0, 0, 0)) == (0.0,)
    assert not hdr_flip(plain(0, 0, 0), plain(0, 0, 0)).errors.any()
    half = plain(0, 0, 0)
    half[30:] = 1.0
    assert exposures_of(half) == exposures_of(plain(1, 1, 1))


def test_the_brightest_light_stays_finite():
    shown = filmic(np.array([0.0, 1.0, 1e20, np.inf], np.float32))
    assert shown[0] == 0 and shown[2] == shown[3] == 1
    assert np.isfinite(shown).all()


@pytest.mark.parametrize("compare", [flip, hdr_flip])
@pytest.mark.parametrize("shape", [(48, 63, 3), (48, 64, 4), (48, 64)])
def test_only_pictures_of_one_shape_are_compared(compare, shape):
    with pytest.raises(InvalidInput):
        compare(colours(), np.zeros(shape, np.float32))
    with pytest.raises(InvalidInput):
        compare(np.zeros(shape, np.float32)[..., :2], np.zeros(shape, np.float32)[..., :2])


def test_comparing_exposures_can_be_stopped():
    control = Control(1)
    control.cancel()
    with pytest.raises(Cancelled):
        hdr_flip(*scene_pairs()["sun"], control=control)
