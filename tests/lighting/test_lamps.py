"""What glows, as a light: against Lambert's closed form and brute-force integrals."""

import numpy as np
import pytest

from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import sheet, sphere
from raysvc.lighting.lamp_clusters import CLUSTERS, MAX_CLUSTERS, areas, clustered, powers
from raysvc.lighting.lamp_pieces import pieces_of
from raysvc.lighting.lamps import COLOURS, highlight, lamps_of
from raysvc.scene import Material, Texture, TextureRef
from raysvc.shading.scene_tables import SceneTables
from raysvc.tracing.tile_pattern import tile_points
from tests.lighting.surfaces import surface_of
from tests.oracles.polygon_light import irradiance, reflected
from tests.scenes import chequered, joined, quad

GREY = Material(metallic=0.0)
GROUND = Part(sheet(60, 60, 1, 1), 0)


def glowing(emissive=(2.0, 2.0, 2.0), **more):
    return Material(base_colour=(0, 0, 0, 1), metallic=0.0, emissive=emissive, **more)


def lamps(parts, materials):
    scene = scene_of("lamps", [GROUND, *parts], [GREY, *materials])
    return lamps_of(scene, SceneTables.of(scene)), scene


def panel(width=1.0, depth=1.0, height=2.0, material=1):
    """A sheet over the ground that faces it."""
    return Part(sheet(width, depth, 1, 1).turned(180, 2).moved([0, height, 0]), material)


def white(position, normal=(0, 1, 0)):
    """Surface that returns irradiance over pi, hardly changed by Fresnel."""
    position = np.atleast_2d(np.asarray(position, np.float32))
    return surface_of(
        np.tile(np.asarray(normal, float), (len(position), 1)), normal, 1.0, 0.0, 1.0, 0.0
    )._replace(position=position)


def matt(surface):
    """A surface whose specular lobe is as faint as can be, seen from straight above."""
    return surface._replace(roughness=np.zeros(surface.size, np.float32))


def test_a_scene_without_glow_has_no_lamps():
    found, _ = lamps([], [])
    assert found.lights == () and not found.shines.any() and len(found.shines) == 2
    unlit = glowing(unlit=True)
    assert lamps([panel()], [unlit])[0].lights == ()


def test_what_is_as_large_as_a_wall_is_no_lamp():
    found, _ = lamps([panel(30.0, 30.0)], [glowing()])
    assert found.lights == () and not found.shines.any()
    found, scene = lamps([panel()], [glowing()])
    assert len(found.lights) == 1
    assert (found.shines == (scene.material_of_triangle == 1)).all()


@pytest.mark.parametrize("size", [0.5, 2.0])
@pytest.mark.parametrize("at", [(0, 0, 0), (0.7, 0, 0.2), (2.5, 0, -1.0)])
def test_a_panel_lights_a_matt_surface_as_lambert_says(size, at):
    found, _ = lamps([panel(size, size)], [glowing()])
    got = found.lights[0].unshadowed(matt(white(at)))[0]
    half = size / 2
    corners = [(-half, 2, -half), (half, 2, -half), (half, 2, half), (-half, 2, half)]
    expected = 2.0 / np.pi * irradiance(at, (0, 1, 0), corners)
    # Fresnel's factor takes at most a few percent at these angles.
    assert got == pytest.approx(np.full(3, expected), rel=0.04)


@pytest.mark.parametrize("height", [0.5, 0.9, 0.99, 0.9999])
def test_near_a_panel_light_is_even(height, rng):
    found, _ = lamps([panel(4.0, 4.0, 1.0)], [glowing()])
    at = np.stack([rng.uniform(-1, 1, 50), np.full(50, height), rng.uniform(-1, 1, 50)], axis=1)
    got = found.lights[0].unshadowed(matt(white(at)))[:, 0]
    corners = [(-2, 1, -2), (2, 1, -2), (2, 1, 2), (-2, 1, 2)]
    expected = [2.0 / np.pi * irradiance(place, (0, 1, 0), corners) for place in at]
    assert got == pytest.approx(expected, rel=0.05)


@pytest.mark.parametrize("rings", [8, 60])
def test_a_tube_beside_a_wall_lights_it_without_beads(rings):
    tube = Part(sphere(0.02, rings).scaled([1.0, 1.0, 40.0]).moved([0, 0.05, 0]), 1)
    found, _ = lamps([tube], [glowing()])
    along = np.stack([np.zeros(200), np.zeros(200), np.linspace(-0.5, 0.5, 200)], axis=1)
    got = found.lights[0].unshadowed(matt(white(along)))[:, 0]
    assert got.min() > 0.1
    assert np.abs(np.diff(got, 2)).max() < 0.02 * got.max()


@pytest.mark.parametrize("roughness", [0.35, 0.6, 1.0])
def test_highlights_are_those_of_the_integral(roughness):
    found, _ = lamps([panel(0.6, 1.0)], [glowing()])
    at = np.array([(0.2, 0.0, z) for z in (-1.0, 0.0, 0.8, 1.6)])
    view = np.array([0.0, 0.6, 0.8])
    surface = surface_of(np.tile([0, 1.0, 0], (4, 1)), view, (0.9, 0.6, 0.3), 1.0, roughness)
    got = found.lights[0].unshadowed(surface._replace(position=at.astype(np.float32)))
    corner, edges = np.array([-0.3, 2.0, -0.5]), np.array([[0.6, 0, 0], [0, 0, 1.0]])
    for n in range(4):
        _, expected = reflected(
            at[n],
            (0, 1, 0),
            view,
            corner,
            edges,
            base=(0.9, 0.6, 0.3),
            metallic=1.0,
            roughness=roughness,
        )
        assert got[n] == pytest.approx(2.0 * expected, rel=0.07)


@pytest.mark.parametrize("roughness", [0.15, 0.2])
def test_a_narrow_lobe_does_not_tell_clusters_apart(roughness):
    """Along a panel that a glossy floor shows, light is nearly even."""
    found, _ = lamps([panel(1.5, 1.5)], [glowing()])
    x = np.linspace(-0.25, 0.25, 101)
    at = np.stack([x, np.zeros(101), np.full(101, 2.0)], axis=1)
    # Everywhere the panel's middle line is mirrored
    view = np.array([0.0, 2.0, 2.0]) / np.sqrt(8.0)
    surface = surface_of(np.tile([0, 1.0, 0], (101, 1)), view, 1.0, 1.0, roughness)
    got = found.lights[0].unshadowed(surface._replace(position=at.astype(np.float32)))[:, 0]
    assert got.min() > 0.85 * got.max()


def test_smooth_surfaces_leave_highlights_to_reflected_rays():
    found, _ = lamps([panel()], [glowing()])
    mirror = surface_of([[0, 1.0, 0]], [0, 1, 0], 1.0, 1.0, 0.05)
    assert not found.lights[0].unshadowed(mirror).any()
    share = highlight(np.array([0.0, 0.08, 0.15, 0.22, 1.0], np.float32))
    assert share[:2].tolist() == [0, 0] and share[3:].tolist() == [1, 1] and 0 < share[2] < 1


def test_a_ball_lights_like_a_point_of_its_intensity():
    lamp = Part(sphere(0.1, 16).moved([0, 2, 0]), 1)
    found, _ = lamps([lamp], [glowing()])
    got = found.lights[0].unshadowed(matt(white([(0, 0, 0), (1.5, 0, 1.0)])))[:, 0]
    for value, place in zip(got, [(0, 0, 0), (1.5, 0, 1.0)], strict=True):
        away = np.array([0, 2, 0]) - place
        distance = np.linalg.norm(away)
        # L pi r^2 is the intensity of a ball, and the mesh is a little smaller.
        expected = 2.0 * np.pi * 0.01 * (away[1] / distance) / distance**2 / np.pi
        assert value == pytest.approx(expected, rel=0.08)


def test_only_fronts_glow_unless_the_material_has_two_sides():
    above = white([(0, 3.0, 0)], (0, -1, 0))
    one, _ = lamps([panel()], [glowing()])
    two, _ = lamps([panel()], [glowing(double_sided=True)])
    assert not one.lights[0].unshadowed(above).any()
    assert two.lights[0].unshadowed(above).all()


def test_each_colour_is_a_light_of_its_own_up_to_a_few():
    materials = [glowing(c) for c in [(2, 0, 0), (1, 0, 0), (0, 0, 2), (2, 2, 2)]]
    parts = [Part(sphere(0.2, 6).moved([2 * k, 2, 0]), k + 1) for k in range(4)]
    found, _ = lamps(parts, materials)
    assert len(found.lights) == 3
    shown = sorted(light.unshadowed(white([(3, 0, 0)]))[0].tolist() for light in found.lights)
    reds = [rgb for rgb in shown if rgb[0] > 0 and rgb[2] == 0]
    assert len(reds) == 1
    many = [glowing(tuple(np.random.default_rng(k).random(3) ** 2)) for k in range(9)]
    parts = [Part(sphere(0.2, 6).moved([2 * k, 2, 0]), k + 1) for k in range(9)]
    assert len(lamps(parts, many)[0].lights) == COLOURS


def pieces_of_scene(scene):
    tables = SceneTables.of(scene)
    return pieces_of(
        scene,
        tables,
        np.arange(len(scene.triangles), dtype=np.int32),
        np.ones(len(scene.triangles)),
    )


def test_pieces_are_the_triangles_that_they_were_cut_from():
    scene = quad(glowing((1, 2, 3)), half=1.5)
    pieces, material = pieces_of_scene(scene)
    assert areas(pieces).sum() == pytest.approx(9.0)
    assert len(pieces.corner) >= 64 and (material == 0).all()
    assert pieces.normal == pytest.approx(np.tile([0, 0, 1.0], (len(material), 1)), abs=1e-6)
    assert pieces.radiance == pytest.approx(np.tile([1, 2, 3.0], (len(material), 1)))
    corners = pieces.corner[:, None] + np.concatenate(
        [np.zeros_like(pieces.edges[:, :1]), pieces.edges], axis=1
    )
    assert np.abs(corners[..., :2]).max() <= 1.5 + 1e-6


def test_what_a_texture_makes_black_does_not_glow():
    texels = chequered([255, 0])
    lamp = glowing((4, 4, 4), emissive_texture=TextureRef(0))
    scene = quad(lamp, textures=(Texture(texels, "clamp", "clamp", nearest=True),))
    pieces, _ = pieces_of_scene(scene)
    middles = pieces.corner + pieces.edges.sum(axis=1) / 3
    assert middles[:, 0].max() < 0.3
    light = (areas(pieces)[:, None] * pieces.radiance).sum(axis=0)
    assert light == pytest.approx(np.full(3, 4.0 * 2.0), rel=0.15)


def test_clusters_hold_every_piece_and_all_the_power(rng):
    scene = joined(*(quad(glowing((1, 1, 1)), z=float(z), half=0.3) for z in range(5)))
    pieces, _ = pieces_of_scene(scene)
    put, order, discs = clustered(pieces)
    assert CLUSTERS <= len(discs.area) <= MAX_CLUSTERS
    assert order.first[0] == 0 and order.first[-1] == len(pieces.corner)
    assert (np.diff(order.first) > 0).all()
    assert discs.area.sum() == pytest.approx(areas(pieces).sum())
    assert (discs.radiance * discs.area[:, None]).sum(axis=0) == pytest.approx(
        (pieces.radiance * areas(pieces)[:, None]).sum(axis=0)
    )
    assert order.sums[-1] == pytest.approx(powers(pieces).sum())
    # None of them reaches from one lamp to the next
    for first, end in zip(order.first[:-1], order.first[1:], strict=True):
        assert np.ptp(put.corner[first:end, 2]) < 0.5


def test_rays_end_on_the_lamp_and_are_spread_over_it():
    found, _ = lamps([panel(0.8, 0.8)], [glowing()])
    surface = white(np.tile([0.3, 0.0, -0.2], (64, 1)))
    rays = found.lights[0].rays(surface, np.arange(64), tile_points(3))
    ends = surface.position + rays.directions * rays.distance[:, None]
    assert ends[:, 1] == pytest.approx(np.full(64, 2.0), abs=1e-5)
    assert np.abs(ends[:, [0, 2]]).max() <= 0.4 + 1e-5
    # From afar all places of it count about the same: 4 in each of 16 fields, give or take.
    fields = np.histogram2d(ends[:, 0], ends[:, 2], 4, [[-0.4, 0.4]] * 2)[0]
    assert fields.min() >= 2 and fields.max() <= 6


def test_rays_go_to_lamps_by_how_much_light_they_send():
    near = Part(sphere(0.1, 8).moved([0, 1, 0]), 1)
    far = Part(sphere(0.1, 8).moved([0, 2, 0]), 1)
    found, _ = lamps([near, far], [glowing()])
    surface = white(np.zeros((64, 3)))
    rays = found.lights[0].rays(surface, np.arange(64), tile_points(0))
    # The nearer one sends four times as much.
    assert (rays.distance < 1.5).mean() == pytest.approx(0.8, abs=0.04)


def test_rays_of_points_that_get_nothing_are_harmless():
    found, _ = lamps([panel()], [glowing()])
    surface = white([(0, 5.0, 0)])
    rays = found.lights[0].rays(surface, np.zeros(1, np.int64), np.array([[0.5, 0.5]]))
    assert np.isfinite(rays.directions).all() and rays.distance[0] == 0
