"""The lobe of brushed surfaces: lights, environments and albedo against anisotropic GGX."""

import numpy as np
import pytest

from raysvc.lighting.albedo import specular_albedo
from raysvc.lighting.brushed_light import round_roughness
from raysvc.lighting.direct import reflected
from raysvc.lighting.image_light import Filtering, ImageLight
from raysvc.lighting.lobe_kernels import lobe_rays
from raysvc.lighting.rescattering import with_rescattering
from raysvc.scene import Environment
from tests.lighting.surfaces import brushed, random_directions, surface_of, views_of
from tests.lighting.test_image_light import smooth_sky
from tests.lighting.test_lamps import glowing, lamps, panel
from tests.oracles.brushed import brushed_lobe, outgoing

BASE = np.array([0.9, 0.5, 0.2])


def points(rng, count, roughness, strength, base=BASE, least=0.2):
    """Metal with normals, views and tangents at random."""
    normal = random_directions(rng, count)
    surface = surface_of(normal, views_of(rng, normal, least), base, 1.0, roughness)
    return brushed(surface, strength, rng)


def axes_of(surface, i):
    """Rows T, B, N in float64."""
    n = surface.normal[i].astype(float)
    n /= np.linalg.norm(n)
    b = np.cross(n, surface.brushed.tangent[i])
    b /= np.linalg.norm(b)
    return np.array([np.cross(b, n), b, n])


@pytest.fixture(scope="module")
def sky():
    return smooth_sky()


@pytest.mark.parametrize("strength", [0.2, 0.7, 1.0])
@pytest.mark.parametrize("roughness", [0.1, 0.4, 1.0])
def test_a_point_light_is_reflected_by_the_formula_of_the_extension(rng, roughness, strength):
    surface = points(rng, 200, roughness, strength)
    light = views_of(rng, surface.normal.astype(float)).astype(np.float32)
    # Half of them near the mirror direction
    normal, view = surface.normal[::2], surface.to_viewer[::2]
    light[::2] = 2 * (normal * view).sum(1, keepdims=True) * normal - view
    light += np.float32(0.3 * roughness**2) * rng.normal(size=light.shape).astype(np.float32)
    light /= np.linalg.norm(light, axis=1, keepdims=True)
    got = reflected(surface, light, np.full((200, 3), 2.0, np.float32), 0.0)
    for i in range(200):
        axes, towards = axes_of(surface, i), light[i : i + 1].astype(float)
        view = surface.to_viewer[i].astype(float)
        value = brushed_lobe(axes, view, towards, BASE, roughness, strength)[0]
        expected = 2.0 * value * max(towards[0] @ axes[2], 0)
        np.testing.assert_allclose(got[i], expected, rtol=2e-3, atol=1e-6)


def test_of_no_strength_all_is_as_if_it_were_not_brushed(rng, sky):
    surface = points(rng, 200, 0.4, 0.0)
    plain = surface._replace(brushed=type(surface.brushed).empty(0))
    light = views_of(rng, surface.normal.astype(float)).astype(np.float32)
    white = np.ones((200, 3), np.float32)
    shown = ImageLight(Environment(sky))
    for ask in (
        lambda s: reflected(s, light, white, 0.01),
        lambda s: shown.specular(s, 4),
        specular_albedo,
        round_roughness,
    ):
        np.testing.assert_array_equal(ask(surface), ask(plain))


def test_faint_scratches_are_hardly_seen(rng):
    surface = points(rng, 200, 0.4, 1e-3)
    plain = surface._replace(brushed=type(surface.brushed).empty(0))
    light = views_of(rng, surface.normal.astype(float)).astype(np.float32)
    white = np.ones((200, 3), np.float32)
    np.testing.assert_allclose(
        reflected(surface, light, white, 0.0), reflected(plain, light, white, 0.0), rtol=1e-3
    )
    np.testing.assert_allclose(specular_albedo(surface), specular_albedo(plain), rtol=2e-2)


@pytest.mark.parametrize("radius", [0.02, 0.1])
def test_a_disc_light_is_the_mean_of_points_on_it(rng, radius):
    surface = points(rng, 60, 0.35, 0.8, least=0.5)
    normal, view = surface.normal, surface.to_viewer
    light = 2 * (normal * view).sum(1, keepdims=True) * normal - view
    white = np.ones((60, 3), np.float32)
    across = np.cross(light, random_directions(rng, 60))
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    other, mean = np.cross(light, across), np.zeros((60, 3))
    for k in range(400):
        r, turn = radius * np.sqrt((k + 0.5) / 400), 2.399963 * k
        towards = light + r * (np.cos(turn) * across + np.sin(turn) * other)
        towards /= np.linalg.norm(towards, axis=1, keepdims=True)
        mean += reflected(surface, towards.astype(np.float32), white, 0.0) / 400
    np.testing.assert_allclose(reflected(surface, light, white, radius), mean, rtol=0.08)


@pytest.mark.parametrize("strength", [0.4, 1.0])
@pytest.mark.parametrize("roughness", [0.2, 0.5, 0.9])
def test_the_albedo_is_that_of_an_integral(rng, roughness, strength):
    surface = points(rng, 12, roughness, strength)
    fine = np.ones((512, 1024, 3), np.float32)
    for i, got in enumerate(specular_albedo(surface)):
        view = surface.to_viewer[i].astype(float)
        expected = outgoing(fine, axes_of(surface, i), view, BASE, roughness, strength)
        np.testing.assert_allclose(got, expected, rtol=2e-2)


@pytest.mark.parametrize("method", ["sat", "sh9", "split_sum", "brute"])
@pytest.mark.parametrize("roughness", [0.05, 0.3, 0.8])
def test_a_furnace_shows_the_albedo(rng, roughness, method):
    light = ImageLight(
        Environment(np.full((32, 64, 3), 0.5, np.float32)), filtering=Filtering(method)
    )
    surface = points(rng, 300, roughness, rng.choice([0.0, 0.3, 0.6, 1.0], 300), least=0.0)
    shown = light.specular(surface)
    np.testing.assert_allclose(shown, 0.5 * specular_albedo(surface), rtol=1e-4)
    white = surface._replace(base_colour=np.ones_like(surface.base_colour))
    np.testing.assert_allclose(light.specular(with_rescattering(white)), 0.5, rtol=1e-3)


@pytest.mark.parametrize(
    ("roughness", "strength", "method", "limit"),
    [
        (0.2, 0.4, "sat", 0.02),
        (0.2, 1.0, "sat", 0.02),
        (0.35, 0.7, "sat", 0.04),
        (0.6, 0.5, "sat", 0.07),
        (0.6, 1.0, "sat", 0.09),
        (0.35, 0.7, "brute", 0.01),
        (0.6, 1.0, "brute", 0.01),
    ],
)
def test_filtered_parts_come_close_to_the_integral(rng, sky, roughness, strength, method, limit):
    surface = points(rng, 80, roughness, strength)
    shown = ImageLight(Environment(sky), filtering=Filtering(method)).specular(surface)
    fine = np.repeat(np.repeat(sky, 8, axis=0), 8, axis=1)
    errors = []
    for i in range(80):
        view = surface.to_viewer[i].astype(float)
        expected = outgoing(fine, axes_of(surface, i), view, BASE, roughness, strength)
        errors.append(np.abs(shown[i] / expected - 1))
    assert np.mean(errors) < limit


def test_a_turned_environment_is_brushed_alike(rng, sky):
    turn = np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]])
    before = points(rng, 100, 0.3, 0.8)
    after = before._replace(
        normal=(before.normal @ turn.T).astype(np.float32),
        to_viewer=(before.to_viewer @ turn.T).astype(np.float32),
        brushed=before.brushed._replace(
            tangent=(before.brushed.tangent @ turn.T).astype(np.float32)
        ),
    )
    for method in ("sat", "brute"):
        still = ImageLight(Environment(sky), filtering=Filtering(method))
        turned = ImageLight(Environment(sky), 90.0, filtering=Filtering(method))
        np.testing.assert_allclose(turned.specular(after), still.specular(before), rtol=3e-3)


def test_rays_into_the_lobe_find_its_albedo(rng):
    one = points(rng, 1, 0.3, 0.8, base=1.0)
    surface = one.chosen(np.zeros(4000, int))
    k = np.arange(4000)
    samples = np.stack([(k * 0.6180339887498949) % 1, (k + 0.5) / 4000], 1)
    directions = np.empty((4000, 3), np.float32)
    weight, half_width = np.empty((2, 4000), np.float32)
    lobe_rays(surface, samples, directions, weight, half_width)
    assert weight.mean() == pytest.approx(specular_albedo(one)[0, 0], rel=1e-2)
    # Where rays lean away from the mirror's, they do so along the tangent
    half = directions + surface.to_viewer
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    axes = axes_of(one, 0)
    assert np.median(np.abs(half @ axes[0])) > 3 * np.median(np.abs(half @ axes[1]))


@pytest.mark.parametrize("strength", [0.4, 0.8])
@pytest.mark.parametrize("roughness", [0.15, 0.4])
def test_cones_of_all_rays_add_up_to_the_solid_angle_that_they_cover(rng, roughness, strength):
    """The mean of 1 / density over the samples of a region is the region's solid angle."""
    one = points(rng, 1, roughness, strength, least=0.8)
    surface = one.chosen(np.zeros(1 << 15, int))
    k = np.arange(surface.size)
    samples = np.stack([(k * 0.6180339887498949) % 1, (k + 0.5) / surface.size], 1)
    directions = np.empty((surface.size, 3), np.float32)
    weight, half_width = np.empty((2, surface.size), np.float32)
    lobe_rays(surface, samples, directions, weight, half_width)
    _, _, normal = axes_of(one, 0)
    view = one.to_viewer[0].astype(float)
    mirror = 2 * (normal @ view) * normal - view
    limit = np.cos(min(2 * roughness**2, 0.4))
    inside = (directions @ mirror > limit) & (weight > 0)
    assert inside.mean() > 0.02
    covered = (np.pi * half_width[inside].astype(float) ** 2).sum() / surface.size
    assert covered == pytest.approx(2 * np.pi * (1 - limit), rel=0.03)


def test_lamps_make_long_highlights_along_the_tangent():
    found, _ = lamps([panel(0.05, 0.05)], [glowing()])
    view = np.array([0.0, 1.0, 0.0])
    at = np.array([(0, 0, 0), (1, 0, 0), (0, 0, 1)], np.float32)
    surface = surface_of(np.tile([0, 1.0, 0], (3, 1)), view, 1.0, 1.0, 0.3)._replace(position=at)
    plain = found.lights[0].unshadowed(surface)[:, 0]
    shown = found.lights[0].unshadowed(brushed(surface, 0.8, tangent=(1, 0, 0)))[:, 0]
    assert plain[1] == pytest.approx(plain[2], rel=1e-3)
    assert shown[1] > 5 * plain[1] and shown[1] > 20 * shown[2]
    assert shown[0] < 0.5 * plain[0]
