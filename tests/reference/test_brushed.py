"""The brushed lobe along paths: value, directions and their density."""

import numpy as np
import pytest

from raysvc.lighting.albedo import specular_albedo
from tests.lighting.surfaces import brushed, surface_of, views_of
from tests.oracles.brushed import brushed_lobe
from tests.reference.scattered import answered, counted_and_claimed, scattered

BASE = np.array([0.9, 0.5, 0.1])
UP = np.array([0.0, 0.0, 1.0])
TANGENT = np.array([0.6, 0.8, 0.0])
AXES = np.array([TANGENT, np.cross(UP, TANGENT), UP])


def points(count, cosine, roughness, strength, base=BASE):
    view = np.array([np.sqrt(1 - cosine**2), 0.0, cosine])
    surface = surface_of(np.tile(UP, (count, 1)), view, base, 1.0, roughness)
    return brushed(surface, strength, tangent=TANGENT)


@pytest.mark.parametrize("strength", [0.3, 1.0])
@pytest.mark.parametrize("roughness", [0.1, 0.5])
def test_light_is_reflected_by_the_formula_of_the_extension(rng, roughness, strength):
    surface = points(300, 0.7, roughness, strength)
    light = views_of(rng, np.tile(UP, (300, 1)))
    got = answered(surface, light)
    view, towards = surface.to_viewer[0].astype(float), light.astype(np.float32).astype(float)
    expected = brushed_lobe(AXES, view, towards, BASE, roughness, strength) * towards[:, 2:]
    np.testing.assert_allclose(got, expected, rtol=2e-3, atol=1e-6)


@pytest.mark.parametrize("cosine", [0.3, 0.9])
def test_directions_fall_as_densely_as_claimed(rng, cosine):
    count = 200_000
    counted, claimed, _ = counted_and_claimed(lambda n: points(n, cosine, 0.55, 0.6), count, rng)
    large = claimed > 300
    assert large.sum() > 30
    np.testing.assert_allclose(counted[large], claimed[large], rtol=0.1)


@pytest.mark.parametrize("strength", [0.3, 1.0])
@pytest.mark.parametrize("roughness", [0.05, 0.4])
def test_constant_light_gives_the_albedo(rng, roughness, strength):
    surface = points(50_000, 0.6, roughness, strength)
    _, throughput, _ = scattered(surface, rng)
    np.testing.assert_allclose(
        throughput.mean(axis=0), specular_albedo(surface.rows(0, 1))[0], rtol=1.5e-2
    )
