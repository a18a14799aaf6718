"""Materials, their textures and samplers."""

import math

import numpy as np
import pytest

from raysvc.errors import InvalidInput, InvalidScene, LimitExceeded
from raysvc.limits import Limits
from raysvc.scene import Material, TextureRef
from tests.loading.gltf.building import (
    TRIANGLE,
    Builder,
    data_uri,
    encoded,
    load_text,
    textured,
    triangle_with,
)

PIXELS = np.array([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [9, 99, 199]]], np.uint8)


def material(given):
    return triangle_with(materials=[given]).load().materials[0]


def test_a_primitive_without_a_material_gets_the_default_one():
    builder = Builder(materials=[{"name": "unused"}])
    builder.mesh(TRIANGLE)
    scene = builder.load()
    assert [each.name for each in scene.materials] == ["unused", "default"]
    assert scene.material_of_triangle.tolist() == [1]
    assert material({}) == Material()


def test_all_factors_are_exact():
    made = material(
        {
            "name": "all",
            "pbrMetallicRoughness": {
                "baseColorFactor": [0.001, 0.002, 0.003, 0.5],
                "metallicFactor": 0.25,
                "roughnessFactor": 0.125,
            },
            "emissiveFactor": [0.1, 0.2, 0.3],
            "alphaMode": "MASK",
            "alphaCutoff": 0.75,
            "doubleSided": True,
            "extensions": {
                "KHR_materials_emissive_strength": {"emissiveStrength": 25},
                "KHR_materials_ior": {"ior": 1.33},
                "KHR_materials_unlit": {},
            },
        }
    )
    assert made == Material(
        name="all",
        base_colour=(0.001, 0.002, 0.003, 0.5),
        metallic=0.25,
        roughness=0.125,
        emissive=(0.1 * 25, 0.2 * 25, 0.3 * 25),
        ior=1.33,
        alpha_mode="mask",
        alpha_cutoff=0.75,
        double_sided=True,
        unlit=True,
    )


def test_the_five_textures_of_the_core_are_found_with_their_strengths():
    builder = Builder()
    for shade in range(5):
        builder.png(np.full((1, 1, 3), shade, np.uint8))
    builder.add(
        "materials",
        {
            "pbrMetallicRoughness": {
                "baseColorTexture": {"index": 4},
                "metallicRoughnessTexture": {"index": 3, "texCoord": 1},
            },
            "normalTexture": {"index": 2, "scale": -0.5},
            "occlusionTexture": {"index": 1, "strength": 0.25},
            "emissiveTexture": {"index": 0},
        },
    )
    builder.mesh(
        TRIANGLE,
        more={"material": 0},
        TEXCOORD_0=np.zeros((3, 2), "f"),
        TEXCOORD_1=np.zeros((3, 2), "f"),
    )
    scene = builder.load()
    made = scene.materials[0]
    refs = made.texture_refs()[:5]
    assert [scene.textures[ref.texture].texels[0, 0, 0] for ref in refs] == [4, 3, 2, 1, 0]
    assert [ref.uv_set for ref in refs] == [0, 1, 0, 0, 0]
    assert made.texture_refs()[5:] == (None,) * 5
    assert (made.normal_scale, made.occlusion_strength) == (-0.5, 0.25)
    assert scene.warnings == ()


def test_factors_out_of_range_are_brought_within_and_named():
    builder = triangle_with(
        materials=[
            {
                "pbrMetallicRoughness": {"metallicFactor": 2, "roughnessFactor": -1},
                "emissiveFactor": [-1, 3, 0],
            }
        ]
    )
    scene = builder.load()
    made = scene.materials[0]
    assert (made.metallic, made.roughness, made.emissive) == (1, 0, (0, 3, 0))
    assert len(scene.warnings) == 3


def transformed(**transform):
    builder = triangle_with(
        materials=[textured(texCoord=0, extensions={"KHR_texture_transform": transform})]
    )
    builder.png(PIXELS)
    return builder.load().materials[0].base_colour_texture


def test_texture_transforms_rotate_as_khronos_test_model_shows():
    assert transformed() == TextureRef(0)
    made = transformed(offset=[0.1, 0.2], rotation=0.3, scale=[2, 3], texCoord=1)
    cos, sin = math.cos(0.3), math.sin(0.3)
    assert made.uv_set == 1
    assert made.uv_transform == pytest.approx((2 * cos, 3 * sin, 0.1, -2 * sin, 3 * cos, 0.2))


def test_higher_texture_coordinate_sets_are_left_out_and_named():
    builder = triangle_with(materials=[textured(texCoord=2)])
    builder.png(PIXELS)
    scene = builder.load()
    assert scene.materials[0].base_colour_texture is None
    assert "TEXCOORD_2" in scene.warnings[0]


def test_a_material_that_reads_missing_coordinates_is_named():
    builder = triangle_with(materials=[textured(texCoord=1)])
    builder.png(PIXELS)
    assert "no TEXCOORD_1" in builder.load().warnings[0]


def test_samplers_make_several_textures_of_one_image():
    builder = Builder(
        samplers=[
            {"wrapS": 33071, "wrapT": 33648, "magFilter": 9728, "minFilter": 9987},
            {"magFilter": 9729},
        ],
        images=[{"uri": data_uri(encoded(PIXELS), "image/png")}],
        textures=[
            {"source": 0, "sampler": 0, "name": "a"},
            {"source": 0},
            {"source": 0, "sampler": 1},
        ],
        materials=[textured(0), textured(1), textured(2), textured(0)],
    )
    builder.mesh(TRIANGLE)
    scene = builder.load()
    first, second, third = scene.textures
    assert (first.wrap_u, first.wrap_v, first.nearest, first.name) == ("clamp", "mirror", True, "a")
    assert (second.wrap_u, second.wrap_v, second.nearest) == ("repeat", "repeat", False)
    assert not third.nearest
    assert first.texels is second.texels
    assert [m.base_colour_texture.texture for m in scene.materials[:4]] == [0, 1, 2, 0]
    assert np.array_equal(first.texels[..., :3], PIXELS)


def image_document(image, **more):
    builder = Builder(images=[image], textures=[{"source": 0}], materials=[textured()], **more)
    builder.mesh(TRIANGLE, more={"material": 0})
    return builder


def test_images_come_from_buffer_views_data_uris_and_encoded_names():
    png = encoded(PIXELS)
    inside = image_document({})
    inside.tree["images"][0] = {"bufferView": inside.view(png), "mimeType": "image/png"}
    quoted = "data:image/png," + "".join(f"%{byte:02x}" for byte in png)
    beside = image_document({"uri": "a%20folder/%C3%A4.png"})
    beside.files["a folder/ä.png"] = png
    for builder in (inside, image_document({"uri": quoted}), beside):
        assert np.array_equal(builder.load().textures[0].texels[..., :3], PIXELS)


def test_webp_is_preferred_and_works_without_a_fallback():
    lossless = encoded(PIXELS, "WEBP", lossless=True)
    builder = image_document({"uri": data_uri(b"broken", "image/png")})
    builder.tree["textures"] = [{"source": 0, "extensions": {"EXT_texture_webp": {"source": 1}}}]
    builder.add("images", {"uri": data_uri(lossless, "image/webp")})
    builder.tree["extensionsRequired"] = ["EXT_texture_webp"]
    assert np.array_equal(builder.load().textures[0].texels[..., :3], PIXELS)


def test_a_texture_that_cannot_be_read_is_left_out_and_named():
    builder = image_document({})
    builder.tree["textures"] = [{"extensions": {"KHR_texture_basisu": {"source": 0}}}]
    scene = builder.load()
    assert scene.materials[0].base_colour_texture is None
    assert "KHR_texture_basisu" in scene.warnings[0]
    assert "left out" in scene.warnings[1]


def test_an_oversized_image_is_refused_before_it_is_decoded():
    builder = image_document({"uri": data_uri(encoded(np.zeros((99, 99), np.uint8)), "x/y")})
    for limits in (Limits(max_texture_pixels=99 * 98), Limits(max_scene_texture_pixels=99 * 98)):
        with pytest.raises(LimitExceeded) as raised:
            builder.load(limits)
        assert raised.value.field == "images[0]"


def slot(**info):
    builder = triangle_with(materials=[textured(**info)])
    builder.png(PIXELS)
    return builder


def with_sampler(**sampler):
    builder = slot()
    builder.tree["textures"][0]["sampler"] = 0
    builder.tree["samplers"] = [sampler]
    return builder


PBR = "materials[0].pbrMetallicRoughness"
FAULTS = {
    "alpha mode": (triangle_with(materials=[{"alphaMode": "GLASS"}]), "materials[0].alphaMode"),
    "ior": (
        triangle_with(materials=[{"extensions": {"KHR_materials_ior": {"ior": 0.5}}}]),
        "materials[0].extensions.KHR_materials_ior.ior",
    ),
    "three channels": (
        triangle_with(materials=[{"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1]}}]),
        f"{PBR}.baseColorFactor",
    ),
    "NaN": (
        triangle_with(materials=[{"pbrMetallicRoughness": {"roughnessFactor": math.nan}}]),
        f"{PBR}.roughnessFactor",
    ),
    "material": (triangle_with(), "meshes[0].primitives[0].material"),
    "texture": (slot(texture=1), f"{PBR}.baseColorTexture.index"),
    "negative texture": (slot(texture=-1), f"{PBR}.baseColorTexture.index"),
    "negative set": (slot(texCoord=-1), f"{PBR}.baseColorTexture.texCoord"),
    "transform": (
        slot(extensions={"KHR_texture_transform": {"scale": [1]}}),
        f"{PBR}.baseColorTexture.extensions.KHR_texture_transform.scale",
    ),
    "wild transform": (
        slot(extensions={"KHR_texture_transform": {"scale": [1e300, 1]}}),
        f"{PBR}.baseColorTexture.extensions.KHR_texture_transform",
    ),
    "no index": (
        triangle_with(materials=[{"normalTexture": {"scale": 1}}]),
        "materials[0].normalTexture.index",
    ),
    "wrap": (with_sampler(wrapS=1), "samplers[0].wrapS"),
    "filter": (with_sampler(magFilter=9987), "samplers[0].magFilter"),
    "no bytes": (image_document({}), "images[0]"),
    "garbage": (image_document({"uri": data_uri(b"GIF89a", "image/gif")}), "images[0]"),
    "cut off": (image_document({"uri": data_uri(encoded(PIXELS)[:45], "x/y")}), "images[0]"),
    "missing": (image_document({"uri": "a.png"}), "images[0].uri"),
    "URL": (image_document({"uri": "https://example.org/a.png"}), "images[0].uri"),
    "outside": (image_document({"uri": "%2e%2e/a.png"}), "images[0].uri"),
    "view": (image_document({"bufferView": 7, "mimeType": "image/png"}), "images[0].bufferView"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_faulty_material_or_image_is_refused_by_name(name):
    builder, field = FAULTS[name]
    with pytest.raises(InvalidInput) as raised:
        builder.load()
    assert raised.value.field == field


def test_the_source_and_sampler_of_a_texture_must_exist():
    for key in ("source", "sampler"):
        builder = slot()
        builder.tree["textures"][0][key] = 5
        with pytest.raises(InvalidScene) as raised:
            builder.load()
        assert raised.value.field == f"textures[0].{key}"


def test_unsupported_material_extensions_are_named_once():
    sheen = {"extensions": {"KHR_materials_sheen": {}}}
    builder = Builder(materials=[sheen] * 9)
    builder.mesh(TRIANGLE)
    (warning,) = builder.load().warnings
    assert "KHR_materials_sheen is not supported" in warning
    assert "materials[0]" in warning and "6 more" in warning


def test_too_many_materials_are_refused():
    with pytest.raises(LimitExceeded):
        load_text(triangle_with(materials=[{}] * 9).text(), limits=Limits(max_materials=8))
