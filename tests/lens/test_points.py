"""Points of two lists as one."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from raysvc.lens.points import LensPoints

PIXELS = st.lists(st.integers(0, 11), max_size=20).map(sorted)


def points(pixel: list[int], value: float) -> LensPoints:
    number = np.arange(len(pixel), dtype=np.float32) + value
    return LensPoints(
        (3, 4), np.array(pixel, np.int64), number, np.tile(number[:, None], 4), number
    )


@settings(deadline=None)
@given(PIXELS, PIXELS)
def test_others_are_put_behind_those_of_the_same_pixel(mine: list[int], hidden: list[int]) -> None:
    found = points(mine, 0.0).behind(points(hidden, 100.0))
    rows = [(p, n) for n, p in enumerate(mine)] + [(p, 100 + n) for n, p in enumerate(hidden)]
    expected = sorted(rows)
    assert found.pixel.tolist() == [pixel for pixel, _ in expected]
    for values in (found.coc_px, found.cover, found.rgba[:, 2]):
        assert values.tolist() == [number for _, number in expected]
