"""Glass and varnish: KHR_materials_transmission, _volume and _clearcoat."""

import math

import numpy as np
import pytest

from raysvc.errors import InvalidScene
from raysvc.scene import Material
from tests.loading.gltf.building import QUAD, QUAD_INDICES, QUAD_UV, Builder, triangle_with

TRANSMISSION = "KHR_materials_transmission"
VOLUME = "KHR_materials_volume"
CLEARCOAT = "KHR_materials_clearcoat"
ANISOTROPY = "KHR_materials_anisotropy"


def with_extensions(**extensions):
    return triangle_with(materials=[{"extensions": extensions}])


def loaded(**extensions):
    scene = with_extensions(**extensions).load()
    assert scene.warnings == ()
    return scene.materials[0]


def glass(transmission=1.0, **volume):
    return loaded(**{TRANSMISSION: {"transmissionFactor": transmission}, VOLUME: volume})


def test_transmission_alone_is_a_thin_sheet():
    made = loaded(**{TRANSMISSION: {"transmissionFactor": 0.75}})
    assert made == Material(transmission=0.75)
    assert loaded(**{TRANSMISSION: {}}) == Material()


def test_a_thickness_makes_it_solid_and_says_nothing_else():
    assert not glass().solid
    assert not glass(thicknessFactor=0).solid
    assert glass(thicknessFactor=0.001) == glass(thicknessFactor=100)
    assert glass(thicknessFactor=0.001) == Material(transmission=1.0, solid=True)


def test_a_volume_that_nothing_enters_is_no_volume():
    made = loaded(**{VOLUME: {"thicknessFactor": 1, "attenuationDistance": 2}})
    assert made == Material()


def test_absorption_leaves_the_colour_after_the_distance():
    colour = [0.9, 0.5, 0.01]
    made = glass(thicknessFactor=1, attenuationDistance=0.25, attenuationColor=colour)
    assert np.exp(-0.25 * np.array(made.absorption)) == pytest.approx(colour, rel=1e-9)
    assert glass(thicknessFactor=1, attenuationColor=colour).absorption == (0, 0, 0)
    assert glass(thicknessFactor=1, attenuationDistance=1).absorption == (0, 0, 0)


def test_black_absorbs_all_and_stays_finite():
    made = glass(thicknessFactor=1, attenuationDistance=1e-9, attenuationColor=[0, 0.5, 1])
    assert made.absorption == (1e6, 1e6, 0)
    assert math.exp(-made.absorption[0] * 1e-4) < 1e-40


def test_the_coat_has_its_own_strength_roughness_and_bumps():
    made = loaded(**{CLEARCOAT: {"clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.25}})
    assert made == Material(clearcoat=0.5, clearcoat_roughness=0.25)
    assert loaded(**{CLEARCOAT: {}}) == Material()


def test_scratches_have_a_strength_and_a_direction():
    given = {ANISOTROPY: {"anisotropyStrength": 0.5, "anisotropyRotation": math.tau + 1}}
    scene = with_extensions(**given).load()
    made = scene.materials[0]
    assert made.anisotropy == 0.5
    assert made.anisotropy_rotation_rad == pytest.approx(1)
    (warning,) = scene.warnings
    assert "neither tangents nor texture coordinates" in warning
    assert loaded(**{ANISOTROPY: {}}) == Material()


@pytest.mark.parametrize("textured", [False, True])
def test_scratched_meshes_get_tangents_from_texture_coordinates(textured):
    builder = Builder()
    builder.png(np.full((1, 1, 3), 200, np.uint8))
    scratches = {"anisotropyStrength": 0.5}
    if textured:
        turned = {"KHR_texture_transform": {"rotation": math.pi / 2}}
        scratches["anisotropyTexture"] = {"index": 0, "extensions": turned}
    builder.add("materials", {"extensions": {ANISOTROPY: scratches}})
    up = np.tile(np.array([[0, 0, 1]], "f"), (4, 1))
    builder.mesh(QUAD, QUAD_INDICES, {"material": 0}, NORMAL=up, TEXCOORD_0=QUAD_UV)
    scene = builder.load()
    assert scene.warnings == ()
    assert (scene.materials[0].anisotropy_texture is not None) == textured
    along = scene.tangents[:, :3]
    assert np.abs(along @ [0.0, 1.0, 0.0] if textured else along @ [1.0, 0.0, 0.0]) == (
        pytest.approx(1)
    )


def layered_quad():
    """A quad with all four textures, none of them of the base material, and a thickness."""
    builder = Builder()
    for shade in range(5):
        builder.png(np.full((1, 1, 3), 40 * shade, np.uint8))
    moved = {"KHR_texture_transform": {"offset": [0.5, 0], "texCoord": 1}}
    builder.add(
        "materials",
        {
            "extensions": {
                TRANSMISSION: {
                    "transmissionFactor": 1,
                    "transmissionTexture": {"index": 3, "texCoord": 1},
                },
                VOLUME: {"thicknessFactor": 1, "thicknessTexture": {"index": 4}},
                CLEARCOAT: {
                    "clearcoatFactor": 1,
                    "clearcoatTexture": {"index": 2},
                    "clearcoatRoughnessTexture": {"index": 1, "extensions": moved},
                    "clearcoatNormalTexture": {"index": 0, "scale": -2000},
                },
                ANISOTROPY: {"anisotropyTexture": {"index": 2}},
            }
        },
    )
    builder.mesh(
        QUAD,
        QUAD_INDICES,
        {"material": 0},
        NORMAL=np.tile(np.array([[0, 0, 1]], "f"), (4, 1)),
        TEXCOORD_0=QUAD_UV,
        TEXCOORD_1=QUAD_UV,
    )
    return builder


def test_textures_of_all_layers_are_found():
    scene = layered_quad().load()
    made = scene.materials[0]
    refs = (
        made.transmission_texture,
        made.clearcoat_texture,
        made.clearcoat_roughness_texture,
        made.clearcoat_normal_texture,
        made.anisotropy_texture,
    )
    assert refs == made.texture_refs()[5:]
    assert [scene.textures[ref.texture].texels[0, 0, 0] for ref in refs] == [120, 80, 40, 0, 80]
    assert [ref.uv_set for ref in refs] == [1, 0, 1, 0, 0]
    assert refs[2].uv_transform[2] == 0.5
    assert made.clearcoat_normal_scale == -1000
    assert scene.warnings == ()


def test_the_thickness_texture_is_not_even_decoded():
    builder = layered_quad()
    builder.tree["images"][4] = {"uri": "data:image/png;base64,AAAA"}
    assert len(builder.load().textures) == 4


def test_tangents_are_made_for_a_coat_that_alone_has_bumps():
    scene = layered_quad().load()
    assert scene.tangents == pytest.approx(np.tile([1, 0, 0, 1], (4, 1)))


def test_a_layer_that_reads_missing_coordinates_is_named():
    builder = layered_quad()
    del builder.tree["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"]
    (warning,) = builder.load().warnings
    assert "no TEXCOORD_1" in warning


OUT_OF_RANGE = {
    "transmissionFactor": ({TRANSMISSION: {"transmissionFactor": 1.5}}, "transmission", 1),
    "thicknessFactor": (
        {TRANSMISSION: {"transmissionFactor": 1}, VOLUME: {"thicknessFactor": -1}},
        "solid",
        False,
    ),
    "attenuationColor": (
        {
            TRANSMISSION: {"transmissionFactor": 1},
            VOLUME: {
                "thicknessFactor": 1,
                "attenuationDistance": 1,
                "attenuationColor": [2, 1, 1],
            },
        },
        "absorption",
        (0, 0, 0),
    ),
    "clearcoatFactor": ({CLEARCOAT: {"clearcoatFactor": -0.5}}, "clearcoat", 0),
    "anisotropyStrength": ({ANISOTROPY: {"anisotropyStrength": -0.5}}, "anisotropy", 0),
    "clearcoatRoughnessFactor": (
        {CLEARCOAT: {"clearcoatRoughnessFactor": 7}},
        "clearcoat_roughness",
        1,
    ),
}


@pytest.mark.parametrize("name", OUT_OF_RANGE)
def test_factors_out_of_range_are_brought_within_and_named(name):
    extensions, field, value = OUT_OF_RANGE[name]
    scene = with_extensions(**extensions).load()
    assert getattr(scene.materials[0], field) == value
    (warning,) = scene.warnings
    assert name in warning and "brought within" in warning


FAULTS = {
    "no distance": ({VOLUME: {"attenuationDistance": 0}}, f"{VOLUME}.attenuationDistance"),
    "negative distance": ({VOLUME: {"attenuationDistance": -1}}, f"{VOLUME}.attenuationDistance"),
    "endless distance": (
        {VOLUME: {"attenuationDistance": math.inf}},
        f"{VOLUME}.attenuationDistance",
    ),
    "four channels": ({VOLUME: {"attenuationColor": [1] * 4}}, f"{VOLUME}.attenuationColor"),
    "word": ({TRANSMISSION: {"transmissionFactor": "1"}}, f"{TRANSMISSION}.transmissionFactor"),
    "NaN": ({CLEARCOAT: {"clearcoatFactor": math.nan}}, f"{CLEARCOAT}.clearcoatFactor"),
    "array": ({CLEARCOAT: []}, CLEARCOAT),
    "thickness texture": (
        {VOLUME: {"thicknessTexture": {"index": 3}}},
        f"{VOLUME}.thicknessTexture.index",
    ),
    "thickness of none": ({VOLUME: {"thicknessTexture": {}}}, f"{VOLUME}.thicknessTexture.index"),
    "transmission texture": (
        {TRANSMISSION: {"transmissionTexture": {"index": 0}}},
        f"{TRANSMISSION}.transmissionTexture.index",
    ),
    "coat texture": (
        {CLEARCOAT: {"clearcoatNormalTexture": {}}},
        f"{CLEARCOAT}.clearcoatNormalTexture.index",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_faulty_layer_is_refused_by_name(name):
    extensions, field = FAULTS[name]
    with pytest.raises(InvalidScene) as raised:
        with_extensions(**extensions).load()
    assert raised.value.field == f"materials[0].extensions.{field}"


def test_unlit_materials_have_no_layers_and_say_so():
    scene = with_extensions(
        KHR_materials_unlit={},
        **{TRANSMISSION: {"transmissionFactor": 1}, CLEARCOAT: {"clearcoatFactor": 1}},
    ).load()
    assert scene.materials[0] == Material(unlit=True)
    assert [line.split()[1] for line in scene.warnings] == [TRANSMISSION, CLEARCOAT]


def test_all_of_them_may_be_required():
    builder = with_extensions(**{TRANSMISSION: {"transmissionFactor": 1}})
    builder.tree["extensionsRequired"] = [TRANSMISSION, VOLUME, CLEARCOAT, "KHR_materials_ior"]
    assert builder.load().materials[0].transmission == 1


@pytest.mark.parametrize("name", ["specular", "sheen", "iridescence", "dispersion"])
def test_what_other_extensions_would_do_to_light_is_named(name):
    (warning,) = with_extensions(**{f"KHR_materials_{name}": {}}).load().warnings
    assert f"KHR_materials_{name} is not supported" in warning
