"""Light of a triangle, against a sum over small parts of it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from raysvc.jit import kernel
from raysvc.lighting.triangle_light_kernels import triangle_irradiance


@kernel
def evaluate(normal, corners, result):
    n = (normal[0], normal[1], normal[2])
    a = (corners[0, 0], corners[0, 1], corners[0, 2])
    b = (corners[1, 0], corners[1, 1], corners[1, 2])
    c = (corners[2, 0], corners[2, 1], corners[2, 2])
    result[0] = triangle_irradiance(n, a, b, c)


def irradiance(normal, corners):
    result = np.empty(1)
    evaluate(np.asarray(normal, float), np.asarray(corners, float), result)
    return result[0]


def summed(normal, corners, steps=400):
    u, v = (a.ravel() for a in np.meshgrid(*[(np.arange(steps) + 0.5) / steps] * 2))
    root = np.sqrt(u)
    weights = np.stack([1 - root, root * (1 - v), root * v], axis=1)
    places = weights @ corners
    across = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    distance = np.linalg.norm(places, axis=1)
    facing = np.abs(places @ across) / 2 / distance / len(places)
    return (np.maximum(places @ normal, 0) / distance * facing / distance**2).sum()


@settings(deadline=None, max_examples=60)
@given(st.integers(0, 2**32 - 1))
def test_it_is_the_sum_over_its_parts_also_across_the_horizon(seed):
    rng = np.random.default_rng(seed)
    normal = rng.normal(size=3)
    normal /= np.linalg.norm(normal)
    corners = rng.normal(size=(3, 3)) + rng.normal(size=3) * 2
    # Not so near that the sum is coarse
    across = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    if abs(corners[0] @ across) < 0.5 * np.linalg.norm(across):
        corners += across / np.linalg.norm(across)
    assert irradiance(normal, corners) == pytest.approx(summed(normal, corners), rel=0.02, abs=2e-4)


def test_an_endless_triangle_fills_the_hemisphere():
    corners = np.array([(1e9, 1, -1e9), (-1e9, 1, -1e9), (0, 1, 1e9)])
    assert irradiance((0, 1, 0), corners) == pytest.approx(np.pi, rel=1e-6)
    assert irradiance((0, -1, 0), corners) == 0


def test_a_triangle_that_is_a_line_gives_nothing():
    corners = np.array([(0, 1, 0), (1, 1, 0), (2, 1, 0)], float)
    assert irradiance((0, 1, 0), corners) == pytest.approx(0, abs=1e-12)
