"""In which direction points are brushed: tangents, rotation, texture, the side that is seen."""

import math

import numpy as np
import pytest

from raysvc.scene import Material, Texture, TextureRef
from tests.scenes import quad
from tests.shading.reading import at_uv

MIDDLE = [(0.4, 0.3)]
ALONG_X = (1.0, 0.0, 0.0, 1.0)
METAL = Material(anisotropy=0.8, roughness=0.4)


def turned(degrees, **changes):
    return Material(anisotropy=0.8, anisotropy_rotation_rad=math.radians(degrees), **changes)


def direction(scene, **where):
    surface = at_uv(scene, MIDDLE, **where)
    assert surface.brushed.size == 1
    return surface.brushed.tangent[0]


def test_a_scene_without_anisotropy_has_no_arrays_of_it():
    surface = at_uv(quad(Material()), [(0.1, 0.1), (0.9, 0.9)])
    assert surface.brushed.size == 0
    assert type(surface).joined([surface, surface]).brushed.size == 0


@pytest.mark.parametrize("tangents", [ALONG_X, None])
def test_it_goes_along_the_tangent_of_the_mesh_or_of_its_texture_coordinates(tangents):
    scene = quad(METAL, tangents=tangents)
    assert direction(scene) == pytest.approx([1, 0, 0], abs=1e-6)
    assert at_uv(scene, MIDDLE).brushed.strength[0] == np.float32(0.8)
    other = quad(METAL, tangents=(0.0, 1.0, 0.0, 1.0))
    assert direction(other) == pytest.approx([0, 1, 0], abs=1e-6)


@pytest.mark.parametrize("handed", [1.0, -1.0])
def test_rotation_is_from_the_tangent_to_the_bitangent(handed):
    scene = quad(turned(30), tangents=(1.0, 0.0, 0.0, handed))
    cosine, sine = math.cos(math.radians(30)), math.sin(math.radians(30))
    assert direction(scene) == pytest.approx([cosine, handed * sine, 0], abs=1e-6)


def test_a_texture_turns_and_weakens_it():
    # R, G: along the bitangent; B: half of the strength
    texture = Texture(np.array([[[128, 255, 51, 255]]], np.uint8))
    scene = quad(turned(0, anisotropy_texture=TextureRef(0)), textures=(texture,))
    assert direction(scene) == pytest.approx([0, 1, 0], abs=0.01)
    assert at_uv(scene, MIDDLE).brushed.strength[0] == pytest.approx(0.8 * 0.2, rel=1e-3)
    scene = quad(turned(90, anisotropy_texture=TextureRef(0)), textures=(texture,))
    assert direction(scene) == pytest.approx([-1, 0, 0], abs=0.01)


def test_it_lies_in_the_plane_of_the_shading_normal_on_both_sides():
    leaning = Texture(np.array([[[220, 128, 200, 255]]], np.uint8))
    material = turned(0, normal_texture=TextureRef(0), double_sided=True)
    scene = quad(material, tangents=ALONG_X, textures=(leaning,))
    for looks in ((0.2, 0, -1), (0.2, 0, 1)):
        surface = at_uv(scene, MIDDLE, direction=looks)
        tangent, normal = surface.brushed.tangent[0], surface.normal[0]
        assert abs(normal[0]) > 0.3
        assert tangent @ normal == pytest.approx(0, abs=1e-6)
        assert np.linalg.norm(tangent) == pytest.approx(1, abs=1e-6)
        assert tangent[0] > 0.5


def test_where_nothing_gives_a_direction_nothing_is_brushed():
    scene = quad(METAL, uv=np.zeros((4, 2)))
    surface = at_uv(scene, MIDDLE)
    assert surface.brushed.strength[0] == 0
    assert surface.roughness[0] == np.float32(0.4)


def test_what_is_brushed_is_no_mirror():
    surface = at_uv(quad(Material(anisotropy=0.8, roughness=0.0)), MIDDLE)
    assert surface.roughness[0] == pytest.approx(0.032)
