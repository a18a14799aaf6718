"""Light through the boundary of a solid."""

import math

import numpy as np
import pytest

from raysvc.geometry.refraction import refracted, transmitted_cosine
from raysvc.jit import kernel
from raysvc.lighting.microfacet_refraction import (
    boundary_fresnel_weight,
    refraction_lobe,
    refraction_sample,
)
from tests.lighting.surfaces import random_directions
from tests.oracles.btdf import exact_fresnel, hemisphere, refraction, schlick_weight

ETAS = [1 / 2.4, 1 / 1.5, 1 / 1.1, 1.1, 1.5, 2.4]


def indices(eta):
    """Index on the viewer's and on the light's side."""
    return (1.0, 1.0 / eta) if eta < 1 else (eta, 1.0)


def view_at(cosine):
    return (math.sqrt(1 - cosine**2), 0.0, cosine)


def view_through(eta, cosine):
    """A view which a smooth boundary refracts, with this cosine on the thin side."""
    return view_at(cosine if eta < 1 else transmitted_cosine(cosine, 1 / eta))


@kernel
def evaluate(view, light, eta, alpha, values):
    for i in range(len(light)):
        at = (light[i, 0], light[i, 1], light[i, 2])
        values[i, 0], values[i, 1], values[i, 2] = refraction_lobe(view, at, eta, alpha)


@kernel
def draw(view, eta, alpha, turns, uniform, samples):
    for i in range(len(turns)):
        c, s = math.cos(turns[i]), math.sin(turns[i])
        light, weight, voh = refraction_sample(view, eta, alpha, c, s, uniform[i])
        samples[i, 0], samples[i, 1], samples[i, 2] = light
        samples[i, 3], samples[i, 4] = weight, voh


def lobes(view, light, eta, alpha):
    """Lobe, density and V.H, each (L,)."""
    values = np.empty((len(light), 3))
    evaluate(view, np.ascontiguousarray(light), eta, alpha, values)
    return values.T


def drawn(rng, view, eta, alpha, count):
    """Directions (count, 3), weights and V.H."""
    samples = np.empty((count, 5))
    draw(view, eta, alpha, rng.random(count) * 2 * np.pi, rng.random(count), samples)
    return samples[:, :3], samples[:, 3], samples[:, 4]


@pytest.mark.parametrize("eta", ETAS)
@pytest.mark.parametrize("alpha", [0.01, 0.2, 1.0])
def test_the_lobe_is_that_of_the_extension(rng, eta, alpha):
    view = view_through(eta, 0.7)
    light = random_directions(rng, 400)
    # Half of them where the lobe is
    light[::2] = drawn(rng, view, eta, alpha, 200)[0]
    light = light[(light != 0).any(axis=1)]
    got, _, voh = lobes(view, light, eta, alpha)
    expected, expected_voh = refraction(np.array(view), light, *indices(eta), alpha)
    assert (expected > 0).sum() > 50
    np.testing.assert_allclose(got, expected, rtol=1e-6)
    some = expected > 0
    np.testing.assert_allclose(voh[some], expected_voh[some], rtol=1e-9)


@pytest.mark.parametrize("eta", ETAS)
@pytest.mark.parametrize("alpha", [0.05, 0.4])
def test_a_sample_weighs_what_its_lobe_and_density_say(rng, eta, alpha):
    view = view_through(eta, 0.6)
    light, weight, voh = drawn(rng, view, eta, alpha, 500)
    some = weight > 0
    assert some.sum() > 200
    lobe, density, voh_of_lobe = lobes(view, light[some], eta, alpha)
    np.testing.assert_allclose(lobe * -light[some, 2] / density, weight[some], rtol=1e-9)
    np.testing.assert_allclose(voh_of_lobe, voh[some], rtol=1e-9)


@pytest.mark.parametrize("eta", [1 / 1.5, 1.33])
@pytest.mark.parametrize("cosine", [0.9, 0.35])
def test_samples_fall_as_the_density_says(rng, eta, cosine):
    alpha, bins, count = 0.5, 8, 400_000
    view = view_at(cosine)
    light, angle = hemisphere(bins * 60, bins * 30)
    density = lobes(view, light, eta, alpha)[1] * angle
    place = _bin(light, bins)
    expected = count * np.bincount(place, density, bins * bins)
    got, weight, _ = drawn(rng, view, eta, alpha, count)
    through = weight > 0
    found = np.bincount(_bin(got[through], bins), minlength=bins * bins)
    assert found.sum() == pytest.approx(expected.sum(), rel=4e-3)
    assert through.mean() < 1 or eta < 1
    many = expected > 50
    chi2 = (found - expected)[many] ** 2 / expected[many]
    assert chi2.mean() < 2.5, "counts differ from the density by more than chance"


def _bin(light, bins):
    row = np.minimum((-light[:, 2] * bins).astype(int), bins - 1)
    turn = np.arctan2(light[:, 1], light[:, 0]) / (2 * np.pi) % 1.0
    return row * bins + np.minimum((turn * bins).astype(int), bins - 1)


@pytest.mark.parametrize("ior", [1.1, 1.5, 2.4])
def test_light_and_viewer_may_be_exchanged(rng, ior):
    """n_V^2 f(V, L) = n_L^2 f(L, V)."""
    for alpha in (0.1, 0.6):
        view = view_at(0.8)
        light, weight, voh = drawn(rng, view, 1 / ior, alpha, 200)
        light, voh = light[weight > 0], voh[weight > 0]
        there = lobes(view, light, 1 / ior, alpha)[0]
        there *= [1 - boundary_fresnel_weight(c, 1 / ior) for c in voh]
        for direction, value in zip(light, there, strict=True):
            # From the other side of the surface its normal is turned over
            seen = (-direction[0], -direction[1], -direction[2])
            back, _, c = refraction_lobe(seen, (-view[0], -view[1], -view[2]), ior, alpha)
            back *= 1 - boundary_fresnel_weight(c, ior)
            assert value == pytest.approx(ior**2 * back, rel=1e-6)


@pytest.mark.parametrize("eta", ETAS)
def test_fresnels_weight_has_the_three_cases_of_the_extension(eta):
    cosine = np.linspace(0, 1, 501)
    got = np.array([boundary_fresnel_weight(c, eta) for c in cosine])
    np.testing.assert_allclose(got, schlick_weight(cosine, *indices(eta)), atol=1e-12)
    assert got[-1] == 0 and got[0] == 1
    assert (np.diff(got) <= 0).all()


@pytest.mark.parametrize("ior", [1.33, 1.5, 2.4])
def test_total_reflection_is_total_and_both_ways_reflect_alike(ior):
    critical = math.sqrt(1 - 1 / ior**2)
    assert boundary_fresnel_weight(critical - 1e-9, ior) == 1.0
    assert boundary_fresnel_weight(0.0, ior) == 1.0
    assert boundary_fresnel_weight(critical + 1e-3, ior) < 1.0
    for cosine in (0.05, 0.3, 0.7, 1.0):
        _, far = refracted(view_at(cosine), (0.0, 0.0, 1.0), 1 / ior)
        inside = boundary_fresnel_weight(far, ior)
        assert boundary_fresnel_weight(cosine, 1 / ior) == pytest.approx(inside, rel=1e-9)


@pytest.mark.parametrize("eta", [1 / 1.5, 1 / 1.33, 1.33, 1.5])
def test_schlick_is_near_fresnel(eta):
    cosine = np.linspace(1e-3, 1, 1000)
    f0 = ((1 - eta) / (1 + eta)) ** 2
    weight = np.array([boundary_fresnel_weight(c, eta) for c in cosine])
    exact = exact_fresnel(cosine, *indices(eta))
    assert np.abs(f0 + (1 - f0) * weight - exact).max() < 0.065


def test_directions_on_the_wrong_side_give_nothing():
    above, below = (0.6, 0.0, 0.8), (0.6, 0.0, -0.8)
    for view, light in ((above, above), (below, below), (below, above)):
        assert refraction_lobe(view, light, 1 / 1.5, 0.3) == (0.0, 0.0, 1.0)
    # Light leaves a denser medium within the critical angle only, if the facets hardly differ
    grazing = (-0.99, 0.0, -math.sqrt(1 - 0.99**2))
    assert refraction_lobe(above, grazing, 1 / 1.5, 0.001)[0] < 1e-3
