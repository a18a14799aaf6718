"""The folded-out octahedron: a round trip, and borders that go on with what they meet."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from raysvc.geometry.octahedral_kernels import octahedral_direction, octahedral_place

PLACE = st.floats(0.001, 0.999)


@given(PLACE, PLACE)
def test_places_and_directions_are_each_others_inverse(u, v):
    x, y, z = octahedral_direction(u, v)
    assert x * x + y * y + z * z == pytest.approx(1.0)
    assert octahedral_place(3.0 * x, 3.0 * y, 3.0 * z) == pytest.approx((u, v), abs=1e-9)


@given(PLACE)
def test_beyond_an_edge_lies_what_the_edge_meets(t):
    step = 1e-5
    for inside, outside in (
        ((step, t), (-step, t)),
        ((1 - step, t), (1 + step, t)),
        ((t, step), (t, -step)),
        ((t, 1 - step), (t, 1 + step)),
    ):
        apart = np.subtract(octahedral_direction(*inside), octahedral_direction(*outside))
        assert np.abs(apart).max() < 20 * step


@pytest.mark.parametrize(
    ("place", "direction"),
    [
        ((0.5, 0.5), (0, 1, 0)),
        ((0, 0), (0, -1, 0)),
        ((1, 0), (0, -1, 0)),
        ((1, 0.5), (1, 0, 0)),
        ((0.5, 1), (0, 0, 1)),
        ((-0.1, -0.1), octahedral_direction(0.9, 0.9)),
    ],
)
def test_corners_and_middles(place, direction):
    np.testing.assert_allclose(octahedral_direction(*place), direction, atol=1e-12)
