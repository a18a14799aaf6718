"""Glass and varnish along paths: values, directions, densities; furnaces and closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest

from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import box, sheet, sphere
from raysvc.lighting.albedo import diffuse_albedo
from raysvc.lighting.boundary_albedo import boundary_albedo
from raysvc.parallel import Control
from raysvc.reference.choices import choices_of
from raysvc.reference.emitters import Emitters
from raysvc.reference.environment import EnvironmentLight
from raysvc.reference.paths import Draws, Lights, PathTracer
from raysvc.scene import Environment, Material
from raysvc.shading.coat import Coat
from raysvc.shading.glass import Glass
from raysvc.shading.scene_tables import SceneTables
from raysvc.tracing.world import World
from tests.lighting.surfaces import random_directions, surface_of, views_of
from tests.oracles.btdf import refraction, schlick_weight
from tests.oracles.coat import coated
from tests.oracles.lobe import map_directions
from tests.reference.scattered import answered, counted_and_claimed, scattered
from tests.reference.tracing import BLACK, grey_sky, light_along
from tests.scenes import joined, quad, rays

BASE = np.array([0.9, 0.5, 0.1])
UP = np.array([0.0, 0.0, 1.0])
TILTED = np.array([math.sin(0.5), 0.0, math.cos(0.5)])
KINDS = ("thin", "into", "out of", "varnished", "varnished glass")


def points(kind, count, cosine, roughness=0.4, geometric_normal=UP, transmission=0.8):
    """The same point `count` times, its shading normal +Z."""
    view = (math.sqrt(1 - cosine**2), 0.0, cosine)
    surface = surface_of(np.tile(UP, (count, 1)), view, BASE, 0.1, roughness)
    surface = surface._replace(
        geometric_normal=np.tile(np.float32(geometric_normal), (count, 1)),
        transmission=np.full(count, transmission if kind != "varnished" else 0.0, np.float32),
    )
    if kind != "varnished":
        glass = Glass.empty(count)
        glass.solid[:] = kind in ("into", "out of")
        glass.entering[:] = kind != "out of"
        glass.ior[:] = 1.5
        glass.absorption[:] = 0.0
        surface = surface._replace(glass=glass)
    if kind.startswith("varnished"):
        coat = Coat.empty(count)
        coat.clearcoat[:] = 0.7
        coat.roughness[:] = 0.3
        coat.normal[:] = np.array([0.2, 0.1, 0.97]) / np.linalg.norm([0.2, 0.1, 0.97])
        surface = surface._replace(coat=coat)
    return surface


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("geometric_normal", [UP, TILTED])
def test_directions_are_drawn_with_the_density_that_is_claimed(rng, kind, geometric_normal):
    def make(count):
        return points(kind, count, 0.6, geometric_normal=geometric_normal)

    counted, expected, drawn = counted_and_claimed(make, 400_000, rng)
    assert expected.sum() == pytest.approx(drawn.sum(), rel=5e-3)
    many = expected > 100
    error = (counted - expected)[many] / np.sqrt(expected[many] + (0.02 * expected[many]) ** 2)
    assert np.abs(error).max() < 5
    assert np.square(error).mean() < 1.5


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("geometric_normal", [UP, TILTED])
def test_what_a_path_keeps_is_the_value_over_the_density(rng, kind, geometric_normal):
    surface = points(kind, 2000, 0.6, geometric_normal=geometric_normal)
    directions, throughput, density = scattered(surface, rng)
    drawn = density > 0
    value = answered(surface, directions)
    np.testing.assert_allclose(
        (throughput * density[:, None])[drawn], value[drawn], rtol=5e-3, atol=1e-6
    )


@pytest.mark.parametrize("kind", KINDS)
def test_odds_sum_to_one(kind):
    choice = choices_of(points(kind, 1, 0.4))
    assert choice.sum() == pytest.approx(1.0)
    assert (choice >= 0).all()
    assert (choice[0, 0] > 0) == kind.startswith("varnished")
    assert (choice[0, 3] > 0) == (kind != "varnished")


@pytest.mark.parametrize("kind", ["thin", "into", "out of"])
@pytest.mark.parametrize("cosine", [0.3, 0.6, 1.0])
@pytest.mark.parametrize("roughness", [0.0, 0.5])
@pytest.mark.parametrize("geometric_normal", [UP, TILTED])
def test_constant_light_gives_the_albedos_of_glass(rng, kind, cosine, roughness, geometric_normal):
    surface = points(kind, 100_000, cosine, roughness, geometric_normal)
    if kind == "out of":
        # Inside the tables tell what is diffused by another Fresnel term; leave it out
        surface = surface._replace(transmission=np.ones(surface.size, np.float32))
    _, throughput, _ = scattered(surface, rng)
    one = surface.chosen(np.array([0]))
    expected = sum(boundary_albedo(one)) + diffuse_albedo(one)
    found = throughput.mean(axis=0, dtype=float)
    np.testing.assert_allclose(found, expected[0], rtol=0.01, atol=2e-3)


@pytest.mark.parametrize("kind", ["into", "out of"])
def test_refraction_is_the_formula_of_the_extension(rng, kind):
    surface = points(kind, 300, 0.8, roughness=0.5)
    light = random_directions(rng, 300)
    light[:, 2] = -np.abs(light[:, 2])
    indices = (1.0, 1.5) if kind == "into" else (1.5, 1.0)
    view = surface.to_viewer[0].astype(float)
    lobe, voh = refraction(view, light.copy(), *indices, 0.25)
    f0 = (0.04 * 0.9 + BASE * 0.1)[None]
    fresnel = f0 + (1 - f0) * schlick_weight(voh, *indices)[:, None]
    expected = (1 - fresnel) * 0.9 * BASE * 0.8 * (lobe * -light[:, 2])[:, None]
    np.testing.assert_allclose(answered(surface, light), expected, rtol=2e-3, atol=1e-6)
    assert (expected > 0).any(axis=1).sum() > 50


def test_varnish_is_the_formula_of_the_extension(rng):
    surface = points("varnished", 300, 0.7)
    light = views_of(rng, np.tile(UP, (300, 1)))
    normal = surface.coat.normal[0].astype(float)
    expected = coated(
        UP, surface.to_viewer[0].astype(float), light.copy(), (BASE, 0.1, 0.4), (0.7, 0.3, normal)
    )
    # Where nothing that the coat would send below the triangle is mirrored
    plain = (light @ normal > 0) & ((light * [1, 1, -1]) @ normal < 0)
    assert plain.sum() > 200
    np.testing.assert_allclose(answered(surface, light)[plain], expected[plain], rtol=2e-3)


# Whole paths

GLASS = Material("glass", metallic=0.0, roughness=0.0, transmission=1.0, solid=True)


@pytest.mark.parametrize("ior", [1.0, 1.33, 1.5, 2.4])
def test_a_smooth_ball_in_a_furnace_is_invisible(ior):
    ball = scene_of("ball", [Part(sphere(1.0, 40), 0)], [replace(GLASS, ior=ior)])
    for across in (0.0, 0.5, 0.9):
        found, _ = light_along(ball, (across, 0.1, 3), (0, 0, -1), 2048, grey_sky(), bounces=8)
        np.testing.assert_allclose(found, 1.0, rtol=5e-3)


def test_a_slab_absorbs_along_the_way_that_rays_go_inside():
    """R + (1 - R)^2 a / (1 - R a), at right angles, for light from both sides."""
    absorption = np.array([0.0, 0.5, 3.0])
    slab = scene_of(
        "slab", [Part(box(40.0, 0.7, 40.0), 0)], [replace(GLASS, absorption=tuple(absorption))]
    )
    found, _ = light_along(slab, (0.1, 5, 0.2), (0, -1, 0), 1 << 13, grey_sky(), bounces=8)
    left = np.exp(-absorption * 0.7)
    np.testing.assert_allclose(found, 0.04 + 0.96**2 * left / (1 - 0.04 * left), rtol=5e-3)


def test_a_slab_seen_aslant_is_longer():
    slab = scene_of(
        "slab", [Part(box(400.0, 0.7, 400.0), 0)], [replace(GLASS, absorption=(3.0, 3.0, 3.0))]
    )
    towards = (math.sin(math.pi / 3), -math.cos(math.pi / 3), 0)
    found, _ = light_along(slab, (0, 5, 0), towards, 1 << 13, grey_sky(), bounces=8)
    reflected = 0.04 + 0.96 * 0.5**5
    left = math.exp(-3.0 * 0.7 / math.sqrt(1 - 0.75 / 2.25))
    expected = reflected + (1 - reflected) ** 2 * left / (1 - reflected * left)
    np.testing.assert_allclose(found, expected, rtol=0.02)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_sheet_tints_what_goes_straight_through(side):
    material = replace(GLASS, base_colour=(*BASE, 1.0), solid=False, double_sided=True)
    pane = scene_of("pane", [Part(sheet(40.0, 40.0, 1, 1), 0)], [material])
    found, _ = light_along(
        pane, (0, 3 * side, 0), (0.6, -0.8 * side, 0), 1 << 13, grey_sky(), bounces=2
    )
    reflected = 0.04 + 0.96 * 0.2**5
    np.testing.assert_allclose(found, reflected + (1 - reflected) * BASE, rtol=5e-3)


def test_what_lies_in_glass_is_seen_through_its_boundary_and_its_colour():
    """A card half a metre below the surface, at right angles; a ray ends at it."""
    absorption = np.array([0.0, 1.0, 4.0])
    tank = scene_of(
        "tank", [Part(box(4.0, 1.0, 4.0), 0)], [replace(GLASS, absorption=tuple(absorption))]
    )
    card = quad(Material(unlit=True, double_sided=True), half=1.0)
    moved = card.positions[:, [0, 2, 1]] + np.float32([0, 0.5, 0])
    lying = replace(card, positions=np.ascontiguousarray(moved))
    found, _ = light_along(joined(tank, lying), (0.1, 4, 0.2), (0, -1, 0), 1 << 13, bounces=2)
    np.testing.assert_allclose(found, 0.96 * np.exp(-0.5 * absorption), rtol=5e-3)


def test_varnish_dims_what_shines_under_it():
    lamp = Material(emissive=(2.0, 1.0, 0.5), metallic=0.0, base_colour=(0, 0, 0, 1), clearcoat=0.5)
    found, _ = light_along(quad(lamp), (0, 0, 2), (0, 0, -1), 64)
    np.testing.assert_allclose(found, 0.98 * np.array([2.0, 1.0, 0.5]), rtol=1e-5)


class Undrawn:
    """Lights that only paths themselves find."""

    class Sky(EnvironmentLight):
        def look_up(self, directions):
            radiance, density = super().look_up(directions)
            return radiance, np.zeros_like(density)

    class Lamps(Emitters):
        is_dark = True

        def density(self, triangle, surface, distance):
            return np.zeros(len(triangle))


def both_ways(scene, environment, bounces, pixels=32, samples=512):
    """Light with lights drawn, and without: (pixels, 3) each, of pixels that show the same."""
    tables = SceneTables.of(scene)
    drawn = EnvironmentLight(environment), Emitters(scene, tables)
    undrawn = Undrawn.Sky(environment), Undrawn.Lamps.__new__(Undrawn.Lamps)
    undrawn[0].is_dark = True
    undrawn[1].__dict__.update(drawn[1].__dict__)
    direction = np.array([-0.1, -1.9, -1.2]) / np.linalg.norm([-0.1, -1.9, -1.2])
    asked = rays((0.5, 2.5, 1.5), np.tile(direction, (pixels * samples, 1)))
    key = np.repeat(np.arange(pixels, dtype=np.uint32) * np.uint32(7919), samples)
    draws = Draws(key, np.tile(np.arange(samples, dtype=np.uint32), pixels))
    light = []
    for sky, lamps in (drawn, undrawn):
        lights = Lights(sky, lamps, ())
        made = PathTracer(World(scene, tables, "auto"), tables, lights, bounces, lambda *_: None)
        radiance, _ = made.trace(asked, draws, Control(threads=1))
        light.append(radiance.reshape(pixels, samples, 3).mean(axis=1, dtype=float))
    return light


def smooth_sky():
    texels, _ = map_directions(16, 32)
    return Environment(
        (1.0 + texels @ np.array([[0.5, 0.2, 0], [0.3, 0.3, 0.8], [0.1, -0.4, 0]]))
        .reshape(16, 32, 3)
        .astype(np.float32)
    )


@pytest.mark.parametrize(
    "material",
    [
        replace(GLASS, roughness=0.5),
        replace(GLASS, roughness=0.5, absorption=(0.1, 1.0, 2.0), transmission=0.6),
        replace(GLASS, roughness=0.4, solid=False, double_sided=True, base_colour=(*BASE, 1.0)),
        replace(GLASS, transmission=0.0, roughness=0.6, clearcoat=0.8, clearcoat_roughness=0.2),
    ],
    ids=["solid", "absorbing", "thin", "varnished"],
)
def test_drawing_lights_changes_the_noise_and_not_the_light(material):
    lamp = Material(
        emissive=(6.0, 4.0, 2.0), base_colour=(0.5, 0.5, 0.5, 1.0), metallic=0.0, clearcoat=0.9
    )
    scene = scene_of(
        "things",
        [
            Part(box(1.6, 0.8, 1.6), 0),
            Part(sphere(0.25, 20).moved([0.0, 0.4, 0.0]), 1),
            Part(sphere(0.4, 20).moved([1.2, 1.2, 0.3]), 1),
        ],
        [material, lamp],
    )
    for environment in (smooth_sky(), BLACK):
        drawn, undrawn = both_ways(scene, environment, 4)
        apart = drawn.mean(axis=0) - undrawn.mean(axis=0)
        error = np.sqrt((drawn.var(axis=0) + undrawn.var(axis=0)) / len(drawn))
        assert (error < 0.08 * drawn.mean(axis=0)).all()
        assert (np.abs(apart) < 4 * error).all()
