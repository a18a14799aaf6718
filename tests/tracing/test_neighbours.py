"""What neighbours lend each other: on one surface, and not across edges."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from raysvc.tracing.neighbours import BESIDE, Neighbours
from raysvc.tracing.neighbours_kernels import Shown

UNWEIGHTED = np.ones((4, 3, 3), np.float32)


class Picture:
    """Values (H, W) at pixels that show one wall, or what `depth` and `normal` say."""

    def __init__(self, values, depth=None, normal=None):
        self.values = np.array(values, np.float32)
        self.shape = self.values.shape
        depth = np.ones(self.shape) if depth is None else np.broadcast_to(depth, self.shape)
        if normal is None:
            normal = np.zeros((*self.shape, 3))
            normal[..., 2] = 1
        shown = np.isfinite(depth).ravel()
        point_of = np.where(shown, np.cumsum(shown) - 1, -1).reshape(self.shape)
        self.pixel = np.flatnonzero(shown)
        self.depth = depth.ravel()[shown].astype(np.float32)
        self.normal = np.reshape(normal, (-1, 3))[shown].astype(np.float32)
        step = np.full(len(self.depth), 0.1, np.float32)
        self.neighbours = Neighbours(Shown(point_of, self.depth, self.normal, step))
        self.of_points = self.values.ravel()[shown][:, None]

    def means(self, weights=BESIDE):
        where = self.pixel, self.depth, self.normal
        found = self.neighbours.mean(self.of_points, weights, *where)
        picture = np.full(self.values.size, np.nan)
        picture[self.pixel] = found[:, 0]
        return picture.reshape(self.shape)

    def spans(self, reach):
        where = self.pixel, self.depth, self.normal
        return self.neighbours.span(self.of_points[:, 0], reach, *where).reshape(self.shape)


def test_a_point_takes_the_mean_of_the_pixels_about_it():
    values = np.arange(30.0).reshape(5, 6)
    assert Picture(values).means()[2, 3] == pytest.approx(values[1:4, 2:5].mean())
    assert Picture(values).means()[0, 0] == pytest.approx(values[:2, :2].mean())


def test_weights_go_by_distance_and_by_the_place_of_the_pixel():
    weights = np.zeros((4, 2, 2), np.float32)
    weights[0, 0, 0] = 1.0  # even row and column: itself
    weights[1, 0, 1] = 1.0  # odd column: its neighbours to the left and right
    weights[2, 1, 0] = 1.0  # odd row: those above and below
    weights[3, 1, 1] = 1.0  # both: those at the corners
    values = np.random.default_rng(1).random((6, 6))
    found = Picture(values).means(weights)
    assert found[2, 2] == pytest.approx(values[2, 2])
    assert found[2, 3] == pytest.approx((values[2, 2] + values[2, 4]) / 2)
    assert found[3, 2] == pytest.approx((values[2, 2] + values[4, 2]) / 2)
    assert found[3, 3] == pytest.approx(values[[2, 2, 4, 4], [2, 4, 2, 4]].mean())


def test_pixels_that_know_nothing_lend_nothing():
    known = np.full((4, 4), np.nan)
    known[0, 0] = 0.25
    found = Picture(known).means()
    assert found[1, 1] == pytest.approx(0.25)
    assert np.isnan(found[3, 3])


def test_a_step_in_depth_separates():
    values = np.array([[0, 0, 0, 1, 1, 1]] * 6, float)
    depth = np.where(values > 0, 5.0, 1.0)
    assert (Picture(values, depth).means(UNWEIGHTED) == values).all()


def test_a_crease_separates():
    values = np.array([[0, 0, 0, 1, 1, 1]] * 6, float)
    normal = np.zeros((6, 6, 3))
    normal[:, :3, 2] = 1
    normal[:, 3:, 0] = 1
    one = Picture(values, normal=normal)
    assert (one.means(UNWEIGHTED) == values).all()
    assert (one.spans(3) == 0).all()


def test_a_slope_does_not_separate():
    values = np.indices((6, 6)).sum(axis=0) % 2
    found = Picture(values, 1.0 + 0.05 * np.arange(6)).means()
    assert found[1:-1, 1:-1] == pytest.approx(np.full((4, 4), 0.5), abs=0.06)


def test_a_point_of_another_surface_than_all_about_it_gets_nothing():
    one = Picture(np.ones((4, 4)))
    pixel = np.array([5, 5, 5])
    depth = np.array([1.0, 9.0, 1.0], np.float32)
    normal = np.array([[0, 0, 1], [0, 0, 1], [1, 0, 0]], np.float32)
    found = one.neighbours.mean(one.of_points, BESIDE, pixel, depth, normal)[:, 0]
    assert found[0] == 1 and np.isnan(found[1:]).all()
    span = one.neighbours.span(one.of_points[:, 0], 1, pixel, depth, normal)
    assert span.tolist() == [0, -np.inf, -np.inf]


def test_the_background_lends_nothing():
    depth = np.array([[1.0, 1.0, np.inf, np.inf]] * 4)
    found = Picture(np.where(np.isfinite(depth), 1.0, 0.0), depth).means()
    assert (found[:, :2] == 1).all() and np.isnan(found[:, 2:]).all()


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 2**32 - 1), st.integers(1, 3))
def test_spans_are_those_of_a_slow_look_around(seed, reach):
    rng = np.random.default_rng(seed)
    values = rng.choice([0.0, 0.5, 1.0, np.nan], (7, 9), p=[0.5, 0.2, 0.2, 0.1])
    one = Picture(values)
    found, quick = one.spans(reach), one.neighbours.differs(one.of_points[:, 0], reach, 0.25)
    for row in range(7):
        for col in range(9):
            window = values[max(row - reach, 0) : row + reach + 1]
            window = window[:, max(col - reach, 0) : col + reach + 1]
            known = window[~np.isnan(window)]
            expected = np.ptp(known) if len(known) else -np.inf
            assert found[row, col] == expected
            assert quick[row * 9 + col] == (expected > 0.25)


def test_pixels_in_front_are_those_that_are_shown():
    point_of = np.array([[2, -1], [0, 0]])
    shown = Shown(point_of, np.ones(4, "f4"), np.ones((4, 3), "f4"), np.ones(4, "f4"))
    assert Neighbours(shown).is_shown().tolist() == [True, False, True, False]
    assert Neighbours(shown).width == 2
