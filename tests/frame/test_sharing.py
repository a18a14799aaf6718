"""Samples of a pixel that show one triangle are one group."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from raysvc.frame.sharing_kernels import share_by_triangle


@given(st.lists(st.tuples(st.integers(0, 5), st.integers(0, 3)), max_size=40))
def test_hits_share_a_number_just_if_pixel_and_triangle_are_theirs(hits):
    place = np.array([p for p, _ in hits], np.int64)
    triangle = np.array([t for _, t in hits], np.int32)
    newest, older = np.full(6, -1, np.int64), np.empty(len(hits), np.int64)
    shared = np.empty(len(hits), np.int64)
    count = share_by_triangle(place, triangle, newest, older, shared)
    number = {}
    for hit in hits:
        number.setdefault(hit, len(number))
    assert count == len(number)
    assert shared.tolist() == [number[hit] for hit in hits]
