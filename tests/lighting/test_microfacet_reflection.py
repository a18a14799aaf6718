"""The mirror lobe."""

import math

import numpy as np
import pytest

from raysvc.jit import kernel
from raysvc.lighting.microfacet_reflection import reflection_lobe, reflection_sample
from tests.lighting.surfaces import random_directions
from tests.oracles.brdf import gltf_lobes
from tests.oracles.btdf import hemisphere

NORMAL = np.array([0.0, 0.0, 1.0])


def view_at(cosine):
    return (math.sqrt(1 - cosine**2), 0.0, cosine)


@kernel
def draw(view, alpha, turns, uniform, samples):
    for i in range(len(turns)):
        c, s = math.cos(turns[i]), math.sin(turns[i])
        light, weight, voh = reflection_sample(view, alpha, c, s, uniform[i])
        samples[i, 0], samples[i, 1], samples[i, 2] = light
        samples[i, 3], samples[i, 4] = weight, voh


@kernel
def evaluate(view, light, alpha, values):
    for i in range(len(light)):
        at = (light[i, 0], light[i, 1], light[i, 2])
        values[i, 0], values[i, 1], values[i, 2] = reflection_lobe(view, at, alpha)


def drawn(rng, view, alpha, count):
    samples = np.empty((count, 5))
    draw(view, alpha, rng.random(count) * 2 * np.pi, rng.random(count), samples)
    return samples[:, :3], samples[:, 3], samples[:, 4]


def lobes(view, light, alpha):
    values = np.empty((len(light), 3))
    evaluate(view, np.ascontiguousarray(light), alpha, values)
    return values.T


@pytest.mark.parametrize("roughness", [0.05, 0.3, 1.0])
@pytest.mark.parametrize("cosine", [0.1, 0.7, 1.0])
def test_the_lobe_is_gltfs_without_its_fresnel_term(rng, roughness, cosine):
    view, alpha = view_at(cosine), max(roughness**2, 1e-3)
    light = random_directions(rng, 300)
    light[::2] = drawn(rng, view, alpha, 150)[0]
    got, _, _ = lobes(view, light, alpha)
    # With F0 = 1 the specular part is the lobe
    _, expected = gltf_lobes(NORMAL, np.array(view), light, np.ones(3), 1.0, roughness)
    assert (expected > 0).any()
    np.testing.assert_allclose(got, expected[:, 0], rtol=1e-6)


@pytest.mark.parametrize("alpha", [0.01, 0.2, 1.0])
@pytest.mark.parametrize("cosine", [0.1, 0.8])
def test_a_sample_weighs_what_its_lobe_and_density_say(rng, alpha, cosine):
    view = view_at(cosine)
    light, weight, voh = drawn(rng, view, alpha, 500)
    some = weight > 0
    lobe, density, voh_of_lobe = lobes(view, light[some], alpha)
    np.testing.assert_allclose(lobe * light[some, 2] / density, weight[some], rtol=1e-6)
    np.testing.assert_allclose(voh_of_lobe, voh[some], rtol=1e-6)
    assert weight.max() <= 1


@pytest.mark.parametrize("cosine", [0.95, 0.3])
def test_samples_fall_as_the_density_says(rng, cosine):
    alpha, bins, count = 0.5, 8, 400_000
    view = view_at(cosine)
    light, angle = hemisphere(bins * 60, bins * 30, below=False)
    expected = count * np.bincount(
        _bin(light, bins), lobes(view, light, alpha)[1] * angle, bins * bins
    )
    got, weight, _ = drawn(rng, view, alpha, count)
    found = np.bincount(_bin(got[weight > 0], bins), minlength=bins * bins)
    assert found.sum() == pytest.approx(expected.sum(), rel=4e-3)
    many = expected > 50
    chi2 = (found - expected)[many] ** 2 / expected[many]
    assert chi2.mean() < 2.5, "counts differ from the density by more than chance"


def _bin(light, bins):
    row = np.minimum((light[:, 2] * bins).astype(int), bins - 1)
    turn = np.arctan2(light[:, 1], light[:, 0]) / (2 * np.pi) % 1.0
    return row * bins + np.minimum((turn * bins).astype(int), bins - 1)
