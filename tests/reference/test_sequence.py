"""Random numbers: nets, their own for each pixel, dimension and seed; against a loop over bits."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from raysvc.reference import sequence_kernels as sequence
from raysvc.reference.sequence_kernels import pairs, pixel_keys
from tests.oracles.sobol import nested_uniform_scramble, reversed_word, second_sobol_dimension

WORDS = st.integers(0, 2**32 - 1)


def points(key, dimension, count, first=0):
    index = np.arange(first, first + count, dtype=np.uint32)
    found = np.empty((count, 2))
    pairs(np.full(count, key, np.uint32), dimension, index, found)
    return found


@settings(deadline=None)
@given(WORDS)
def test_bits_are_reversed(word):
    assert int(sequence.reversed_bits(word)) == reversed_word(word)


@settings(deadline=None)
@given(WORDS)
def test_the_second_dimension_is_that_of_its_direction_numbers(index):
    assert int(sequence.reversed_bits(sequence._pascal(index))) == second_sobol_dimension(index)


@settings(deadline=None)
@given(WORDS, WORDS)
def test_a_scramble_flips_each_bit_by_those_above_it(word, seed):
    def scrambled(x):
        return int(sequence.reversed_bits(sequence._permuted(sequence.reversed_bits(x), seed)))

    assert nested_uniform_scramble(word, scrambled) == scrambled(word)


@settings(deadline=None, max_examples=30)
@given(WORDS, st.integers(0, 60), st.integers(0, 8))
def test_every_binary_cut_of_the_square_holds_one_point_in_each_part(key, dimension, power):
    count = 2**power
    found = points(key, dimension, count)
    assert ((found >= 0) & (found < 1)).all()
    for columns in (2**k for k in range(power + 1)):
        parts = np.histogram2d(*found.T, [columns, count // columns], [[0, 1], [0, 1]])[0]
        assert (parts == 1).all()


def test_the_next_points_complete_the_net():
    both = points(5, 2, 256)
    np.testing.assert_array_equal(both[128:], points(5, 2, 128, first=128))


def test_pixels_dimensions_and_seeds_have_points_of_their_own():
    keys = np.empty(3000, np.uint32)
    pixel_keys(np.arange(3000, dtype=np.uint32), 0, keys)
    other = np.empty(3000, np.uint32)
    pixel_keys(np.arange(3000, dtype=np.uint32), 1, other)
    assert len(np.unique(np.concatenate([keys, other]))) == 6000
    sample = np.full(3000, 7, np.uint32)
    found = np.empty((3, 3000, 2))
    for number, (key, dimension) in enumerate([(keys, 0), (keys, 1), (other, 0)]):
        pairs(key, dimension, sample, found[number])
    columns = found.transpose(0, 2, 1).reshape(6, -1)
    correlation = np.corrcoef(columns) - np.eye(6)
    assert np.abs(correlation).max() < 0.08
    for column in columns:
        assert column.mean() == pytest.approx(0.5, abs=0.025)
        assert column.var() == pytest.approx(1 / 12, rel=0.08)


def test_an_integral_converges_faster_than_with_independent_numbers(rng):
    def error(samples):
        return abs((np.sin(3 * samples[:, 0]) * samples[:, 1] ** 2).mean() - exact)

    exact = (1 - np.cos(3)) / 9
    spread = np.sqrt(np.mean([error(points(k, 0, 256)) ** 2 for k in range(40)]))
    independent = np.sqrt(np.mean([error(rng.random((256, 2))) ** 2 for _ in range(40)]))
    assert spread < 0.05 * independent
