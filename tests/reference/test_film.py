"""Means of samples, whatever the order in which they arrive."""

import numpy as np

from raysvc.reference.film import Film


def test_the_mean_is_that_of_all_samples(rng):
    samples = rng.exponential(size=(6, 40, 4)).astype(np.float32)
    film = Film(6)
    film.add(0, 6, samples[:, :16])
    film.add(0, 2, samples[:2, 16:])
    film.add(2, 6, samples[2:, 16:])
    np.testing.assert_allclose(film.mean(), samples.mean(axis=1, dtype=float), rtol=1e-6)


def test_a_faint_pixel_beside_a_glaring_sample_keeps_its_digits():
    film = Film(1)
    for value in (1e6, *([1e-3] * 1000)):
        film.add(0, 1, np.full((1, 1, 4), value, np.float32))
    np.testing.assert_allclose(film.mean()[0, 0] * 1001 - 1e6, 1.0, atol=0.2)
