"""Varnish at points: factors, textures, its own normal."""

import numpy as np
import pytest

from raysvc.scene import Material, Texture, TextureRef
from tests.scenes import quad
from tests.shading.reading import at_uv

MIDDLE = [(0.4, 0.3)]
TEXEL = Texture(np.array([[[50, 100, 150, 200]]], np.uint8))
TILTED = Texture(np.array([[[255, 128, 128, 255]]], np.uint8))
"""A normal map that leans along the tangent."""


def test_varnish_is_its_factors():
    surface = at_uv(quad(Material(clearcoat=0.5, clearcoat_roughness=0.25)), MIDDLE)
    assert surface.coat.size == 1
    assert surface.coat.clearcoat[0] == 0.5
    assert surface.coat.roughness[0] == 0.25
    assert surface.coat.normal[0].tolist() == [0, 0, 1]


def test_a_scene_without_varnish_has_no_arrays_of_it():
    surface = at_uv(quad(Material()), [(0.1, 0.1), (0.9, 0.9)])
    assert surface.coat.size == 0
    assert surface.chosen(np.array([1])).coat.size == 0
    assert surface.chosen(np.array([True, False])).coat.size == 0
    assert surface.rows(0, 1).coat.size == 0
    assert type(surface).joined([surface, surface]).coat.size == 0


def test_varnish_goes_with_its_points():
    texels = np.array([[[0, 0, 0, 255], [255, 0, 0, 255]]], np.uint8)
    scene = quad(
        Material(clearcoat=1.0, clearcoat_texture=TextureRef(0)),
        textures=(Texture(texels, nearest=True),),
    )
    surface = at_uv(scene, [(0.2, 0.5), (0.8, 0.5), (0.7, 0.5)])
    assert surface.coat.clearcoat.tolist() == [0, 1, 1]
    assert surface.chosen(np.array([2, 0])).coat.clearcoat.tolist() == [1, 0]
    assert surface.chosen(np.array([False, True, False])).coat.clearcoat.tolist() == [1]
    assert surface.rows(1, 3).coat.clearcoat.tolist() == [1, 1]
    joined = type(surface).joined([surface, surface.rows(0, 1)])
    assert joined.coat.clearcoat.tolist() == [0, 1, 1, 0]
    assert joined.coat.size == joined.size


def test_strength_is_red_and_roughness_green_both_linear():
    ref = TextureRef(0)
    material = Material(
        clearcoat=0.8,
        clearcoat_roughness=0.5,
        clearcoat_texture=ref,
        clearcoat_roughness_texture=ref,
    )
    surface = at_uv(quad(material, textures=(TEXEL,)), MIDDLE)
    assert surface.coat.clearcoat[0] == pytest.approx(0.8 * 50 / 255)
    assert surface.coat.roughness[0] == pytest.approx(0.5 * 100 / 255)


def test_bumps_of_the_base_are_not_those_of_the_varnish():
    ref = TextureRef(0)
    base = at_uv(quad(Material(clearcoat=1, normal_texture=ref), textures=(TILTED,)), MIDDLE)
    assert base.normal[0, 0] > 0.5
    assert base.coat.normal[0].tolist() == [0, 0, 1]
    coat = Material(clearcoat=1, clearcoat_normal_texture=ref, clearcoat_normal_scale=0.5)
    coat = at_uv(quad(coat, textures=(TILTED,)), MIDDLE)
    assert coat.normal[0].tolist() == [0, 0, 1]
    bumped = at_uv(quad(Material(normal_texture=ref, normal_scale=0.5), textures=(TILTED,)), MIDDLE)
    assert coat.coat.normal[0] == pytest.approx(bumped.normal[0], abs=1e-6)


def test_varnish_faces_the_viewer():
    scene = quad(Material(clearcoat=1.0, double_sided=True))
    behind = at_uv(scene, MIDDLE, direction=(0, 0, 1))
    assert behind.coat.normal[0].tolist() == [0, 0, -1]
    grazing = at_uv(
        quad(Material(clearcoat=1.0, clearcoat_normal_texture=TextureRef(0)), textures=(TILTED,)),
        MIDDLE,
        direction=(1, 0, -0.01),
    )
    assert (grazing.coat.normal * grazing.to_viewer).sum() > 0
