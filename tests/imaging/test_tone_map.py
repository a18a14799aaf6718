"""Tone maps against their published formulas, and how pictures become 8 and 16 bits."""

import numpy as np
import pytest

from raysvc.errors import InvalidSetting
from raysvc.imaging.srgb import linear_from_srgb, srgb_from_linear
from raysvc.imaging.tone_curves import TONE_CURVES
from raysvc.imaging.tone_map import CHUNK_PIXELS, display, display8, display16
from raysvc.parallel import Control

CURVES = sorted(TONE_CURVES)


def greys(values):
    return np.repeat(np.asarray(values, np.float32)[:, None], 3, axis=1)


def curved(name, colours):
    return TONE_CURVES[name](colours.T).T


@pytest.mark.parametrize("name", CURVES)
def test_black_stays_black(name):
    assert np.array_equal(curved(name, greys([0.0])), greys([0.0]))


@pytest.mark.parametrize("name", CURVES)
def test_every_colour_lands_within_zero_and_one(name, rng):
    colours = (rng.random((4000, 3)) ** 8 * 1e6).astype(np.float32)
    shown = curved(name, colours)
    assert shown.dtype == np.float32
    assert shown.min() >= 0 and shown.max() <= 1


@pytest.mark.parametrize("name", CURVES)
def test_a_brighter_grey_is_never_darker(name):
    shown = curved(name, greys(np.geomspace(1e-4, 1e4, 3000)))
    assert np.all(np.diff(shown, axis=0) >= -2e-6)


@pytest.mark.parametrize("name", CURVES)
def test_a_very_bright_grey_is_white(name):
    assert curved(name, greys([1e8])).min() > 0.98


def neutral_of_the_specification(colour):
    """The formulas of KhronosGroup/ToneMapping, PBR_Neutral/README.md, one colour in double."""
    c = np.asarray(colour, float)
    f90, ks, kd = 0.04, 0.8 - 0.04, 0.15
    x = c.min()
    f = x - x * x / (4 * f90) if x <= 2 * f90 else f90
    p = (c - f).max()
    if p <= ks:
        return c - f
    pn = 1 - (1 - ks) ** 2 / (p + 1 - 2 * ks)
    g = 1 / (kd * (p - pn) + 1)
    return (c - f) * pn / p * g + pn * (1 - g)


def test_neutral_equals_its_specification(rng):
    colours = (rng.random((500, 3)) ** 3 * 20).astype(np.float32)
    expected = [neutral_of_the_specification(c) for c in colours]
    assert np.allclose(curved("pbr_neutral", colours), expected, atol=2e-6)


def test_neutral_only_takes_the_fresnel_offset_from_base_colours(rng):
    colours = rng.uniform(0.08, 0.79, (500, 3)).astype(np.float32)
    assert np.array_equal(curved("pbr_neutral", colours), colours - np.float32(0.04))


def test_aces_equals_hills_fit_for_a_grey():
    # The rows of the matrices sum to one within 1e-5, so a grey only meets the rational curve.
    v = 0.18
    fitted = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081)
    assert curved("aces", greys([v])) == pytest.approx(fitted, abs=2e-5)


def test_agx_equals_its_sigmoid_for_a_grey():
    v = 0.18
    x = (np.log2(v) + 12.47393) / (4.026069 + 12.47393)
    sigmoid = np.polyval([15.5, -40.14, 31.96, -6.868, 0.4298, 0.1191, -0.00232], x)
    # The two roundings of Rec.2020's matrices leave a grey off by about 1e-4.
    assert curved("agx", greys([v])) == pytest.approx(sigmoid**2.2, abs=5e-4)


def test_reinhard_shows_its_white_as_white_and_one_as_seventeen_thirtyseconds():
    assert curved("reinhard", greys([4.0])) == pytest.approx(1.0, abs=1e-6)
    assert curved("reinhard", greys([1.0])) == pytest.approx(17 / 32, abs=1e-6)


def test_the_srgb_curve_inverts_itself_and_keeps_the_ends():
    x = np.linspace(0, 1, 4097, dtype=np.float32)
    assert np.allclose(linear_from_srgb(srgb_from_linear(x)), x, atol=1e-6)
    assert srgb_from_linear(np.float32([0, 1])) == pytest.approx([0, 1], abs=1e-6)
    assert srgb_from_linear(np.float32([0.5])) == pytest.approx(0.735357, abs=1e-5)


def test_one_stop_doubles_the_light(rng):
    picture = rng.random((9, 7, 3)).astype(np.float32)
    assert np.array_equal(display8(picture, "agx", 1.0), display8(2 * picture, "agx"))


def test_soft_edges_keep_their_colour_and_get_straight_alpha():
    colour, alpha = np.float32([0.3, 0.2, 0.1]), np.float32(0.25)
    soft = np.concatenate([colour * alpha, [alpha]]).astype(np.float32)[None]
    solid = np.concatenate([colour, [1]]).astype(np.float32)[None]
    assert np.allclose(display(soft, "agx")[:, :3], display(solid, "agx")[:, :3], atol=1e-6)
    assert display(soft, "agx")[0, 3] == alpha


def test_broken_pixels_become_black_or_white_and_nothing_else():
    broken = np.float32([[np.nan, 0, 0], [-1, -np.inf, 0], [np.inf, np.inf, np.inf]])
    assert np.array_equal(
        np.rint(display(broken, "pbr_neutral")), [[0, 0, 0], [0, 0, 0], [1, 1, 1]]
    )


def test_an_overflowing_exposure_is_white():
    assert display8(np.full((1, 1, 3), 1e30, np.float32), "aces", 32.0).min() >= 254


def test_sixteen_bits_agree_with_eight(rng):
    picture = rng.random((31, 17, 4)).astype(np.float32)
    eight, sixteen = display8(picture, "aces"), display16(picture, "aces")
    assert sixteen.dtype == np.uint16
    assert np.abs(sixteen / 257 - eight).max() <= 0.501


@pytest.mark.parametrize("threads", [2, 5])
def test_the_bytes_do_not_depend_on_the_number_of_threads(threads, rng):
    picture = rng.random((5, CHUNK_PIXELS, 4)).astype(np.float32)
    one = display8(picture, "agx", control=Control(threads=1))
    assert np.array_equal(one, display8(picture, "agx", control=Control(threads=threads)))


def test_an_unknown_tone_map_is_named():
    with pytest.raises(InvalidSetting, match=r"tone_map: must be one of .*'filmic'"):
        display(np.zeros((1, 3), np.float32), "filmic")
