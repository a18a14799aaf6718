"""B-spline filters out of tables of order 1 to 3, against sums texel by texel and exact sums."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from raysvc.errors import InvalidSetting
from raysvc.imaging import sat_orders
from raysvc.imaging.sat import build_table, summed_area_table
from raysvc.imaging.sat_builders import BUILDERS
from raysvc.imaging.sat_orders import ORDERS, build_integrated, integrated, spline_means
from raysvc.parallel import Control
from tests.oracles.spline_mean import reach, spline_mean, weights
from tests.oracles.wrapping_sums import spline_sum

SIDES = st.tuples(st.integers(1, 7), st.integers(1, 7))
IMAGES = SIDES.flatmap(
    lambda sides: arrays.arrays(
        np.float32, (*sides, 3), elements=st.floats(-100, 1000, width=32, allow_subnormal=False)
    )
)
GRID = st.integers(0, 2**28).map(lambda n: n / 2**20)
PLACE, HALF = st.floats(-30, 30), st.floats(0.5, 12)
EVERY = pytest.mark.parametrize("order", ORDERS)
SAMPLED = {1: [1.0], 2: [0.5, 0.5], 3: [1 / 6, 4 / 6, 1 / 6]}
"""B-splines of unit boxes at whole numbers."""


@EVERY
@settings(deadline=None, max_examples=60)
@given(image=IMAGES, filters=st.tuples(PLACE, PLACE, HALF, HALF))
def test_any_place_and_width_is_exact_for_constant_texels(order, image, filters):
    (mean,) = spline_means(integrated(image, order), order, np.array([filters]))
    expected = spline_mean(image.astype(np.float64), order, *filters)
    np.testing.assert_allclose(mean, expected, rtol=1e-10, atol=1e-9)


@EVERY
@settings(deadline=None, max_examples=60)
@given(
    image=SIDES.flatmap(lambda sides: arrays.arrays(np.float64, (*sides, 3), elements=GRID)),
    end=st.tuples(st.integers(-20, 20), st.integers(-20, 20)),
    wide=st.tuples(st.integers(1, 9), st.integers(1, 9)),
)
def test_whole_widths_equal_integer_sums_that_wrap(order, image, end, wide):
    rows, columns = image.shape[:2]
    expected = sum(
        a * b * spline_sum(image, order, ((end[0] - i) % rows, (end[1] - j) % columns), wide)
        for i, a in enumerate(SAMPLED[order], 1)
        for j, b in enumerate(SAMPLED[order], 1)
    ) / (wide[0] * wide[1]) ** float(order)
    centre = [end[axis] - 0.5 * order * wide[axis] for axis in (0, 1)]
    filters = np.array([[*centre, 0.5 * wide[0], 0.5 * wide[1]]])
    (mean,) = spline_means(integrated(image, order), order, filters)
    np.testing.assert_allclose(mean, expected, rtol=1e-10, atol=1e-9)


def test_integer_sums_are_right_though_they_wrap():
    image = np.full((1, 7, 1), 2.0**36)
    image[0, 3] = 0.0
    sums = np.tile(image, (1, 4, 1)) * 2.0**20
    for _ in range(3):
        sums = sums.cumsum(1)
    assert sums.max() > 2.0**64
    kernel = np.convolve(np.convolve([1, 1, 1], [1, 1, 1]), [1, 1, 1])
    expected = sum(weight * image[0, (5 - k) % 7, 0] for k, weight in enumerate(kernel))
    assert spline_sum(image, 3, (0, 5), (1, 3))[0] == expected


@EVERY
def test_a_constant_image_stays_as_it_is(order, rng):
    image = np.full((16, 24, 3), [0.25, 3.0, 70.0])
    filters = np.c_[rng.uniform(-40, 40, (50, 2)), rng.uniform(0.5, 30, (50, 2))]
    means = spline_means(integrated(image, order), order, filters)
    np.testing.assert_allclose(means, np.tile(image[0, 0], (50, 1)), rtol=1e-12)


@EVERY
@pytest.mark.parametrize("place", [(0.0, 0.0), (7.0, 9.0), (-1e-18, 9.0), (-7.0, 1e-18), (3.5, 9)])
def test_filters_at_and_over_the_edge_see_the_image_repeated(order, place, rng):
    image = rng.random((7, 9, 3))
    table = integrated(image, order)
    (mean,) = spline_means(table, order, np.array([[*place, 1.3, 2.7]]))
    expected = spline_mean(image, order, *place, 1.3, 2.7)
    np.testing.assert_allclose(mean, expected, rtol=1e-12)
    (again,) = spline_means(table, order, np.array([[place[0] - 21, place[1] + 18, 1.3, 2.7]]))
    np.testing.assert_allclose(again, expected, rtol=1e-12)


@EVERY
def test_a_point_spreads_as_wide_as_that_many_boxes(order):
    image = np.zeros((64, 64, 3))
    image[32, 32] = 1.0
    off = np.arange(-16.0, 16.0, 0.125) + 0.0625
    filters = np.column_stack([np.full_like(off, 32.5), off + 32.5, *np.full((2, 256), 3.5)])
    seen = spline_means(integrated(image, order), order, filters)[:, 0]
    # A texel is itself a box
    np.testing.assert_array_equal(seen > 1e-9, np.abs(off) < (7 * order + 1) / 2)
    variance = (seen * off**2).sum() / seen.sum()
    assert variance == pytest.approx((order * 7**2 + 1) / 12, rel=1e-3)


@EVERY
def test_the_sun_does_not_spoil_dim_filters_far_from_it(order, rng):
    image = rng.random((128, 256, 3)).astype(np.float32)
    image[20:22, 200:202] = 5e4
    table = integrated(image, order)
    filters = np.c_[rng.uniform(60, 90, 40), rng.uniform(40, 120, 40), np.full((40, 2), 2.0)]
    exact = [spline_mean(image.astype(np.float64), order, *each) for each in filters]
    error = np.abs(spline_means(table, order, filters) - exact).max()
    assert error < {1: 1e-9, 2: 1e-8, 3: 1e-6}[order]


@pytest.mark.parametrize("order", [2, 3])
def test_integration_without_means_keeps_tables_small(order, rng):
    image = rng.random((64, 64, 3)) + 10.0
    plain = image
    for _ in range(order):
        plain = plain.cumsum(0).cumsum(1)
    assert np.abs(integrated(image, order)).max() < 1e-3 * plain.max()


@pytest.mark.parametrize("order", [2, 3])
def test_the_rest_has_mean_zero_in_every_row_and_column(order, rng):
    image = rng.random((12, 20, 3))
    table = integrated(image, order)
    rest = table[order:-1, order:-1]
    assert rest.shape == image.shape
    assert np.abs(rest.mean(0)).max() < 1e-12 and np.abs(rest.mean(1)).max() < 1e-12
    np.testing.assert_allclose(table[-1, -1], image.mean((0, 1)), rtol=1e-14)


def test_order_one_is_a_plain_table(rng):
    image = rng.random((12, 20, 3)).astype(np.float32)
    np.testing.assert_array_equal(integrated(image, 1), summed_area_table(image))


@EVERY
@pytest.mark.parametrize("builder", BUILDERS)
def test_all_builders_make_the_tables_of_every_order(order, builder, rng):
    image = rng.lognormal(0.0, 2.0, (100, 150, 3))
    built = build_integrated(image, order, builder=builder)
    expected = integrated(image, order)
    np.testing.assert_allclose(built.table, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    assert built.passes == order * build_table(image, builder).passes


@EVERY
def test_tables_and_means_have_the_same_bits_with_any_number_of_threads(order, rng, monkeypatch):
    for name in ("CHUNK_ROWS", "CHUNK_VALUES", "CHUNK_LOOKUPS"):
        monkeypatch.setattr(sat_orders, name, 5)
    image = rng.lognormal(0, 3, (33, 47, 3))
    filters = rng.uniform(1, 40, (60, 4))
    found = set()
    for threads in (1, 2, 5):
        table = integrated(image, order, Control(threads))
        means = spline_means(table, order, filters, Control(threads))
        found.add((table.tobytes(), means.tobytes()))
    assert len(found) == 1


def test_images_are_left_as_they_were(rng):
    image = rng.random((6, 7, 3))
    before = image.copy()
    integrated(image, 3)
    np.testing.assert_array_equal(image, before)


@EVERY
@pytest.mark.parametrize("half", [0.5, 1.7, 6.0])
def test_weights_of_the_oracle_are_a_whole(order, half):
    assert sum(weights(5, order, 1.3, half)) == pytest.approx(1.0, abs=1e-14)
    assert reach(order, 0.0) == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("asked", "complaint"),
    [
        ({"order": 4}, "order: must be 1, 2 or 3, is 4"),
        ({"image": np.zeros((4, 5, 1))}, "image: must be (height, width, 3), is (4, 5, 1)"),
        ({"image": np.zeros((0, 5, 3)), "order": 2}, "image: must be"),
    ],
)
def test_what_cannot_be_integrated_is_refused_by_name(asked, complaint):
    with pytest.raises(InvalidSetting) as refused:
        integrated(**{"image": np.zeros((4, 5, 3)), "order": 1, **asked})
    assert str(refused.value).startswith(complaint)


@pytest.mark.parametrize("bad", [[[1, 2, 3]], [[1, 2, 3, 0]], [[1, 2, -1, 3]], [[np.nan, 2, 3, 4]]])
def test_filters_that_are_none_are_refused_by_name(bad):
    with pytest.raises(InvalidSetting, match="filters: must be"):
        spline_means(np.zeros((5, 6, 3)), 1, np.array(bad, float))
