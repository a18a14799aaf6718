"""Light along paths against closed forms and quadrature."""

import dataclasses

import numpy as np
import pytest

from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import sphere
from raysvc.errors import Cancelled
from raysvc.parallel import Control
from raysvc.reference.environment import EnvironmentLight
from raysvc.reference.paths import Draws
from raysvc.scene import Environment, Material, PunctualLight
from tests.oracles.brdf import gltf_lobes
from tests.oracles.directional_albedo import directional_albedo
from tests.oracles.lobe import map_directions
from tests.oracles.sphere_room import light_after_bounces
from tests.reference.tracing import BLACK, grey_sky, light_along, tracer
from tests.scenes import joined, masked_quad, quad, rays

BASE = (0.8, 0.5, 0.2)
UP = np.array([0.0, 0.0, 1.0])


def towards(cosine):
    """Direction of a ray that comes down to the plane z = 0 at a cosine to its normal."""
    return np.array([-np.sqrt(1 - cosine**2), 0.0, -cosine])


def plate(metallic, roughness, base=BASE, **material):
    return quad(Material("plate", (*base, 1.0), metallic, roughness, **material), half=50.0)


def seen_from(cosine):
    """Where such a ray starts to meet the origin."""
    return -2.0 * towards(cosine)


@pytest.mark.parametrize("metallic", [0.0, 1.0])
@pytest.mark.parametrize("roughness", [0.0, 0.15, 0.4, 0.7, 1.0])
@pytest.mark.parametrize("cosine", [0.1, 0.3, 0.7, 1.0])
def test_furnace(metallic, roughness, cosine):
    """Under constant light a plate shows the formula's directional albedo."""
    found, _ = light_along(
        plate(metallic, roughness),
        seen_from(cosine),
        towards(cosine),
        1 << 14,
        grey_sky(2.0),
        bounces=3,
    )
    expected = 2.0 * directional_albedo(cosine, BASE, metallic, roughness)
    np.testing.assert_allclose(found, expected, rtol=5e-3)


@pytest.mark.parametrize("roughness", [0.0, 0.3, 1.0])
def test_furnace_of_a_coarse_ball_with_smooth_normals(roughness):
    """Its shading normals tilt away from its triangles; no light is lost or won for that."""
    ball = scene_of("ball", [Part(sphere(1.0, 8), 0)], [Material("", (*BASE, 1), 1.0, roughness)])
    origin, direction = np.array([0.63, 0.35, 3.0]), np.array([0.0, 0.0, -1.0])
    made, _ = tracer(ball, grey_sky())
    hits = made._world.nearest(rays(origin, direction))
    surface = made._tables.surface(hits.triangle, hits.barycentric, np.float32([direction]))
    cosine = float(surface.normal[0] @ surface.to_viewer[0])
    assert float(surface.normal[0] @ surface.geometric_normal[0]) < 0.99
    found, _ = light_along(ball, origin, direction, 1 << 14, grey_sky(), bounces=0)
    expected = directional_albedo(cosine, BASE, 1.0, roughness)
    np.testing.assert_allclose(found, expected, rtol=5e-3)


def patchy_sky():
    """A dim sky with a small sun."""
    texels, _ = map_directions(32, 64)
    sun = np.exp(400 * (texels @ np.array([0.48, 0.36, 0.8]) - 1))[:, None] * (300, 250, 150)
    grey = (0.5 + 0.4 * texels[:, 1:2]) * (1, 1, 1.2)
    return Environment((sun + grey).reshape(32, 64, 3).astype(np.float32))


@pytest.mark.parametrize("metallic", [0.0, 1.0])
@pytest.mark.parametrize("roughness", [0.1, 0.3, 1.0])
def test_a_sky_with_a_sun_is_integrated(metallic, roughness):
    """Where the sky alone, the lobe alone, or both find the sun."""
    sky, view = patchy_sky(), -towards(0.6)
    found, _ = light_along(
        plate(metallic, roughness), seen_from(0.6), towards(0.6), 1 << 14, sky, bounces=1
    )
    directions, angles = map_directions(800, 1600)
    radiance, _ = EnvironmentLight(sky).look_up(directions.astype(np.float32))
    value = sum(gltf_lobes(UP, view, directions.copy(), BASE, metallic, roughness))
    cosine = np.maximum(directions @ UP, 0) * angles
    expected = (value * radiance * cosine[:, None]).sum(axis=0)
    np.testing.assert_allclose(found, expected, rtol=0.01)


@pytest.mark.parametrize("metallic", [0.0, 1.0])
def test_a_sphere_lights_a_plate_past_another_sphere(metallic):
    """Quadrature over the directions that meet the first sphere and not the second."""
    lamp, screen = (np.array([0.6, 0.4, 2.0]), 0.7), (np.array([0.5, 0.1, 1.0]), 0.25)
    glow = Material("glow", emissive=(4.0, 2.0, 1.0))
    black = Material("black", (0, 0, 0, 1), metallic=1.0, roughness=0.0)
    balls = scene_of(
        "balls",
        [Part(sphere(r, 60).moved(c), n) for n, (c, r) in enumerate((lamp, screen))],
        [glow, black],
    )
    scene = joined(plate(metallic, 0.5), balls)
    found, _ = light_along(scene, seen_from(0.7), towards(0.7), 1 << 15)

    directions, angles = map_directions(1000, 2000)

    def meets(centre, radius):
        along = directions @ centre
        return (along > 0) & (centre @ centre - along**2 < radius**2)

    lit = meets(*lamp) & ~meets(*screen)
    assert 0.3 < lit.sum() / meets(*lamp).sum() < 0.9
    value = sum(gltf_lobes(UP, -towards(0.7), directions.copy(), BASE, metallic, 0.5))
    cosine = np.maximum(directions @ UP, 0) * angles * lit
    expected = (value * cosine[:, None]).sum(axis=0) * (4.0, 2.0, 1.0)
    np.testing.assert_allclose(found, expected, rtol=0.01)


@pytest.mark.parametrize("bounces", [0, 1, 4])
@pytest.mark.parametrize(("metallic", "roughness"), [(0.0, 1.0), (1.0, 0.6)])
def test_light_in_a_sphere_room_is_a_series_of_bounces(bounces, metallic, roughness):
    wall = Material("wall", (0.8, 0.8, 0.8, 1.0), metallic, roughness, emissive=(1.0, 1.0, 1.0))
    room = scene_of("room", [Part(sphere(1.0, 70), 0)], [dataclasses.replace(wall)])
    room = dataclasses.replace(room, materials=(dataclasses.replace(wall, double_sided=True),))
    # From the middle of a radius, so that the wall is seen at an angle
    origin, direction = np.array([0.0, 0.6, 0.0]), np.array([0.0, 0.2, -1.0])
    direction /= np.linalg.norm(direction)
    along = origin @ direction
    end = origin + (np.sqrt(along**2 + 1 - 0.36) - along) * direction
    found, met = light_along(room, origin, direction, 1 << 14, bounces=bounces)
    assert met == 1.0
    series = light_after_bounces(abs(end @ direction), 0.8, metallic, roughness, bounces + 1)
    np.testing.assert_allclose(found, series[bounces + 1], rtol=0.01)


def test_a_mirror_shows_what_is_there():
    """A coloured card, and the sky beside it, exactly."""
    card = Material("card", (0.2, 0.7, 0.4, 1.0), unlit=True, double_sided=True)
    scene = joined(plate(1.0, 0.0, (1.0, 1.0, 1.0)), quad(card, z=3.0, half=2.0))
    seen, _ = light_along(scene, (3.0, 0, 1.5), (-1, 0, -1.0), 4096, grey_sky(3.0), bounces=1)
    beside, _ = light_along(scene, (4.5, 0, 1.5), (1, 0, -1.0), 4096, grey_sky(3.0), bounces=1)
    # The narrowest lobe of the formula has a tail that sees past the card
    np.testing.assert_allclose(seen, (0.2, 0.7, 0.4), atol=1e-3)
    np.testing.assert_allclose(beside, (3.0, 3.0, 3.0), rtol=2e-3)


def test_two_mirrors_show_each_other_as_often_as_bounces_allow():
    mirror = Material("", (0.5, 0.5, 0.5, 1.0), metallic=1.0, roughness=0.0, emissive=(1, 1, 1))
    pair = joined(
        quad(mirror, half=200.0),
        quad(dataclasses.replace(mirror, double_sided=True), z=1.0, half=200.0),
    )
    for bounces in (0, 2, 8):
        found, _ = light_along(pair, (0, 0, 0.5), (0.3, 0, -1), 2048, bounces=bounces)
        # Reflected once more than it is followed on, at a cosine at which Fresnel adds nothing
        np.testing.assert_allclose(found, 2 - 0.5 ** (bounces + 1), rtol=2e-3)


@pytest.mark.parametrize("kind", ["directional", "point", "spot"])
def test_punctual_lights_are_answered_exactly_and_shadowed(kind):
    light = PunctualLight(kind, (3.0, 2.0, 1.0), (1.0, 0.0, 2.0), (-0.447214, 0.0, -0.894427))
    open_ = dataclasses.replace(plate(0.3, 0.4), lights=(light,))
    found, _ = light_along(open_, seen_from(0.8), towards(0.8), 8)
    to_light = np.array([[0.447214, 0, 0.894427]])
    distance2 = 1.0 if kind == "directional" else 5.0
    value = sum(gltf_lobes(UP, -towards(0.8), to_light.copy(), BASE, 0.3, 0.4))[0]
    expected = value * 0.894427 * np.array([3.0, 2.0, 1.0]) / distance2
    np.testing.assert_allclose(found, expected, rtol=1e-4)
    screen = quad(Material(), z=0.5, half=0.45)
    shadowed = dataclasses.replace(joined(plate(0.3, 0.4), screen), lights=(light,))
    assert (light_along(shadowed, (-1.2, 0, 1.0), (1.2, 0, -1.0), 8)[0] == 0).all()


def test_blended_surfaces_cover_their_part():
    pane = Material("", (0.0, 1.0, 0.0, 0.3), unlit=True, alpha_mode="blend")
    wall = Material("", (1.0, 0.0, 0.5, 1.0), unlit=True)
    scene = joined(quad(pane, z=1.0), quad(pane, z=0.5), quad(wall))
    found, met = light_along(scene, (0.1, 0.2, 3), (0, 0, -1), 1 << 12)
    np.testing.assert_allclose(found, (0.49, 0.51, 0.245), atol=1e-3)
    assert met == 1.0
    _, met = light_along(quad(pane), (0.1, 0.2, 3), (0, 0, -1), 1 << 12)
    assert met == pytest.approx(0.3, abs=1e-3)


def test_light_comes_through_holes_and_in_part_through_panes():
    light = PunctualLight("directional", (1.0, 1.0, 1.0), direction=(0.0, 0.0, -1.0))

    def under(screen):
        scene = dataclasses.replace(joined(plate(0.0, 1.0), screen), lights=(light,))
        return light_along(scene, (-3, 0, 1.0), (2.5, 0, -1.0), 8)[0]

    open_ = under(quad(Material(), z=5.0, half=0.1))
    np.testing.assert_allclose(under(masked_quad([[0]], z=0.5)), open_, rtol=1e-6)
    assert (under(masked_quad([[255]], z=0.5)) == 0).all()
    pane = Material(base_colour=(1, 1, 1, 0.25), alpha_mode="blend")
    np.testing.assert_allclose(under(quad(pane, z=0.5)), 0.75 * open_, rtol=1e-6)


def test_backs_are_not_seen_by_the_camera_but_by_everything_else():
    back = quad(Material("", (1.0, 0.0, 0.0, 1.0), unlit=True), z=1.0)
    back = dataclasses.replace(back, triangles=back.triangles[:, ::-1].copy())
    wall = Material("", (0.0, 1.0, 0.0, 1.0), unlit=True)
    found, _ = light_along(joined(back, quad(wall)), (0, 0, 3), (0, 0, -1), 16)
    assert found.tolist() == [0, 1, 0]
    mirror = plate(1.0, 0.0, (1, 1, 1))
    # A ray that the mirror sends up meets the side that faces down: the back of this one
    front_up = quad(Material("", (1.0, 0.0, 0.0, 1.0), unlit=True), z=1.0)
    found, _ = light_along(joined(front_up, mirror), (2, 0, 2), (-1, 0, -1), 256, bounces=1)
    np.testing.assert_allclose(found, (1, 0, 0), rtol=2e-3)


def test_a_closed_room_of_coarse_smooth_walls_lets_no_light_in():
    wall = Material("", (0.9, 0.9, 0.9, 1.0), 0.0, 0.5, double_sided=True)
    room = scene_of("room", [Part(sphere(1.0, 6), 0)], [wall])
    for direction in ((1, 0.2, 0.1), (0.3, -0.8, 0.5), (-0.2, 0.4, 1)):
        found, met = light_along(room, (0.1, 0.2, 0.0), direction, 2048, grey_sky(100.0), bounces=4)
        assert met == 1.0
        assert (found == 0).all()


def test_rays_are_counted_by_kind():
    scene = plate(0.0, 1.0)
    made, counted = tracer(scene, grey_sky(), bounces=2)
    asked = rays(np.tile([0, 0, 1.0], (64, 1)), [0, 0, -1])
    draws = Draws(np.full(64, 3, np.uint32), np.arange(64, dtype=np.uint32))
    made.trace(asked, draws, Control(threads=1))
    assert counted["primary"] == 64
    assert 60 <= counted["path"] <= 64
    assert 20 < counted["shadow"] < 45


def test_a_cancelled_wave_stops():
    made, _ = tracer(plate(0.0, 1.0), grey_sky())
    control = Control(threads=1)
    control.cancel()
    draws = Draws(np.zeros(1, np.uint32), np.zeros(1, np.uint32))
    with pytest.raises(Cancelled):
        made.trace(rays((0, 0, 1), (0, 0, -1)), draws, control)


def test_nothing_is_met_in_an_empty_direction():
    found, met = light_along(plate(0.0, 1.0), (0, 0, 1), (0, 0, 1), 16, BLACK)
    assert met == 0 and (found == 0).all()
