"""Records: tuples of arrays, joined, chosen from and cut, whatever they hold."""

from typing import NamedTuple

import numpy as np

from raysvc import records


class Inner(NamedTuple):
    x: np.ndarray


class Outer(NamedTuple):
    a: np.ndarray
    inner: Inner


def outer(count, start=0):
    numbers = np.arange(start, start + count)
    return Outer(numbers, Inner(np.stack([numbers, -numbers], axis=1)))


def test_rows_of_all_arrays_stay_together():
    whole = records.joined([outer(3), outer(2, 3)])
    assert whole.a.tolist() == [0, 1, 2, 3, 4]
    some = records.chosen(whole, np.array([4, 1]))
    assert some.a.tolist() == [4, 1] and some.inner.x.tolist() == [[4, -4], [1, -1]]
    assert isinstance(some, Outer) and isinstance(some.inner, Inner)
    masked = records.chosen(whole, whole.a > 2)
    assert masked.inner.x[:, 0].tolist() == [3, 4]


def test_a_cut_is_a_view():
    whole = outer(5)
    part = records.rows(whole, 1, 3)
    assert part.inner.x[:, 0].tolist() == [1, 2]
    assert np.shares_memory(part.a, whole.a) and np.shares_memory(part.inner.x, whole.inner.x)
