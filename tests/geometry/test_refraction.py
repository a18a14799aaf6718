"""Snell's law."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from raysvc.geometry.refraction import refracted, transmitted_cosine
from tests.lighting.surfaces import random_directions, views_of

INDICES = st.floats(1.0, 3.0)
NORMAL = (0.0, 0.0, 1.0)


@settings(deadline=None)
@given(INDICES, st.floats(0.0, 0.4999 * math.pi))
def test_sines_are_in_the_ratio_of_the_indices(ior, angle):
    light, cosine = refracted((math.sin(angle), 0.0, math.cos(angle)), NORMAL, 1.0 / ior)
    assert -light[0] * ior == pytest.approx(math.sin(angle), abs=1e-12)
    assert light[2] == pytest.approx(-cosine, abs=1e-9)
    assert math.hypot(*light) == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize("eta", [1 / 2.4, 1 / 1.33, 1.0, 1.33, 2.4])
def test_the_way_back_is_the_way_in(rng, eta):
    normal = random_directions(rng, 200)
    for n, towards in zip(normal, views_of(rng, normal, 0.01), strict=True):
        light, cosine = refracted(tuple(towards), tuple(n), eta)
        if cosine == 0.0:
            continue
        returned, _ = refracted(light, tuple(-n), 1.0 / eta)
        assert np.allclose(returned, towards, atol=1e-9)
        assert np.dot(light, n) == pytest.approx(-cosine)
        assert np.dot(np.cross(towards, n), light) == pytest.approx(0, abs=1e-12), "in one plane"


@pytest.mark.parametrize("ior", [1.1, 1.33, 1.5, 2.42])
def test_beyond_the_critical_angle_nothing_gets_out(ior):
    critical = math.asin(1.0 / ior)
    inside = lambda angle: refracted((math.sin(angle), 0.0, math.cos(angle)), NORMAL, ior)  # noqa: E731
    light, cosine = inside(critical - 1e-6)
    assert 0 < cosine < 5e-3
    assert -light[0] == pytest.approx(1, abs=1e-5)
    for angle in (critical + 1e-6, 0.5 * (critical + 0.5 * math.pi), 0.5 * math.pi):
        assert inside(angle) == ((0.0, 0.0, 0.0), 0.0)
        assert transmitted_cosine(math.cos(angle), ior) == 0.0
