"""Transmission at points, and what rays that go through are told."""

import numpy as np
import pytest

from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import sphere
from raysvc.scene import Material, Texture, TextureRef
from raysvc.shading.material_table import LEAST_IOR
from raysvc.shading.scene_tables import SceneTables
from tests.lighting.surfaces import random_directions
from tests.scenes import quad
from tests.shading.reading import at_uv

MIDDLE = [(0.4, 0.3)]
SOLID = Material(transmission=1.0, solid=True, ior=1.33, absorption=(1.0, 2.0, 3.0))


def test_transmission_is_the_factor_times_red_linear():
    texel = Texture(np.array([[[50, 100, 150, 200]]], np.uint8))
    assert at_uv(quad(Material(transmission=0.5)), MIDDLE).transmission[0] == 0.5
    material = Material(transmission=0.5, transmission_texture=TextureRef(0))
    surface = at_uv(quad(material, textures=(texel,)), MIDDLE)
    assert surface.transmission[0] == pytest.approx(0.5 * 50 / 255)


def test_a_scene_without_glass_has_no_arrays_of_it():
    surface = at_uv(quad(Material(ior=1.33)), MIDDLE)
    assert surface.transmission.tolist() == [0]
    assert surface.glass.size == 0


def test_a_solid_is_its_factors():
    glass = at_uv(quad(SOLID), MIDDLE).glass
    assert glass.solid.tolist() == [True]
    assert glass.ior[0] == pytest.approx(1.33)
    assert glass.absorption[0].tolist() == [1, 2, 3]
    sheet = at_uv(quad(Material(transmission=1.0)), MIDDLE).glass
    assert sheet.solid.tolist() == [False]
    assert sheet.absorption[0].tolist() == [0, 0, 0]


@pytest.mark.parametrize("ior", [0.0, 1.0])
def test_an_index_that_bends_nothing_still_has_a_lobe(ior):
    glass = at_uv(quad(Material(transmission=1.0, solid=True, ior=ior)), MIDDLE).glass
    assert glass.ior[0] == pytest.approx(LEAST_IOR)


def test_rays_enter_at_the_front_and_leave_at_the_back(rng):
    ball = scene_of("ball", [Part(sphere(1.0, 12), 0)], [SOLID])
    tables = SceneTables.of(ball)
    triangle = np.arange(len(ball.triangles), dtype=np.int32)
    middle = ball.positions[ball.triangles].mean(axis=1)
    directions = random_directions(rng, len(triangle)).astype(np.float32)
    surface = tables.surface(
        triangle,
        np.full((len(triangle), 2), 1 / 3, np.float32),
        directions,
    )
    corners = ball.positions[ball.triangles].astype(float)
    outwards = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert ((outwards * middle).sum(axis=1) > 0).all()
    inwards = (outwards * directions).sum(axis=1) < 0
    assert np.array_equal(surface.glass.entering, inwards)
    assert 0.3 < inwards.mean() < 0.7
    # The geometric normal is on the viewer's side
    assert np.array_equal((outwards * surface.geometric_normal).sum(axis=1) > 0, inwards)
    assert surface.glass.eta == pytest.approx(np.where(inwards, 1 / 1.33, 1.33), rel=1e-6)


def test_solids_are_seen_from_inside_even_where_they_are_single_sided():
    assert SceneTables.of(quad(SOLID)).double_sided.all()
    assert not SceneTables.of(quad(Material(transmission=1.0))).double_sided.any()
