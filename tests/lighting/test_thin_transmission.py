"""Light through a sheet without thickness."""

import math

import numpy as np
import pytest

from raysvc.lighting.direct import reflected
from raysvc.lighting.image_light import ImageLight
from raysvc.lighting.microfacet_reflection import reflection_lobe, reflection_sample
from raysvc.lighting.thin_transmission import far_side, thin_lobe, thin_sample
from raysvc.scene import Environment
from raysvc.tracing.reflection import mirror_rays
from tests.lighting.surfaces import random_directions, surface_of, views_of


def view_at(cosine):
    return (math.sqrt(1 - cosine**2), 0.0, cosine)


def test_through_a_sheet_the_lobe_is_that_of_reflection_mirrored(rng):
    view = view_at(0.6)
    for x, y, z in random_directions(rng, 100):
        assert thin_lobe(view, (x, y, -z), 0.3) == reflection_lobe(view, (x, y, z), 0.3)
    for turn, u in rng.random((100, 2)):
        c, s = math.cos(turn), math.sin(turn)
        (x, y, z), weight, voh = thin_sample(view, 0.3, c, s, u)
        assert ((x, y, -z), weight, voh) == reflection_sample(view, 0.3, c, s, u)


def test_a_smooth_sheet_is_seen_straight_through():
    view = view_at(0.4)
    light, weight, _ = thin_sample(view, 1e-3, 1.0, 0.0, 0.0)
    assert np.allclose(light, [-x for x in view], atol=1e-6)
    assert weight == pytest.approx(1, abs=1e-4)
    assert thin_lobe(view, light, 1e-3)[0] > 1e4
    assert thin_lobe(view, (-light[0], light[1], light[2]), 1e-3)[0] < 1e-3


@pytest.mark.parametrize("roughness", [0.1, 0.5, 1.0])
def test_from_the_far_side_a_light_shines_through_the_lobe(rng, roughness):
    normal = np.tile([0, 0, 1.0], (100, 1))
    view, light = views_of(rng, normal), -views_of(rng, normal)
    light[::2] = (-view + 0.5 * roughness**2 * rng.normal(size=view.shape))[::2]
    light /= np.linalg.norm(light, axis=1, keepdims=True)
    light = light.astype(np.float32)
    far = far_side(surface_of(normal, view, 1.0, 0.0, roughness))
    got = reflected(far, light, np.full((100, 3), 2.0, np.float32), 0.0)
    for i in range(100):
        lobe, _, _ = thin_lobe(tuple(view[i]), tuple(map(float, light[i])), roughness**2)
        expected = 2 * lobe * max(-float(light[i, 2]), 0)
        np.testing.assert_allclose(got[i], expected, rtol=2e-3, atol=1e-6)


def test_from_the_far_side_mirror_rays_go_straight_on(rng):
    normal = random_directions(rng, 50)
    surface = surface_of(normal, views_of(rng, normal), 1.0, 0.0, 0.0)
    far = far_side(surface)
    np.testing.assert_allclose(mirror_rays(far).directions, -surface.to_viewer, atol=1e-6)
    assert (np.einsum("nk,nk->n", far.normal, far.to_viewer) > 0).all()


def test_the_environment_is_seen_through_the_far_side(rng):
    """A smooth sheet shows the map behind it, a rough one a blur of that half alone."""
    half = np.zeros((32, 64, 3), np.float32)
    half[:16] = 1.0  # light from above
    light = ImageLight(Environment(half))
    up = np.tile([0, 1.0, 0], (20, 1))
    for roughness in (0.0, 0.3):
        lit = far_side(surface_of(-up, views_of(rng, -up, 0.5), 1.0, 0.0, roughness))
        shown = light.specular(lit, 4) / light.specular_albedo(lit)
        np.testing.assert_allclose(shown, 1, atol=0.05)
        dark = far_side(surface_of(up, views_of(rng, up, 0.5), 1.0, 0.0, roughness))
        np.testing.assert_allclose(light.specular(dark, 4), 0, atol=0.05)
