"""Varnish over diffuse and mirroring surfaces."""

import numpy as np
import pytest

from raysvc.lighting.clearcoat import Varnish, coat_share
from raysvc.lighting.direct import reflected
from raysvc.lighting.image_light import ImageLight
from raysvc.scene import Environment
from raysvc.shading.coat import Coat
from tests.lighting.surfaces import random_directions, surface_of, views_of
from tests.oracles.coat import coat_fresnel, coated
from tests.oracles.lobe import map_directions

BASE = np.array([0.8, 0.4, 0.1])


def varnished(normal, view, base, coat, coat_normal=None):
    """Surface of N points under varnish; `base` is (colour, metallic, roughness)."""
    surface = surface_of(normal, view, *base)
    count = surface.size
    return surface._replace(
        coat=Coat(
            np.full(count, coat[0], np.float32),
            np.full(count, coat[1], np.float32),
            surface.normal if coat_normal is None else np.ascontiguousarray(coat_normal, "f4"),
        )
    )


def test_the_share_is_schlicks_for_an_index_of_a_half_more():
    assert coat_share(1.0, 1.0) == pytest.approx(0.04)
    assert coat_share(0.5, 0.0) == 0.5
    assert coat_share(0.5, 0.3) == coat_share(0.5, -0.3)
    for cosine in (0.05, 0.4, 0.9):
        view, normal = [np.sqrt(1 - cosine**2), 0, cosine], [0, 0, 1]
        assert coat_share(0.7, cosine) == pytest.approx(0.7 * coat_fresnel(view, normal))


@pytest.mark.parametrize("base", [(BASE, 0.0, 0.5), (BASE, 1.0, 0.05), (BASE, 0.4, 1.0)])
@pytest.mark.parametrize("coat", [(1.0, 0.05), (0.5, 0.3)])
def test_a_light_on_varnish_is_the_extensions_formula(rng, base, coat):
    normal = random_directions(rng, 200)
    view, light = views_of(rng, normal), views_of(rng, normal)
    mirrored = 2 * (normal * view).sum(1, keepdims=True) * normal - view
    light[::2] = mirrored[::2] + 0.5 * coat[1] ** 2 * rng.normal(size=(100, 3))
    light /= np.linalg.norm(light, axis=1, keepdims=True)
    light = light.astype(np.float32)
    leaning = normal + 0.2 * random_directions(rng, 200)
    leaning /= np.linalg.norm(leaning, axis=1, keepdims=True)
    surface = varnished(normal, view, base, coat, leaning)
    irradiance = np.full((200, 3), 2.0, np.float32)
    got = reflected(surface, light, irradiance, 0.0)
    varnish = Varnish.of(surface)
    varnish.laid_over(got, reflected(varnish.surface, light, irradiance, 0.0))
    for i in range(200):
        n, v = surface.normal[i].astype(float), surface.to_viewer[i].astype(float)
        nc = surface.coat.normal[i].astype(float)
        if min(v @ nc, light[i] @ nc, light[i] @ n) < 0.02:
            continue
        expected = 2 * coated(n, v, light[i : i + 1].astype(float), base, (*coat, nc))[0]
        np.testing.assert_allclose(got[i], expected, rtol=2e-3, atol=1e-6)


@pytest.mark.parametrize("base", [(BASE, 0.0, 1.0), (BASE, 1.0, 0.3)])
@pytest.mark.parametrize("nov", [0.95, 0.4])
def test_varnish_under_constant_light_is_the_integral_of_the_formula(base, nov):
    """Brute force over all directions, of a base and a coat broad enough for it."""
    normal, view = np.array([[0, 0, 1.0]]), np.array([[np.sqrt(1 - nov**2), 0, nov]])
    surface = varnished(normal, view, base, (0.8, 0.4))
    light = ImageLight(Environment(np.ones((16, 32, 3), np.float32)))
    got = light.diffuse(surface) + light.specular(surface, 4)
    varnish = Varnish.of(surface)
    varnish.laid_over(got, light.specular(varnish.surface, 4))
    directions, angles = map_directions(400, 800)
    expected = coated(normal[0], view[0], directions, base, (0.8, 0.4, normal[0]))
    np.testing.assert_allclose(got[0], (expected * angles[:, None]).sum(0), rtol=5e-3)


def test_only_what_has_varnish_and_is_lit_is_varnished():
    surface = varnished(np.tile([0, 0, 1.0], (4, 1)), [0, 0, 1.0], (BASE, 0.0, 0.5), (0.0, 0.1))
    surface.coat.clearcoat[[1, 3]] = 1
    surface.unlit[3] = True
    varnish = Varnish.of(surface)
    assert varnish.point.tolist() == [1]
    assert varnish.share == pytest.approx(np.array([[0.04]]))
    shown = np.ones((4, 3), np.float32)
    varnish.laid_over(shown, np.full((1, 3), 2.0, np.float32))
    assert shown[:, 0] == pytest.approx([1, 1.04, 1, 1])


def test_surfaces_of_scenes_without_varnish_stay_as_they_are():
    surface = surface_of(np.tile([0, 0, 1.0], (3, 1)), [0, 0, 1.0])
    varnish = Varnish.of(surface)
    assert varnish.point.size == varnish.surface.size == 0
    shown = np.ones((3, 3), np.float32)
    varnish.laid_over(shown, np.zeros((0, 3), np.float32))
    assert (shown == 1).all()
