"""The BRDF's kernels against the specification's formula, and the lobes' normalisation."""

import math

import numpy as np
import pytest

from raysvc.lighting import brdf
from raysvc.lighting.direct import reflected
from tests.lighting.surfaces import random_directions, surface_of, views_of
from tests.oracles.brdf import gltf_lobes


@pytest.mark.parametrize("metallic", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("roughness", [0.0, 0.1, 0.4, 1.0])
def test_a_point_light_is_reflected_by_the_formula_of_gltf(rng, metallic, roughness):
    base = np.array([0.9, 0.5, 0.1])
    normal = random_directions(rng, 200)
    view, light = views_of(rng, normal), views_of(rng, normal)
    # Half of them near the mirror direction, where narrow lobes are
    mirrored = 2 * (normal * view).sum(1, keepdims=True) * normal - view
    light[::2] = mirrored[::2] + 0.5 * roughness**2 * rng.normal(size=(100, 3))
    light /= np.linalg.norm(light, axis=1, keepdims=True)
    surface = surface_of(normal, view, base, metallic, roughness)
    light = light.astype(np.float32)
    got = reflected(surface, light, np.full((200, 3), 2.0, np.float32), 0.0)
    for i in range(200):
        n = surface.normal[i].astype(float)
        towards = light[i : i + 1].astype(float)
        lobes = gltf_lobes(
            n, surface.to_viewer[i].astype(float), towards, base, metallic, roughness
        )
        expected = 2.0 * sum(lobes)[0] * max(n @ towards[0], 0)
        np.testing.assert_allclose(got[i], expected, rtol=1e-3, atol=1e-6)


@pytest.mark.parametrize("alpha", [1e-3, 0.01, 0.2, 1.0])
def test_the_distribution_of_normals_integrates_to_one(alpha):
    # Steps even in the logarithm of the tangent resolve every lobe
    tangent = np.geomspace(1e-7, 1e5, 20001)
    angle = np.arctan(tangent)
    density = [brdf.ggx_density(math.sin(a) ** 2, alpha) * math.cos(a) for a in angle]
    total = np.trapezoid(np.array(density) * 2 * np.pi * np.sin(angle), angle)
    assert total == pytest.approx(1.0, rel=1e-3)


@pytest.mark.parametrize("alpha", [0.01, 0.05, 0.3])
@pytest.mark.parametrize("radius", [0.005, 0.03, 0.1])
@pytest.mark.parametrize("slope", [0.0, 0.02, 0.08, 0.5])
def test_a_disc_sees_the_mean_of_the_distribution_over_it(alpha, radius, slope):
    r = radius * np.sqrt((np.arange(600) + 0.5) / 600)
    turn = (np.arange(360) + 0.5) / 360 * 2 * np.pi
    x = slope + r[:, None] * np.cos(turn)
    y = r[:, None] * np.sin(turn)
    mean = (alpha**2 / (np.pi * (x**2 + y**2 + alpha**2) ** 2)).mean()
    cosine2 = 1 / (1 + slope**2)
    got = brdf.ggx_density_under_disc(1 - cosine2, alpha, radius**2) * cosine2**2
    assert got == pytest.approx(mean, rel=4e-3)


def test_visible_normals_have_the_density_that_is_claimed(rng):
    alpha = 0.4
    view = (0.8, 0.0, 0.6)
    u, turn = rng.random(200_000), rng.random(200_000) * 2 * np.pi
    normals = np.array(
        [
            brdf.visible_normal(view, alpha, c, s, w)
            for c, s, w in zip(np.cos(turn), np.sin(turn), u, strict=True)
        ]
    )
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, rtol=1e-9)
    # E[g] under the density G1 D max(V.H, 0) / N.V, by a grid over half vectors
    z = (np.arange(1000) + 0.5) / 1000
    phi = (np.arange(720) + 0.5) / 720 * 2 * np.pi
    s = np.sqrt(1 - z**2)
    x, y = np.outer(s, np.cos(phi)), np.outer(s, np.sin(phi))
    density = alpha**2 / (np.pi * ((1 - z**2) * (1 - alpha**2) + alpha**2) ** 2)
    voh = np.maximum(view[0] * x + view[2] * z[:, None], 0)
    weights = density[:, None] * voh * brdf.masking(view[2], alpha) / view[2]
    weights *= 2 * np.pi / weights.size
    assert weights.sum() == pytest.approx(1.0, rel=2e-3)
    np.testing.assert_allclose(normals[:, 0].mean(), (weights * x).sum(), atol=3e-3)
    np.testing.assert_allclose(normals[:, 2].mean(), (weights * z[:, None]).sum(), rtol=3e-3)
    np.testing.assert_allclose((normals[:, 1] ** 2).mean(), (weights * y**2).sum(), rtol=2e-2)
