"""MTL materials as metallic-roughness materials."""

import io

import numpy as np
import pytest
from PIL import Image

from raysvc.errors import LimitExceeded
from raysvc.limits import DEFAULT_LIMITS, Limits
from raysvc.loading.files import Files
from raysvc.loading.mtl import MaterialLibrary
from raysvc.scene import Material


def picture(width: int, height: int, alpha: int = 255, kind: str = "PNG") -> bytes:
    buffer = io.BytesIO()
    mode = "RGBA" if kind == "PNG" else "RGB"
    Image.new(mode, (width, height), (10, 20, 30, alpha)[: len(mode)]).save(buffer, kind)
    return buffer.getvalue()


def library(text: str, limits: Limits = DEFAULT_LIMITS, **side: bytes) -> MaterialLibrary:
    files = {"a.obj": b"", "a.mtl": text.encode("latin-1")}
    files |= {name.replace("_", "."): data for name, data in side.items()}
    made = MaterialLibrary(Files.from_memory(files, "a.obj"), limits)
    made.read("a.mtl")
    return made


def material(text: str, **side: bytes) -> Material:
    return library(f"newmtl m\n{text}\n", **side).materials["m"]


def test_the_diffuse_colour_is_the_base_colour_and_taken_as_srgb():
    made = material("Kd 1 0.5 0")
    assert made.base_colour == pytest.approx((1, 0.21404, 0, 1), abs=1e-4)
    assert made.metallic == 0
    assert made.double_sided


def test_sharper_highlights_are_smoother():
    assert material("illum 2\nNs 0").roughness == pytest.approx(1.0)
    assert material("Ns 30").roughness == pytest.approx(0.5)
    assert material("Ns 1000").roughness == pytest.approx((2 / 1002) ** 0.25)
    assert material("illum 1\nNs 1000").roughness == 1.0


@pytest.mark.parametrize("model", [6, 7])
def test_illumination_models_that_refract_are_named_and_blend(model):
    made = library(f"newmtl m\nd 0.25\nNi 1.33\nillum {model}")
    assert made.materials["m"].alpha_mode == "blend"
    assert made.materials["m"].transmission == 0
    assert made.warnings == [f"material m: illum {model} refracts, which is not shown"]
    assert library("newmtl m\nd 0.25\nillum 9").warnings == []


def test_a_black_diffuse_colour_with_a_bright_highlight_is_a_metal():
    made = material("Kd 0 0 0\nKs 1 1 1\nNs 500")
    assert made.metallic == 1
    assert made.base_colour == (1, 1, 1, 1)


@pytest.mark.parametrize("text", ["d 0.25", "Tr 0.75", "d -halo 0.25"])
def test_dissolve_and_transparency_blend(text):
    made = material(f"Kd 1 1 1\n{text}")
    assert made.base_colour[3] == pytest.approx(0.25)
    assert made.alpha_mode == "blend"


def test_physically_based_keys_win():
    made = material("Ns 3\nPr 0.2\nPm 0.7\nKe 0 1 0\nNi 1.33")
    assert (made.roughness, made.metallic, made.ior) == (0.2, 0.7, 1.33)
    assert made.emissive == (0, 1, 0)


@pytest.mark.parametrize("ior", ["0", "1", "1e9"])
def test_impossible_indices_of_refraction_are_left_out(ior):
    assert material(f"Ni {ior}").ior == 1.5


def test_textures_are_decoded_once_and_shared():
    made = library(
        "newmtl a\nKd 0 0 0\nmap_Kd t.png\nnewmtl b\nmap_Kd t.png\nmap_Ke t.png\nnorm t.png\n",
        t_png=picture(4, 2),
    )
    assert len(made.textures) == 1
    assert made.textures[0].texels.shape == (2, 4, 4)
    assert made.materials["a"].base_colour == (1, 1, 1, 1)
    assert made.materials["b"].normal_texture is not None
    assert made.materials["b"].emissive == (1, 1, 1)
    assert made.warnings == []


def test_a_texture_with_holes_is_cut_out():
    assert material("map_Kd t.png", t_png=picture(1, 1, alpha=0)).alpha_mode == "mask"
    assert material("map_Kd t.png", t_png=picture(1, 1)).alpha_mode == "opaque"


def test_options_of_maps_are_understood():
    made = library(
        "newmtl m\nmap_Kd -blendu on -s 2 3 1 -o 0.5 0.25 -clamp on -mm 0 1 my wood.png\n",
        **{"my wood_png": picture(1, 1)},
    )
    ref = made.materials["m"].base_colour_texture
    assert ref is not None
    assert made.textures[ref.texture].wrap_u == "clamp"
    # In MTL u' = 2 u + 0.5 and w' = 3 w + 0.25 with w = 1 - v counted from the bottom.
    a, b, c, d, e, f = ref.uv_transform
    for u, w in np.random.default_rng(3).random((5, 2)):
        v = 1 - w
        assert a * u + b * v + c == pytest.approx(2 * u + 0.5)
        assert d * u + e * v + f == pytest.approx(1 - (3 * w + 0.25))


def test_paths_of_other_machines_are_looked_for_beside_the_scene():
    made = library("newmtl m\nmap_Kd C:\\Users\\me\\t.png\n", t_png=picture(1, 1))
    assert made.materials["m"].base_colour_texture is not None


def test_what_is_missing_damaged_or_not_used_is_warned_of():
    made = library(
        "newmtl m\nmap_Kd gone.png\nmap_Ke bad.png\nmap_Bump b.png\nNs many\nKd 1 nan 0\n",
        bad_png=b"not a picture",
    )
    said = " ".join(made.warnings)
    for what in ("gone.png is missing", "bad.png", "map_bump is not used", "ns many", "kd 1 nan 0"):
        assert what in said


def test_tga_and_bmp_textures_are_read():
    for kind in ("BMP", "TGA"):
        ref = material(
            f"map_Kd t.{kind.lower()}", **{f"t_{kind.lower()}": picture(2, 2, 255, kind)}
        )
        assert ref.base_colour_texture is not None


def test_textures_and_materials_are_limited():
    with pytest.raises(LimitExceeded):
        library("newmtl m\nmap_Kd t.png\n", Limits(max_texture_pixels=10), t_png=picture(4, 4))
    with pytest.raises(LimitExceeded):
        library(
            "newmtl m\nmap_Kd t.png\nmap_Ke u.png\n",
            Limits(max_scene_texture_pixels=20),
            t_png=picture(4, 4),
            u_png=picture(4, 4),
        )
    with pytest.raises(LimitExceeded):
        library("".join(f"newmtl m{n}\n" for n in range(9)), Limits(max_materials=4))


def test_names_may_have_spaces_and_other_letters():
    assert "Grün hell" in library("# c\n\tnewmtl Grün hell\n  Kd 0 1 0\n").materials
