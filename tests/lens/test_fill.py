"""Holes are filled from around them."""

import numpy as np

from raysvc.lens.fill import fill_holes


def test_what_is_known_keeps_its_bits_and_holes_stay_within_its_range(rng):
    picture = rng.random((37, 50, 4)).astype(np.float32)
    known = (rng.random((37, 50)) < 0.3).astype(np.float32)
    filled = picture.copy()
    assert fill_holes(filled, known)
    assert np.array_equal(filled[known == 1], picture[known == 1])
    seen = picture[known == 1]
    assert np.all(filled >= seen.min(axis=0) - 1e-6) and np.all(filled <= seen.max(axis=0) + 1e-6)


def test_a_hole_between_two_colours_blends_from_one_to_the_other():
    picture = np.zeros((64, 64, 1), np.float32)
    picture[:, 40:] = 1.0
    known = np.ones((64, 64), np.float32)
    known[:, 24:40] = 0.0
    fill_holes(picture, known)
    row = picture[32, 24:40, 0]
    assert np.all(np.diff(row) >= 0)
    assert row[0] < 0.2 and row[-1] > 0.8


def test_nothing_known_changes_nothing():
    picture = np.full((5, 9, 4), 3.0, np.float32)
    assert not fill_holes(picture, np.zeros((5, 9), np.float32))
    assert np.all(picture == 3.0)
