"""Slices: every point belongs somewhere, wholly, and in the order of depth."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from raysvc.lens.points import LensPoints
from raysvc.lens.slices import FADE, SHARP_PX, slices_for
from raysvc.lens.sorting import levels_for, sort
from raysvc.parallel import Control
from tests.lens.pictures import random_coc, random_picture

SIDES = st.floats(0.0, 2000.0)
LAYERS = st.none() | st.integers(1, 16)


def nearest_of(slices, coc_px):
    """The nearer one of the slices that each point is in."""
    return np.searchsorted(slices.fade_end, coc_px, side="right")


@given(SIDES, SIDES, LAYERS)
def test_bounds_ascend_and_the_sharp_slice_is_that_of_the_focus(near, far, layers):
    slices = slices_for(-near, far, layers)
    assert np.all(np.diff(slices.fade_end) >= 0) and np.all(np.diff(slices.fade_begin) >= 0)
    assert np.all(slices.fade_begin <= slices.fade_end)
    assert nearest_of(slices, np.float32([0.0]))[0] == slices.sharp
    assert nearest_of(slices, np.float32([-near * 1.01 - 2]))[0] == 0


@given(st.floats(2.0, 2000.0), st.floats(2.0, 2000.0), st.integers(2, 16))
def test_there_are_as_many_slices_out_of_focus_as_asked_for(near, far, layers):
    assert slices_for(-near, far, layers).count == layers + 1


def test_one_layer_still_tells_before_from_behind():
    assert slices_for(-10, 10, 1).count == 3
    assert slices_for(0, 10, 1).count == 2
    assert slices_for(0, 0, 5).count == 1


def test_by_default_blurs_of_a_slice_are_alike():
    slices = slices_for(-100.0, 100.0)
    ends = np.abs(slices.fade_end[slices.fade_end > SHARP_PX])
    assert np.allclose(ends[1:] / ends[:-1], 2)
    assert ends[0] == pytest.approx(4 * FADE)


def test_what_is_beyond_a_point_shares_no_slice_with_it(rng):
    slices = slices_for(-70.0, 90.0)
    coc = rng.uniform(-70, 90, 400).astype(np.float32)
    beyond = slices.beyond(coc)
    first, bound = nearest_of(slices, coc), nearest_of(slices, beyond)
    partly = (first < slices.count - 1) & (
        coc > np.append(slices.fade_begin, np.inf).astype(np.float32)[first]
    )
    assert np.all((bound == first + 1 + partly) | np.isinf(beyond))
    assert np.all(beyond[np.isinf(beyond)] > 0)


@pytest.mark.parametrize("layers", [None, 3])
def test_memberships_of_a_point_sum_to_one(layers, rng):
    rgba, coc = random_picture(rng, 30, 40), random_coc(rng, 30, 40, 70.0)
    points = LensPoints.of_picture(rgba, coc)
    slices = slices_for(-70.0, 70.0, layers)
    found = sort(points, slices, Control(threads=1))
    total = found.focus[..., 4].sum(dtype=float)
    colour = found.focus[..., :4].sum(axis=(0, 1), dtype=float)
    for (_, _, level), sources in found.sources.items():
        for begin, end in zip(sources.begin, sources.end, strict=True):
            # What stands for a block of pixels has their mean; those at the border have fewer.
            block = 4.0**level
            total += block * sources.values[begin:end, 4].sum(dtype=float)
            colour += block * sources.values[begin:end, :4].sum(axis=0, dtype=float)
    assert len({level for _, _, level in found.sources}) > 1
    assert total == pytest.approx(30 * 40, rel=1e-2 if levels_for(70.0) > 2 else 1e-6)
    assert colour == pytest.approx(rgba.sum(axis=(0, 1), dtype=float), rel=0.03)


def test_nothing_is_added_behind_what_covers_the_same_slice():
    one = LensPoints.of_picture(np.ones((8, 8, 4), np.float32), np.full((8, 8), 10.0, np.float32))
    found = sort(one.behind(one), slices_for(0.0, 10.0), Control(threads=1))
    alone = sort(one, slices_for(0.0, 10.0), Control(threads=1))
    assert found.sources.keys() == alone.sources.keys()
    for key, sources in found.sources.items():
        assert np.array_equal(sources.values, alone.sources[key].values)
