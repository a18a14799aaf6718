"""Attributes and materials at points: factors, coverage, texture coordinates, normals."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from raysvc.scene import Material, Texture, TextureRef
from raysvc.shading.scene_tables import SceneTables
from raysvc.shading.surface import Surface
from tests.oracles.texture import srgb_to_linear
from tests.scenes import QUAD_UV, chequered, masked_quad, mesh, quad, soup
from tests.shading.reading import alpha_at_uv, at_uv

MIDDLE = [(0.4, 0.3)]
GREY = Texture(np.full((1, 1, 4), 128, np.uint8))
SRGB_GREY, DATA_GREY = srgb_to_linear(128), 128 / 255


def test_a_plain_material_is_its_factors():
    material = Material(
        base_colour=(0.1, 0.2, 0.3, 0.4),
        metallic=0.5,
        roughness=0.6,
        emissive=(7, 8, 9),
        ior=2.0,
        unlit=True,
    )
    surface = at_uv(quad(material), MIDDLE)
    assert surface.base_colour[0] == pytest.approx([0.1, 0.2, 0.3])
    assert surface.alpha[0] == 1, "an opaque material ignores alpha"
    assert surface.metallic[0] == 0.5
    assert surface.roughness[0] == pytest.approx(0.6)
    assert surface.emissive[0].tolist() == [7, 8, 9]
    assert surface.dielectric_f0[0] == pytest.approx(1 / 9)
    assert surface.occlusion[0] == 1
    assert surface.unlit[0]
    assert surface.position[0] == pytest.approx([-0.2, 0.4, 0])
    assert surface.to_viewer[0].tolist() == [0, 0, 1]
    assert surface.geometric_normal[0].tolist() == [0, 0, 1]
    assert surface.normal[0].tolist() == [0, 0, 1]


def test_every_slot_reads_its_channels_in_its_own_space():
    texels = np.array([[[50, 100, 150, 200]]], np.uint8)
    ref = TextureRef(0)
    material = Material(
        base_colour=(0.5, 0.5, 0.5, 0.5),
        metallic=0.8,
        roughness=0.9,
        emissive=(2, 2, 2),
        alpha_mode="blend",
        occlusion_strength=0.25,
        base_colour_texture=ref,
        metallic_roughness_texture=ref,
        occlusion_texture=ref,
        emissive_texture=ref,
    )
    surface = at_uv(quad(material, textures=(Texture(texels),)), MIDDLE)
    linear = np.array([srgb_to_linear(c) for c in (50, 100, 150)])
    assert surface.base_colour[0] == pytest.approx(linear / 2, rel=1e-5)
    assert surface.alpha[0] == pytest.approx(0.5 * 200 / 255)
    assert surface.emissive[0] == pytest.approx(linear * 2, rel=1e-5)
    assert surface.roughness[0] == pytest.approx(0.9 * 100 / 255)
    assert surface.metallic[0] == pytest.approx(0.8 * 150 / 255)
    assert surface.occlusion[0] == pytest.approx(1 + 0.25 * (50 / 255 - 1))


def test_vertex_colours_multiply_the_base_colour_and_its_alpha():
    colours = np.array([(1, 0, 0, 1), (0, 1, 0, 1), (0, 0, 1, 0), (1, 1, 1, 0)])
    material = Material(base_colour=(0.5, 0.5, 0.5, 0.5), alpha_mode="blend")
    surface = at_uv(quad(material, colours=colours), [(0, 1), (1, 1), (1, 0), (0, 0), (0.5, 0.5)])
    assert surface.base_colour[:4] == pytest.approx(colours[:, :3] / 2)
    assert surface.alpha[:4] == pytest.approx(colours[:, 3] / 2)
    # The middle lies on the diagonal between the first and the third corner.
    assert surface.base_colour[4] == pytest.approx([0.25, 0, 0.25])
    assert surface.alpha[4] == pytest.approx(0.25)


@pytest.mark.parametrize("uv_set", [0, 1])
def test_each_slot_reads_its_own_set_of_coordinates(uv_set):
    texels = chequered([0, 255])
    left, right = np.full((4, 2), 0.25), np.full((4, 2), 0.75)
    material = Material(occlusion_texture=TextureRef(0, uv_set), emissive=(1, 1, 1))
    material = replace(material, emissive_texture=TextureRef(0, 1 - uv_set))
    scene = quad(material, uv=left, uv1=right, textures=(Texture(texels, nearest=True),))
    surface = at_uv(scene, MIDDLE)
    assert surface.occlusion[0] == uv_set
    assert surface.emissive[0, 0] == 1 - uv_set


def test_texture_transforms_move_what_is_read():
    # u' = v, v' = 1 - u: a quarter turn.
    ref = TextureRef(0, 0, (0, 1, 0, -1, 0, 1))
    texels = chequered([0, 85], [170, 255])
    scene = quad(Material(occlusion_texture=ref), textures=(Texture(texels, nearest=True),))
    points = [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)]
    surface = at_uv(scene, points)
    assert surface.occlusion * 255 == pytest.approx([170, 0, 255, 85])


def test_masks_are_cut_at_their_cutoff():
    scene = masked_quad([[0, 127, 128, 255]], alpha_cutoff=0.5)
    points = [(x, 0.5) for x in (0.1, 0.3, 0.6, 0.9)]
    assert alpha_at_uv(scene, points).tolist() == [0, 0, 1, 1]
    assert alpha_at_uv(masked_quad([[0, 100]], alpha_cutoff=0.0), points).tolist() == [1] * 4
    assert alpha_at_uv(masked_quad([[255, 254]], alpha_cutoff=1.1), points).tolist() == [0] * 4


def test_a_cutoff_equal_to_alpha_keeps_the_point():
    material = Material(base_colour=(1, 1, 1, 0.3), alpha_cutoff=0.3, alpha_mode="mask")
    assert alpha_at_uv(quad(material), MIDDLE).tolist() == [1]


def test_coverage_is_one_of_opaque_and_its_alpha_of_blended_materials():
    assert alpha_at_uv(quad(Material(base_colour=(1, 1, 1, 0.25))), MIDDLE).tolist() == [1]
    blended = Material(base_colour=(1, 1, 1, 0.25), alpha_mode="blend")
    assert alpha_at_uv(quad(blended), MIDDLE).tolist() == [0.25]
    over = replace(blended, base_colour=(1, 1, 1, 3.0))
    assert alpha_at_uv(quad(over), MIDDLE).tolist() == [1]
    tables = SceneTables.of(quad())
    assert tables.alpha(np.array([-1], np.int32), np.zeros((1, 2), np.float32)).tolist() == [0]


def test_triangles_are_sorted_by_their_materials_modes():
    materials = tuple(
        Material(alpha_mode=mode, double_sided=mode == "mask")
        for mode in ("opaque", "mask", "blend")
    )
    scene = mesh(np.eye(3), [[0, 1, 2]] * 3, materials=materials, material_of_triangle=[2, 0, 1])
    tables = SceneTables.of(scene)
    assert tables.solid.tolist() == [False, True, False]
    assert tables.blended.tolist() == [True, False, False]
    assert tables.double_sided.tolist() == [False, False, True]


def test_a_scene_without_materials_or_triangles_has_tables():
    tables = SceneTables.of(mesh(np.zeros((0, 3)), np.zeros((0, 3)), materials=()))
    assert len(tables.solid) == 0


def test_roughness_and_metalness_stay_in_range():
    surface = at_uv(quad(Material(metallic=3.0, roughness=-1.0)), MIDDLE)
    assert surface.metallic[0] == 1
    assert surface.roughness[0] == 0


def test_from_behind_both_normals_are_turned():
    surface = at_uv(quad(Material(double_sided=True)), MIDDLE, direction=(0, 0, 1))
    assert surface.geometric_normal[0].tolist() == [0, 0, -1]
    assert surface.normal[0].tolist() == [0, 0, -1]


def test_normals_are_mixed_between_corners():
    a = np.sqrt(0.5)
    normals = [(-a, 0, a), (a, 0, a), (a, 0, a), (-a, 0, a)]
    surface = at_uv(quad(normals=normals), [(0.5, 0.9), (0.75, 0.6)])
    assert surface.normal[0] == pytest.approx([0, 0, 1], abs=1e-6)
    assert surface.normal[1] == pytest.approx(np.array([0.5, 0, 1]) / np.hypot(0.5, 1), abs=1e-6)


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 2**32 - 1))
def test_normals_are_unit_and_never_turned_from_the_viewer(seed):
    rng = np.random.default_rng(seed)
    positions, triangles = soup(rng, 30)
    normals = rng.normal(size=(90, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    scene = mesh(
        positions,
        triangles,
        normals=normals,
        uv=rng.random((90, 2)),
        materials=(Material(normal_texture=TextureRef(0), normal_scale=2.0),),
        textures=(Texture(rng.integers(0, 256, (4, 4, 4), np.uint8)),),
    )
    weights = rng.dirichlet([1, 1, 1], 30)[:, :2].astype(np.float32)
    directions = rng.normal(size=(30, 3)).astype(np.float32)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    surface = SceneTables.of(scene).surface(np.arange(30, dtype=np.int32), weights, directions)
    for vectors in (surface.normal, surface.geometric_normal):
        assert np.linalg.norm(vectors, axis=1) == pytest.approx(np.ones(30), abs=1e-5)
        assert (np.einsum("nk,nk->n", vectors, surface.to_viewer) >= -1e-6).all()
    assert (np.einsum("nk,nk->n", surface.normal, surface.to_viewer) > 0).all()


def test_positions_lie_in_the_plane_of_their_triangle(rng):
    corners = rng.uniform(-1, 1, (300, 3)) * 1e3
    scene = mesh(corners, np.arange(300).reshape(-1, 3))
    weights = rng.dirichlet([1, 1, 1], 100)[:, :2].astype(np.float32)
    surface = SceneTables.of(scene).surface(
        np.arange(100, dtype=np.int32), weights, np.tile(np.float32([0, 0, -1]), (100, 1))
    )
    p = scene.positions.reshape(100, 3, 3).astype(float)
    normal = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    away = np.einsum("nk,nk->n", surface.position - p[:, 0], normal)
    half_step = 0.5 * np.spacing(np.abs(surface.position)).sum(axis=1)
    assert (np.abs(away) <= half_step * 1.001).all()


# Normal maps


def bumped(code, *, direction=(0, 0, -1), scale=1.0, **more):
    """Normal that a map of one texel makes of a quad."""
    texels = np.array([[[*code, 255]]], np.uint8)
    material = Material(
        normal_texture=TextureRef(0), normal_scale=scale, double_sided=True, metallic=0.0
    )
    scene = quad(material, textures=(Texture(texels),), **more)
    return at_uv(scene, MIDDLE, direction=direction).normal[0]


TANGENTS = np.tile([1.0, 0, 0, 1], (4, 1))
MIRRORED = np.tile([-1.0, 0, 0, -1], (4, 1))
WAYS = [None, TANGENTS]
RED, GREEN, BLUE = (255, 128, 128), (128, 255, 128), (128, 128, 255)


@pytest.mark.parametrize("tangents", WAYS)
def test_blue_leaves_the_normal_as_it_is(tangents):
    assert bumped(BLUE, tangents=tangents) == pytest.approx([0, 0, 1], abs=0.006)


@pytest.mark.parametrize("tangents", WAYS)
def test_red_tilts_towards_increasing_u(tangents):
    assert bumped(RED, tangents=tangents) == pytest.approx([1, 0, 0], abs=0.006)


@pytest.mark.parametrize("tangents", WAYS)
def test_green_tilts_upwards_in_the_picture_against_v(tangents):
    assert bumped(GREEN, tangents=tangents) == pytest.approx([0, 1, 0], abs=0.006)


@pytest.mark.parametrize("tangents", [None, MIRRORED])
def test_mirrored_coordinates_mirror_only_red(tangents):
    mirrored = np.array([(1 - u, v) for u, v in QUAD_UV])
    assert bumped(RED, uv=mirrored, tangents=tangents) == pytest.approx([-1, 0, 0], abs=0.006)
    assert bumped(GREEN, uv=mirrored, tangents=tangents) == pytest.approx([0, 1, 0], abs=0.006)


def test_turned_coordinates_turn_the_tilt():
    # The picture's right is the quad's up: u grows upwards, v to the right.
    turned = np.array([(0, 0), (0, 1), (1, 1), (1, 0)])
    assert bumped(RED, uv=turned) == pytest.approx([0, 1, 0], abs=0.006)
    assert bumped(GREEN, uv=turned) == pytest.approx([-1, 0, 0], abs=0.006)


@pytest.mark.parametrize("tangents", WAYS)
def test_from_behind_the_whole_bumped_normal_is_turned(tangents):
    half = (218, 128, 218)
    front = bumped(half, tangents=tangents)
    behind = bumped(half, tangents=tangents, direction=(0, 0, 1))
    assert front == pytest.approx([0.7071, 0, 0.7071], abs=0.01)
    assert behind == pytest.approx(-front, abs=1e-6)


def test_the_scale_acts_on_red_and_green_alone():
    assert bumped((218, 128, 218), scale=2.0) == pytest.approx(
        np.array([2, 0, 1]) / np.sqrt(5), abs=0.01
    )
    assert bumped((218, 218, 218), scale=0.0) == pytest.approx([0, 0, 1])


def test_coordinates_without_area_leave_the_normal_as_it_is():
    assert bumped((218, 218, 218), uv=np.zeros((4, 2))) == pytest.approx([0, 0, 1])


def test_a_bumped_normal_is_bent_until_the_viewer_is_above_it():
    normal = bumped((250, 128, 150), direction=(1, 0, -1))
    towards = np.array([-1, 0, 1]) / np.sqrt(2)
    assert 0 < normal @ towards < 0.01
    assert normal == pytest.approx(np.array([1, 0, 1]) / np.sqrt(2), abs=0.02)


# Surfaces as arrays


def test_surfaces_are_joined_chosen_and_cut_in_order(rng):
    surface = at_uv(quad(), rng.random((5, 2)))
    double = Surface.joined([surface, surface.rows(1, 3)])
    assert double.size == 7
    assert (double.position[5:] == surface.position[1:3]).all()
    assert (surface.chosen(np.array([4, 0])).position == surface.position[[4, 0]]).all()
    assert surface.chosen(np.zeros(5, bool)).size == 0
    assert np.shares_memory(surface.rows(1, 3).position, surface.position)
