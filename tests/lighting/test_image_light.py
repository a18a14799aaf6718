"""Light from environments: furnaces, turns, the sun apart, and brute-force integrals."""

import math
import threading
import time

import numpy as np
import pytest

from raysvc.imaging.sat_builders import BUILDERS
from raysvc.lighting.brdf import MIRROR_ROUGHNESS
from raysvc.lighting.direct import arriving, reflected
from raysvc.lighting.image_light import METHODS, Filtering, ImageLight
from raysvc.lighting.lobe_fit import LOOKUPS
from raysvc.lighting.lobe_levels import LobeLevels
from raysvc.lighting.spherical_harmonics import sh9
from raysvc.parallel import Control
from raysvc.scene import Environment
from tests.lighting.surfaces import random_directions, surface_of, views_of
from tests.oracles.lobe import albedo, map_directions, outgoing

BASE = np.array([0.9, 0.5, 0.2])


def smooth_sky(height=32, width=64):
    """A map of a few waves, brighter above, with a soft light at the side."""
    texels, _ = map_directions(height, width)
    x, y, z = texels.T
    grey = 0.4 + 0.3 * y + 0.1 * np.sin(3 * x) * np.cos(2 * z)
    glow = 2.0 * np.exp(8 * (texels @ np.array([0.6, 0.64, -0.48]) - 1))
    pixels = np.stack([grey + glow, grey + 0.8 * glow, 1.2 * grey + 0.5 * glow], 1)
    return pixels.reshape(height, width, 3).astype(np.float32)


@pytest.fixture(scope="module")
def constant():
    return ImageLight(Environment(np.full((32, 64, 3), 0.5, np.float32)))


@pytest.fixture(scope="module")
def sky():
    return ImageLight(Environment(smooth_sky()))


@pytest.mark.parametrize("samples", LOOKUPS)
@pytest.mark.parametrize("metallic", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("roughness", [0.0, 0.2, 0.6, 1.0])
def test_a_constant_environment_shows_the_albedo(constant, roughness, metallic, samples):
    cosines = np.array([0.1, 0.4, 0.8, 1.0])
    view = np.stack([np.sqrt(1 - cosines**2), 0 * cosines, cosines], 1)
    surface = surface_of(np.tile([0, 0, 1.0], (4, 1)), view, BASE, metallic, roughness)
    diffuse = constant.diffuse(surface)
    specular = constant.specular(surface, samples)
    np.testing.assert_allclose(specular, 0.5 * constant.specular_albedo(surface), rtol=1e-5)
    for i, nov in enumerate(cosines):
        expected = albedo(nov, BASE, metallic, roughness, steps=150)
        np.testing.assert_allclose(diffuse[i], 0.5 * expected[0], rtol=1e-2, atol=1e-7)
        np.testing.assert_allclose(specular[i], 0.5 * expected[1], rtol=1e-2)


def test_a_furnace_looks_the_same_from_all_sides(constant, rng):
    normal = random_directions(rng, 3000)
    for roughness in (0.0, 0.1, 0.4, 1.0):
        view = views_of(rng, normal)
        surface = surface_of(normal, view, 1.0, 0.0, roughness)
        ratio = constant.specular(surface, 4) / constant.specular_albedo(surface)
        np.testing.assert_allclose(ratio, 0.5, rtol=1e-5)


def test_views_below_the_horizon_of_the_shading_normal_stay_finite(sky, rng):
    normal = random_directions(rng, 500)
    for roughness in (0.0, 0.3, 1.0):
        surface = surface_of(normal, random_directions(rng, 500), BASE, 0.5, roughness)
        for light in (sky.diffuse(surface), sky.specular(surface, 4)):
            assert np.isfinite(light).all() and light.min() >= 0


@pytest.mark.parametrize(
    ("roughness", "samples", "limit"),
    [(0.15, 4, 0.02), (0.3, 4, 0.02), (0.6, 4, 0.02), (1.0, 4, 0.02), (0.6, 1, 0.06)],
)
def test_lobes_come_close_to_brute_force_integrals(sky, rng, roughness, samples, limit):
    normal = random_directions(rng, 60)
    view = views_of(rng, normal, 0.2)
    surface = surface_of(normal, view, BASE, 0.0, roughness)
    diffuse, specular = sky.diffuse(surface), sky.specular(surface, samples)
    # Nearest texels of a finer map stand for the sky's own constant texels
    fine = np.repeat(np.repeat(smooth_sky(), 4, axis=0), 4, axis=1)
    errors = []
    for i in range(60):
        n, v = surface.normal[i].astype(float), surface.to_viewer[i].astype(float)
        expected = outgoing(fine, n, v, BASE, 0.0, roughness)
        errors.append([np.abs(diffuse[i] / expected[0] - 1), np.abs(specular[i] / expected[1] - 1)])
    mean = np.mean(errors, axis=(0, 2))
    assert mean[0] < 0.03 and mean[1] < limit


def test_a_mirror_shows_the_map_with_its_sun(rng):
    pixels = smooth_sky()
    pixels[8, 20] = 4000.0
    light = ImageLight(Environment(pixels))
    assert light.suns
    normal = random_directions(rng, 400)
    normal[0] = np.array([0.0, 0.0, 1.0]) + light.suns[0].direction
    normal[0] /= np.linalg.norm(normal[0])
    view = np.tile([0.0, 0.0, 1.0], (400, 1))
    normal *= np.sign(normal[:, 2:])
    surface = surface_of(normal, view, 1.0, 1.0, MIRROR_ROUGHNESS / 2)
    mirrored = 2 * (normal * view).sum(1, keepdims=True) * normal - view
    expected = light.radiance(mirrored.astype(np.float32)) * light.specular_albedo(surface)
    np.testing.assert_allclose(light.specular(surface, 4), expected, rtol=2e-3, atol=1e-4)
    assert light.specular(surface, 4)[0, 0] > 1000
    # The same light once: rougher surfaces have it from the sun, and not from the map
    rough = surface_of(normal[:1], view[:1], 1.0, 1.0, 0.2)
    assert light.specular(rough, 4).max() < 5
    to_light, _, irradiance = arriving(light.suns[0], rough.position)
    assert reflected(rough, to_light, irradiance, light.suns[0].angular_radius_rad).max() > 5


def test_sun_and_rest_light_a_diffuser_as_the_map_does(rng):
    pixels = smooth_sky()
    pixels[8, 20] = 4000.0
    light = ImageLight(Environment(pixels))
    normal = np.array([light.suns[0].direction, [0.2, 0.9, -0.3], [0, 1, 0]])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    surface = surface_of(normal, normal, 1.0, 0.0, 1.0, dielectric_f0=0.0)
    to_light, _, irradiance = arriving(light.suns[0], surface.position)
    radius = light.suns[0].angular_radius_rad
    direct = reflected(surface, to_light, irradiance, radius) + light.diffuse(surface)
    direct += light.specular(surface, 4)
    for i in range(3):
        n = surface.normal[i].astype(float)
        expected = sum(outgoing(pixels, n, n, np.ones(3), 0.0, 1.0, 0.0))
        np.testing.assert_allclose(direct[i], expected, rtol=0.02)


@pytest.mark.parametrize("yaw_deg", [90.0, 217.0])
def test_yaw_turns_the_light_counter_clockwise_seen_from_above(rng, yaw_deg):
    environment = Environment(smooth_sky())
    still, turned = ImageLight(environment), ImageLight(environment, yaw_deg, 2.0)
    c, s = math.cos(math.radians(yaw_deg)), math.sin(math.radians(yaw_deg))
    turn = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    normal = random_directions(rng, 300)
    view = views_of(rng, normal)
    before = surface_of(normal, view, BASE, 0.3, 0.4)
    after = surface_of(normal @ turn.T, view @ turn.T, BASE, 0.3, 0.4)
    for name in ("diffuse", "specular"):
        lookups = (4,) if name == "specular" else ()
        a, b = getattr(still, name)(before, *lookups), getattr(turned, name)(after, *lookups)
        np.testing.assert_allclose(b, 2 * a, rtol=2e-3)
    directions = normal.astype(np.float32)
    np.testing.assert_allclose(
        turned.radiance((normal @ turn.T).astype(np.float32)),
        2 * still.radiance(directions),
        rtol=1e-3,
    )
    centre = still.radiance(np.array([[0, 0, -1]], np.float32))
    quarter = ImageLight(environment, 90.0).radiance(np.array([[-1, 0, 0]], np.float32))
    np.testing.assert_allclose(quarter, centre, rtol=1e-5)


def test_the_sun_turns_with_the_map():
    pixels = smooth_sky()
    pixels[10, 32] = pixels[10, 31] = 4000.0  # ahead, along -Z, and up
    ahead = ImageLight(Environment(pixels)).suns[0]
    left = ImageLight(Environment(pixels), 90.0, 3.0).suns[0]
    assert ahead.direction[2] < 0 and abs(ahead.direction[0]) < 1e-6
    np.testing.assert_allclose(
        left.direction, (ahead.direction[2], ahead.direction[1], 0), atol=1e-6
    )
    np.testing.assert_allclose(left.irradiance, np.multiply(ahead.irradiance, 3), rtol=1e-6)


def test_neighbours_differ_smoothly(sky):
    turn = np.arange(0, 2 * np.pi, 1e-3)
    over = np.stack([0 * turn, np.cos(turn), np.sin(turn)], 1)  # across both poles
    tilted = over @ np.array([[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1]])
    view = np.array([0.3, 0.3, 1.0]) / np.linalg.norm([0.3, 0.3, 1.0])
    for normal in (over, tilted):
        seen = normal @ view > 0.1
        pairs = seen[1:] & seen[:-1]
        for roughness in (0.1, 0.4, 1.0):
            surface = surface_of(normal, view, 1.0, 0.5, roughness)
            for light in (sky.diffuse(surface), sky.specular(surface, 4)):
                jumps = np.abs(np.diff(light[:, 0]))[pairs]
                assert jumps.max() < 0.02


def test_threads_and_chunks_do_not_change_a_bit(sky, rng):
    normal = random_directions(rng, 4000)
    surface = surface_of(normal, views_of(rng, normal), BASE, 0.3, rng.random(4000))
    whole = sky.specular(surface, 4) + sky.diffuse(surface)
    parts = np.empty_like(whole)

    def work(begin, end):
        rows = surface.rows(begin, end)
        parts[begin:end] = sky.specular(rows, 4) + sky.diffuse(rows)

    threads = [threading.Thread(target=work, args=(b, b + 500)) for b in range(0, 4000, 500)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    np.testing.assert_array_equal(parts, whole)


def test_no_points_are_no_work(sky):
    nothing = surface_of(np.zeros((0, 3)), np.zeros((0, 3)))
    assert sky.diffuse(nothing).shape == sky.specular(nothing, 4).shape == (0, 3)
    assert sky.radiance(np.zeros((0, 3), np.float32)).shape == (0, 3)


def test_cones_of_a_constant_map_are_constant_and_narrow_ones_are_the_map(rng):
    directions = random_directions(rng, 50).astype(np.float32)
    half_width = rng.uniform(0.0, 1.5, 50).astype(np.float32)
    constant = ImageLight(Environment(np.full((32, 64, 3), 0.7, np.float32)))
    assert constant.cone(directions, half_width) == pytest.approx(0.7, rel=1e-4)
    varied = ImageLight(Environment(rng.uniform(0, 1, (32, 64, 3)).astype(np.float32)))
    narrow = varied.cone(directions, np.zeros(50, np.float32))
    assert (narrow == varied.radiance(directions)).all()
    wide = varied.cone(directions, np.ones(50, np.float32))
    assert wide.std() < 0.3 * narrow.std()


METHODS_LIMITS = {"sat": 0.02, "sh9": 0.05, "split_sum": 0.3, "brute": 0.02}


@pytest.mark.parametrize("method", METHODS)
def test_methods_come_as_near_as_they_can(rng, method):
    light = ImageLight(Environment(smooth_sky()), filtering=Filtering(method))
    normal = random_directions(rng, 30)
    surface = surface_of(normal, views_of(rng, normal, 0.3), BASE, 0.0, 0.5)
    diffuse, specular = light.diffuse(surface), light.specular(surface)
    fine = np.repeat(np.repeat(smooth_sky(), 4, axis=0), 4, axis=1)
    expected = [
        outgoing(fine, n.astype(float), v.astype(float), BASE, 0.0, 0.5)
        for n, v in zip(surface.normal, surface.to_viewer, strict=True)
    ]
    errors = [
        np.abs(got / np.array([e[k] for e in expected]) - 1).mean()
        for k, got in enumerate((diffuse, specular))
    ]
    assert errors[0] < METHODS_LIMITS[method] if method != "split_sum" else errors[0] < 0.02
    assert errors[1] < METHODS_LIMITS[method]


def test_nine_harmonics_are_those_of_the_map(rng):
    environment = Environment(smooth_sky())
    normal = random_directions(rng, 40)
    surface = surface_of(normal, normal, 1.0, 0.0, 1.0, dielectric_f0=0.0)
    light = ImageLight(environment, filtering=Filtering("sh9"))
    x, y, z = normal.T
    basis = np.stack(
        [
            np.full(40, 0.282095),
            *(0.488603 * v for v in (y, z, x)),
            *(1.092548 * v for v in (x * y, y * z)),
            0.315392 * (3 * z * z - 1),
            1.092548 * x * z,
            0.546274 * (x * x - y * y),
        ],
        axis=1,
    )
    irradiance = basis @ sh9(environment).irradiance
    share = light.diffuse(surface) / (irradiance / np.pi)
    # Schlick's weight takes the same part of all points, which are seen from straight above
    np.testing.assert_allclose(share, share.mean(), rtol=0.02)
    assert 0.9 < share.mean() <= 1


@pytest.mark.parametrize("order", [1, 2, 3])
def test_orders_filter_narrow_lobes_alike_but_not_the_same(sky, rng, order):
    normal = random_directions(rng, 200)
    surface = surface_of(normal, views_of(rng, normal), 1.0, 1.0, 0.12)
    light = ImageLight(Environment(smooth_sky()), filtering=Filtering(order=order))
    got, default = light.specular(surface), sky.specular(surface)
    np.testing.assert_allclose(got, default, rtol=0.05)
    assert (got == default).all() == (order == 2)


@pytest.mark.parametrize("builder", BUILDERS)
def test_builders_and_threads_light_alike(sky, rng, builder):
    normal = random_directions(rng, 200)
    surface = surface_of(normal, views_of(rng, normal), 1.0, 1.0, 0.1)
    filtering = Filtering(builder=builder)
    light = ImageLight(Environment(smooth_sky()), filtering=filtering, control=Control(2))
    np.testing.assert_allclose(light.specular(surface), sky.specular(surface), rtol=1e-5)


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("builder", BUILDERS)
def test_every_sum_of_the_tables_that_are_read_is_the_builders(builder, order, monkeypatch):
    calls = []
    build = BUILDERS[builder]

    def counted(image, table, *rest):
        calls.append((image.shape, build(image, table, *rest)))
        return calls[-1][1]

    monkeypatch.setitem(BUILDERS, builder, counted)
    light = ImageLight(Environment(smooth_sky()), filtering=Filtering(order=order, builder=builder))
    # That of the map itself, out of which the cylinder around Y is read; then those of two tables
    assert len(calls) == 1 + 2 * order
    assert {shape for shape, _ in calls} == {(32, 64, 3)}
    # 5 passes down and 6 across double 1 to 32 and to 64
    each = {"fused": 1, "strips": 3, "scan": 4, "doubling": 11}[builder]
    assert [passes for _, passes in calls] == [each] * len(calls)
    assert light.passes == order * each


def test_phongs_levels_are_made_once_however_many_threads_ask(rng, monkeypatch):
    light, of, made = ImageLight(Environment(smooth_sky())), LobeLevels.of, []
    together = threading.Barrier(4)

    def counted(*asked):
        made.append(threading.get_ident())
        time.sleep(0.05)
        return of(*asked)

    def ask():
        together.wait()
        shown.append(light.phong(directions, 20.0))

    monkeypatch.setattr(LobeLevels, "of", staticmethod(counted))
    directions, shown = random_directions(rng, 20).astype("f4"), []
    threads = [threading.Thread(target=ask) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(made) == 1 and len(shown) == 4
    for each in shown:
        np.testing.assert_array_equal(each, shown[0])
    assert light.make_phong() == 0.0


def test_phong_is_irradiance_at_exponent_1_and_the_map_at_high_ones(sky, rng):
    directions = random_directions(rng, 50)
    surface = surface_of(directions, directions, 1.0, 0.0, 1.0, dielectric_f0=0.0)
    share = sky.diffuse(surface) / sky.phong(directions.astype("f4"), 1.0)
    np.testing.assert_allclose(share, share.mean(), rtol=0.01)
    sharp = sky.phong(directions.astype("f4"), 1e6)
    np.testing.assert_allclose(sharp, sky.radiance(directions.astype("f4")), atol=0.05)
