"""Spreading against its slow twin, and what must hold for every picture."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from raysvc.errors import Cancelled, InvalidInput
from raysvc.lens.slices import sliced, square_side_px
from raysvc.lens.spread import LARGEST_VALUE, spread
from raysvc.lens.squares import Squares, planes
from raysvc.parallel import Control
from tests.oracles import spread as slow

SEEDS = st.integers(0, 2**32 - 1)


def random_picture(rng, height=24, width=33, opaque=True):
    rgba = (rng.random((height, width, 4)) ** 6 * 50).astype(np.float32)
    rgba[..., 3] = 1 if opaque else rng.random((height, width))
    return rgba


def random_coc(rng, height=24, width=33, largest=20.0):
    return rng.uniform(-largest, largest, (height, width)).astype(np.float32)


@settings(deadline=None, max_examples=25)
@given(SEEDS, st.floats(1.0, 120.0), st.booleans())
def test_a_slice_equals_squares_drawn_pixel_by_pixel(seed, largest, opaque):
    rng = np.random.default_rng(seed)
    rgba, coc = random_picture(rng, opaque=opaque), random_coc(rng, largest=largest)
    side = np.maximum(square_side_px(coc), 1)
    membership = rng.random(side.shape).astype(np.float32)
    values = planes(rgba)
    fast = Squares(values, side, Control(threads=1)).spread(membership)
    expected = slow.splat(values.astype(float), membership, side.astype(float))
    assert np.abs(fast - expected).max() <= 1e-5 * max(1.0, expected.max())


@settings(deadline=None, max_examples=25)
@given(SEEDS, st.booleans())
def test_the_picture_behind_the_focus_equals_its_slow_twin(seed, opaque):
    rng = np.random.default_rng(seed)
    rgba, coc = random_picture(rng, opaque=opaque), np.abs(random_coc(rng))
    expected = slow.spread(rgba.astype(float), coc)
    assert np.abs(spread(rgba, coc) - expected).max() <= 1e-5 * max(1.0, expected.max())


def test_a_second_slice_does_not_see_the_first(rng):
    side = np.maximum(square_side_px(random_coc(rng)), 1)
    membership = rng.random(side.shape).astype(np.float32)
    squares = Squares(planes(random_picture(rng)), side, Control(threads=2))
    first = squares.spread(membership).copy()
    squares.spread(1 - membership)
    assert np.array_equal(squares.spread(membership), first)


@settings(deadline=None, max_examples=50)
@given(SEEDS, st.floats(1.0, 500.0))
def test_a_slice_keeps_the_total_light(seed, largest):
    rng = np.random.default_rng(seed)
    values = planes(random_picture(rng))
    side = np.maximum(square_side_px(random_coc(rng, largest=largest)), 1)
    sums = Squares(values, side, Control(threads=1)).spread(np.ones_like(side))
    before, after = (array.sum(axis=(1, 2), dtype=float) for array in (values, sums))
    assert after == pytest.approx(before, rel=1e-6)


@pytest.mark.parametrize("diameter", [-30.0, -3.0, 1.5, 8.0, 25.0])
def test_one_blur_everywhere_keeps_the_total_light(diameter, rng):
    rgba = random_picture(rng)
    blurred = spread(rgba, np.full(rgba.shape[:2], diameter, np.float32))
    before, after = (array.sum(axis=(0, 1), dtype=float) for array in (rgba, blurred))
    assert after == pytest.approx(before, rel=1e-6)


@settings(deadline=None, max_examples=25)
@given(SEEDS, st.floats(0.5, 200.0))
def test_a_constant_picture_stays_constant_up_to_its_border(seed, largest):
    rng = np.random.default_rng(seed)
    colour = np.append(rng.random(3) * 10, 1).astype(np.float32)
    coc = random_coc(rng, largest=largest)
    blurred = spread(np.broadcast_to(colour, (*coc.shape, 4)).copy(), coc)
    assert np.allclose(blurred, colour, rtol=2e-6)


@settings(deadline=None, max_examples=25)
@given(SEEDS)
def test_blurring_is_linear_in_the_picture(seed):
    rng = np.random.default_rng(seed)
    first, second = (random_picture(rng, opaque=False) for _ in range(2))
    coc = random_coc(rng)
    together = spread(first + 2 * second, coc)
    assert np.allclose(together, spread(first, coc) + 2 * spread(second, coc), rtol=1e-5, atol=1e-5)


@settings(deadline=None, max_examples=25)
@given(SEEDS)
def test_mirroring_the_picture_mirrors_the_blur(seed):
    rng = np.random.default_rng(seed)
    # Sides that halve evenly: the fill's pyramid is then symmetric as well.
    rgba, coc = random_picture(rng, 32, 32), random_coc(rng, 32, 32)
    mirrored = spread(np.ascontiguousarray(rgba[:, ::-1]), np.ascontiguousarray(coc[:, ::-1]))
    assert np.allclose(mirrored[:, ::-1], spread(rgba, coc), rtol=1e-5, atol=1e-5)


@pytest.mark.parametrize("threads", [2, 5])
@pytest.mark.parametrize("opaque", [True, False])
def test_the_bits_do_not_depend_on_the_number_of_threads(threads, opaque, rng):
    rgba, coc = random_picture(rng, 90, 120, opaque), random_coc(rng, 90, 120, 60.0)
    one = spread(rgba, coc, Control(threads=1))
    assert np.array_equal(one, spread(rgba, coc, Control(threads=threads)))


def test_nothing_out_of_focus_returns_the_picture_itself(rng):
    rgba = random_picture(rng)
    assert spread(rgba, np.zeros(rgba.shape[:2], np.float32)) is rgba


def test_sharp_pixels_keep_their_bits_beside_a_blurred_background(rng):
    rgba = random_picture(rng)
    coc = np.where(rng.random(rgba.shape[:2]) < 0.5, 0.8, 18.0).astype(np.float32)
    blurred = spread(rgba, coc)
    assert np.array_equal(blurred[coc < 1], rgba[coc < 1])
    assert not np.array_equal(blurred, rgba)


def test_sharp_pixels_out_of_reach_of_the_foreground_keep_their_bits(rng):
    rgba = random_picture(rng, 40, 40)
    coc = np.zeros((40, 40), np.float32)
    coc[:, :5] = -10.0
    blurred = spread(rgba, coc)
    assert np.array_equal(blurred[:, 10:], rgba[:, 10:])
    assert not np.array_equal(blurred[:, 5:9], rgba[:, 5:9])


def test_a_blurred_foreground_spreads_half_across_its_silhouette():
    rgba = np.zeros((64, 64, 4), np.float32)
    rgba[..., 3] = 1
    rgba[:, :32, 0] = 1.0
    coc = np.zeros((64, 64), np.float32)
    coc[:, :32] = -16 / (np.sqrt(3) / 2)
    edge = spread(rgba, coc)[32, :, 0]
    expected = np.clip(0.5 - (np.arange(64) + 0.5 - 32) / 16, 0, 1)
    assert np.abs(edge - expected).max() < 0.04


def test_a_blurred_background_is_whole_up_to_a_sharp_silhouette():
    rgba = np.zeros((64, 64, 4), np.float32)
    rgba[..., 3] = 1
    rgba[:, :32, 0] = 1.0
    rgba[:, 32:, 1] = 1.0
    coc = np.where(np.arange(64) < 32, 0.0, 20.0) * np.ones((64, 1))
    blurred = spread(rgba, coc.astype(np.float32))
    assert np.array_equal(blurred[:, :32], rgba[:, :32])
    assert np.allclose(blurred[:, 32:], rgba[:, 32:], atol=1e-6)


def test_a_point_becomes_a_square_of_equal_variance():
    rgba = np.zeros((65, 65, 4), np.float32)
    rgba[32, 32] = 1.0
    diameter = 24.0
    blurred = spread(rgba, np.full((65, 65), diameter, np.float32))[..., 0].astype(float)
    offset = np.arange(65) - 32.0
    variance = (blurred.sum(axis=0) * offset**2).sum() / blurred.sum()
    # A disc's is diameter^2 / 16; pixels as wide as 1 add the fractions of the two edges.
    assert variance == pytest.approx(diameter**2 / 16, rel=0.01)


def test_a_blur_larger_than_the_picture_is_finite_and_keeps_the_light(rng):
    rgba = random_picture(rng, 16, 40)
    blurred = spread(rgba, np.full((16, 40), -1e6, np.float32))
    assert blurred.sum(dtype=float) == pytest.approx(rgba.sum(dtype=float), rel=1e-6)


def test_a_huge_highlight_leaves_no_streak():
    rgba = np.zeros((80, 80, 4), np.float32)
    rgba[40, 40, :3] = 1e9
    blurred = spread(rgba, np.full((80, 80), 11.3, np.float32))
    outside = np.ones((80, 80), bool)
    outside[33:48, 33:48] = False
    assert np.all(blurred[outside] == 0)


def test_what_is_not_finite_is_limited_with_a_warning(rng):
    rgba = random_picture(rng)
    rgba[3, 4, 0], rgba[5, 6, 1] = np.nan, np.inf
    warnings = []
    blurred = spread(rgba, np.full(rgba.shape[:2], 5.0, np.float32), warnings=warnings)
    assert np.isfinite(blurred).all() and blurred.max() <= LARGEST_VALUE
    assert len(warnings) == 1 and "2 pixels" in warnings[0]


def test_memberships_of_a_pixel_sum_to_one(rng):
    coc = random_coc(rng, largest=60.0)
    slices = sliced(coc, square_side_px(coc))
    total = slices.far + slices.behind + slices.near + slices.sharp
    assert np.allclose(total, 1, atol=1e-6)


def test_shapes_that_do_not_match_are_refused(rng):
    with pytest.raises(InvalidInput, match="coc_px"):
        spread(random_picture(rng), np.zeros((3, 3), np.float32))


def test_an_undefined_circle_of_confusion_is_refused(rng):
    rgba = random_picture(rng)
    with pytest.raises(InvalidInput, match="coc_px: must be finite"):
        spread(rgba, np.full(rgba.shape[:2], np.nan, np.float32))


def test_a_cancelled_control_stops_it(rng):
    rgba, control = random_picture(rng), Control(threads=1)
    control.cancel()
    with pytest.raises(Cancelled):
        spread(rgba, random_coc(rng), control)
