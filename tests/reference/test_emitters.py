"""Drawing points of triangles that shine: solid angles, powers, densities."""

import numpy as np
import pytest

from raysvc.reference.emitters import Emitters
from raysvc.scene import Material, Texture, TextureRef
from raysvc.shading.scene_tables import SceneTables
from raysvc.tracing.world import World
from tests.oracles.solid_angle import solid_angle
from tests.scenes import joined, mesh, quad, rays

GLOW = (3.0, 2.0, 1.0)


def emitters(scene):
    return Emitters(scene, SceneTables.of(scene))


def lamp(**material):
    return Material(emissive=GLOW, metallic=0.0, **material)


def drawn(scene, position, rng, count=100_000):
    at = np.tile(np.float32(position), (count, 1))
    return emitters(scene).sample(at, rng.random(count), rng.random((count, 2)))


@pytest.mark.parametrize("position", [(0, 0, 2), (1.5, -0.5, 0.7), (0.2, 0.1, -1)])
def test_light_of_a_triangle_is_its_radiance_times_its_solid_angle(rng, position):
    """From either side."""
    corners = [(-1, -0.5, 0), (1, -0.3, 0.2), (0.1, 1.2, -0.1)]
    scene = mesh(corners, [[0, 1, 2]], materials=[lamp()])
    samples = drawn(scene, position, rng)
    expected = solid_angle(np.array(corners, float) - position)
    light = samples.radiance.mean(axis=0, dtype=float)
    np.testing.assert_allclose(light, np.array(GLOW) * expected, rtol=0.01)


def test_density_is_that_of_a_hit_in_the_drawn_direction(rng):
    scene = joined(
        quad(lamp(), z=0.0), quad(Material(), z=-1.0), quad(lamp(double_sided=True), z=-3.0)
    )
    tables = SceneTables.of(scene)
    light, position = Emitters(scene, tables), np.float32([0.3, -0.2, 1.0])
    at = np.tile(position, (2000, 1))
    samples = light.sample(at, rng.random(2000), rng.random((2000, 2)))
    # Only what is not behind the first lamp
    hits = World(scene, tables, "bvh").nearest(rays(position, samples.to_light))
    seen = hits.t < 1.001 * samples.distance
    far = np.isclose(hits.t, samples.distance, rtol=1e-3)
    assert (seen & far).mean() > 0.4
    surface = tables.surface(
        hits.triangle[far],
        hits.barycentric[far],
        samples.to_light[far],
    )
    density = light.density(hits.triangle[far], surface, hits.t[far])
    np.testing.assert_allclose(density, samples.density[far], rtol=2e-3)
    assert (density > 0).all()


def test_brighter_and_larger_triangles_are_drawn_more_often(rng):
    dim = Material(emissive=(0.1, 0.1, 0.1))
    scene = joined(quad(lamp(), z=0.0), quad(dim, z=-1.0), quad(dim, z=-2.0, half=2.0))
    samples = drawn(scene, (0, 0, 5), rng)
    depth = 5 - np.round(samples.to_light[:, 2] * -samples.distance)
    luminance = np.dot(GLOW, [0.2126, 0.7152, 0.0722])
    power = np.array([luminance * 4, 0.1 * 4, 0.1 * 16])
    share = [(depth == z).mean() for z in (0, -1, -2)]
    np.testing.assert_allclose(share, power / power.sum(), atol=0.01)


def test_texture_and_coverage_are_part_of_the_light(rng):
    texels = np.zeros((2, 2, 4), np.uint8)
    texels[..., 3] = 255
    texels[0, 0] = (255, 255, 255, 255)
    material = Material(
        emissive=GLOW,
        emissive_texture=TextureRef(0),
        base_colour=(1, 1, 1, 0.25),
        alpha_mode="blend",
    )
    clamped = Texture(texels, "clamp", "clamp", nearest=True)
    scene = quad(material, textures=[clamped])
    samples = drawn(scene, (0, 0, 2), rng)
    corner = np.array([(-1, 0, -2), (0, 0, -2), (0, 1, -2), (-1, 1, -2)], float)
    expected = solid_angle(corner[[0, 1, 2]]) + solid_angle(corner[[0, 2, 3]])
    light = samples.radiance.mean(axis=0, dtype=float)
    np.testing.assert_allclose(light, 0.25 * np.array(GLOW) * expected, rtol=0.03)


def test_a_texel_that_no_look_has_found_is_still_drawn(rng):
    texels = np.zeros((128, 128, 4), np.uint8)
    texels[100, 37] = 255
    material = Material(emissive=GLOW, emissive_texture=TextureRef(0))
    scene = joined(quad(material, textures=[Texture(texels)]), quad(lamp(), z=-1.0, half=0.2))
    light = emitters(scene)
    assert (light.density_of_triangle > 0).all()


def test_unlit_and_dark_triangles_are_not_drawn():
    unlit = Material(emissive=GLOW, unlit=True)
    scene = joined(quad(Material()), quad(unlit, z=1.0))
    light = emitters(scene)
    assert light.is_dark
    assert light.shines.tolist() == [False, False, True, True]
    assert not light.density_of_triangle.any()
