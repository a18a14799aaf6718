"""Sun and punctual lights."""

import math

import numpy as np
import pytest

from raysvc.lighting.direct import arriving, reflected
from raysvc.lighting.sun import SunLight
from raysvc.scene import PunctualLight
from tests.lighting.surfaces import random_directions, surface_of, views_of

UP = np.array([[0.0, 1.0, 0.0]])


def test_a_point_light_falls_with_the_square_of_the_distance():
    light = PunctualLight("point", (8.0, 4.0, 2.0), position=(0, 3, 0))
    position = np.array([[0, 1, 0], [0, 3, 4]], np.float32)
    to_light, distance, irradiance = arriving(light, position)
    np.testing.assert_allclose(to_light, [[0, 1, 0], [0, 0, -1]], atol=1e-7)
    np.testing.assert_allclose(distance, [2, 4])
    np.testing.assert_allclose(irradiance, [[2, 1, 0.5], [0.5, 0.25, 0.125]], rtol=1e-6)
    assert {a.dtype for a in (to_light, distance, irradiance)} == {np.dtype(np.float32)}


def test_a_range_ends_a_light_smoothly():
    light = PunctualLight("point", (1.0, 1.0, 1.0), range_m=2.0)
    position = np.array([[0, 0, 1], [0, 0, 1.999], [0, 0, 2.5]], np.float32)
    irradiance = arriving(light, position)[2][:, 0]
    np.testing.assert_allclose(irradiance[0], 1 - 0.5**4)
    assert 0 < irradiance[1] < 1e-3 and irradiance[2] == 0


def test_a_spot_is_full_inside_and_nothing_outside_its_cones():
    light = PunctualLight(
        "spot", (1.0, 1.0, 1.0), inner_cone_rad=math.radians(20), outer_cone_rad=math.radians(40)
    )
    angle = np.radians([0, 19, 30, 41, 180])
    position = np.stack([np.sin(angle), 0 * angle, -np.cos(angle)], 1).astype(np.float32)
    irradiance = arriving(light, position)[2][:, 0]
    outer, inner = math.cos(math.radians(40)), math.cos(math.radians(20))
    half = ((math.cos(math.radians(30)) - outer) / (inner - outer)) ** 2
    np.testing.assert_allclose(irradiance, [1, 1, half, 0, 0], rtol=1e-4)


def test_a_directional_light_and_the_sun_are_the_same_everywhere():
    for light in (
        PunctualLight("directional", (3.0, 2.0, 1.0), direction=(0.0, -1.0, 0.0)),
        SunLight((0.0, 1.0, 0.0), (3.0, 2.0, 1.0), 0.005),
    ):
        to_light, distance, irradiance = arriving(light, np.ones((4, 3), np.float32))
        np.testing.assert_array_equal(to_light, np.tile(UP, (4, 1)))
        np.testing.assert_array_equal(irradiance, np.tile([3.0, 2, 1], (4, 1)))
        assert np.isinf(distance).all()


def test_light_at_a_point_is_finite():
    to_light, _, irradiance = arriving(PunctualLight("point", (1, 1, 1)), np.zeros((1, 3), "f4"))
    assert np.isfinite(to_light).all() and np.isfinite(irradiance).all()


def test_light_from_behind_the_triangle_gives_nothing():
    tilted = np.array([[math.sin(0.3), math.cos(0.3), 0]])
    surface = surface_of(tilted, UP, roughness=0.5, metallic=0.0)
    surface = surface._replace(geometric_normal=UP.astype(np.float32))
    behind = np.array([[math.cos(0.1), -math.sin(0.1), 0]], np.float32)
    assert float(surface.normal[0] @ behind[0]) > 0
    assert not reflected(surface, behind, np.ones((1, 3), np.float32), 0.0).any()


@pytest.mark.parametrize("nov", [1.0, 0.8, 0.5])
@pytest.mark.parametrize("roughness", [0.05, 0.1, 0.2, 0.4])
def test_a_disc_lights_as_much_as_the_points_that_it_is_made_of(rng, roughness, nov):
    radius = math.radians(3)
    towards = np.array([math.sqrt(1 - nov**2), nov, 0])
    # Normals around the half vector, so that the highlight passes by; one view
    half = np.array([0.0, 1.0, 0.0])
    view = np.array([-towards[0], towards[1], 0])
    spread = max(roughness**2, radius)
    normal = half + np.linspace(-3, 3, 301)[:, None] * spread * np.array([0.6, 0, 0.8])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    surface = surface_of(normal, view, 1.0, 1.0, roughness)
    got = reflected(
        surface, np.tile(towards, (301, 1)).astype("f4"), np.ones((301, 3), "f4"), radius
    )

    side = np.cross(towards, [0, 0, 1.0])
    expected = np.zeros((301, 3))
    count = 2000
    r = radius * np.sqrt((np.arange(count) + 0.5) / count)
    turn = np.arange(count) * 2.399963
    for a, b in zip(r * np.cos(turn), r * np.sin(turn), strict=True):
        point = towards + a * side + b * np.array([0, 0, 1.0])
        point = np.tile(point / np.linalg.norm(point), (301, 1)).astype("f4")
        expected += reflected(surface, point, np.ones((301, 3), "f4"), 0.0)
    expected /= count
    error = np.abs(got - expected)[:, 0].sum() / expected[:, 0].sum()
    assert error < 0.06 / nov
    assert got[:, 0].sum() == pytest.approx(expected[:, 0].sum(), rel=0.04)


def test_a_mirror_has_no_highlight_of_a_disc_but_one_of_a_point(rng):
    normal = random_directions(rng, 50)
    view = views_of(rng, normal, 0.2)
    mirrored = (2 * (normal * view).sum(1, keepdims=True) * normal - view).astype(np.float32)
    surface = surface_of(normal, view, 1.0, 1.0, 0.0)
    light = np.ones((50, 3), np.float32)
    assert not reflected(surface, mirrored, light, 0.01).any()
    assert (reflected(surface, mirrored, light, 0.0) > 100).all()
