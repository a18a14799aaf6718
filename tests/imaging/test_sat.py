"""Summed-area tables against sums texel by texel."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from raysvc.imaging.sat import box_sums, summed_area_table
from tests.oracles.box_sum import box_sum

IMAGES = st.tuples(st.integers(1, 7), st.integers(1, 9), st.integers(1, 4)).flatmap(
    lambda shape: arrays.arrays(
        np.float32, shape, elements=st.floats(0, 1000, width=32, allow_subnormal=False)
    )
)
EDGE = st.floats(-2, 11)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_table_equals_two_cumulative_sums(rng, dtype):
    image = rng.random((13, 29, 3)).astype(dtype)
    table = summed_area_table(image)
    assert table.dtype == np.float64
    assert not table[0].any() and not table[:, 0].any()
    expected = image.astype(np.float64).cumsum(0).cumsum(1)
    np.testing.assert_allclose(table[1:, 1:], expected, rtol=1e-14)


@settings(deadline=None)
@given(IMAGES, EDGE, EDGE, EDGE, EDGE)
def test_a_fractional_box_sums_the_covered_parts_of_texels(image, a, b, c, d):
    top, bottom = sorted((a, b))
    left, right = sorted((c, d))
    got = box_sums(summed_area_table(image), np.array([[top, left, bottom, right]]))[0]
    expected = box_sum(image, top, left, bottom, right)
    np.testing.assert_allclose(got, expected, rtol=1e-10, atol=1e-9)


def test_boxes_that_tile_the_image_sum_to_the_whole(rng):
    image = rng.random((16, 32, 3)).astype(np.float32)
    rows = np.sort(np.r_[0, rng.random(5) * 16, 16])
    columns = np.sort(np.r_[0, rng.random(5) * 32, 32])
    boxes = [(rows[i], columns[j], rows[i + 1], columns[j + 1]) for i in range(6) for j in range(6)]
    total = box_sums(summed_area_table(image), np.array(boxes)).sum(0)
    np.testing.assert_allclose(total, image.sum((0, 1), dtype=np.float64), rtol=1e-12)


def test_one_bright_texel_does_not_spoil_dim_boxes_far_from_it(rng):
    image = rng.random((64, 64, 1)).astype(np.float32)
    image[3, 3] = 1e5
    boxes = np.array([[40.0, 40.0, 42.0, 42.0]])
    got = box_sums(summed_area_table(image), boxes)[0]
    np.testing.assert_allclose(got, image[40:42, 40:42].sum((0, 1)), rtol=1e-6)
