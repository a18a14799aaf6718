"""Decoding pictures for textures."""

import warnings
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from raysvc.errors import InvalidInput, InvalidScene, LimitExceeded
from raysvc.loading.images import decode_image
from tests.loading.gltf.building import encoded

GREY = np.array([[0, 64], [128, 255]], np.uint8)


def decoded(data, max_pixels=1 << 20):
    return decode_image(data, max_pixels, "images[0]")


@pytest.mark.parametrize("mode", ["1", "L", "LA", "P", "RGB", "RGBA", "I;16"])
def test_every_mode_of_png_becomes_8_bit_rgba(mode):
    rgba = np.dstack([GREY, GREY, GREY, np.full_like(GREY, 255)])
    if mode == "I;16":
        image = Image.fromarray(GREY.astype(np.uint16) * 257)
    else:
        image = Image.fromarray(rgba).convert(mode)
    made = decoded(encoded(image))
    assert made.dtype == np.uint8 and made.shape == (2, 2, 4)
    expected = rgba if mode != "1" else np.asarray(image.convert("RGBA"))
    assert np.array_equal(made, expected)


def test_transparent_colours_and_palettes_keep_their_alpha():
    image = Image.fromarray(GREY).convert("P")
    made = decoded(encoded(image, transparency=0))
    assert made[..., 3].tolist() == [[0, 255], [255, 255]]


def test_jpeg_in_all_its_colour_models():
    for mode in ("L", "RGB", "CMYK"):
        made = decoded(encoded(Image.new("RGB", (8, 8), (90, 90, 90)).convert(mode), "JPEG"))
        assert np.abs(made[..., :3].astype(int) - 90).max() <= 3
        assert (made[..., 3] == 255).all()


@pytest.mark.parametrize("lossless", [True, False])
@pytest.mark.parametrize("mode", ["RGB", "RGBA"])
def test_webp_is_decoded_and_bounded(mode, lossless):
    data = encoded(Image.new(mode, (40, 30), "red"), "WEBP", lossless=lossless)
    assert decoded(data).shape == (30, 40, 4)
    with pytest.raises(LimitExceeded, match="40 x 30"):
        decoded(data, 40 * 30 - 1)


@pytest.mark.parametrize("kind", ["PNG", "JPEG"])
def test_the_number_of_pixels_is_bounded(kind):
    data = encoded(Image.new("RGB", (40, 30)), kind)
    assert decoded(data, 40 * 30).shape == (30, 40, 4)
    with pytest.raises(LimitExceeded):
        decoded(data, 40 * 30 - 1)


def test_other_formats_are_not_tried():
    with pytest.raises(InvalidScene, match="none of PNG"):
        decoded(encoded(Image.new("RGB", (4, 4)), "BMP"))
    assert decode_image(encoded(Image.new("RGB", (4, 4)), "BMP"), 99, "x", ("BMP",)).any()


@pytest.mark.parametrize("kind", ["PNG", "JPEG", "WEBP"])
def test_damaged_pictures_never_raise_anything_else(kind, rng):
    whole = encoded(rng.integers(0, 255, (20, 20, 3), np.uint8), kind)
    for _ in range(150):
        damaged = bytearray(whole[: rng.integers(len(whole))] if rng.random() < 0.3 else whole)
        for at in rng.integers(0, max(len(damaged), 1), 4):
            if damaged:
                damaged[at] = rng.integers(256)
        try:
            decoded(bytes(damaged))
        except InvalidInput as error:
            assert error.field == "images[0]"


@pytest.mark.assets
def test_hostile_pictures_are_decoded_or_refused(assets: Path):
    names = [
        p
        for p in sorted((assets / "hostile/oiio").iterdir())
        if p.suffix in (".png", ".jpg", ".webp")
    ]
    assert len(names) > 10
    for path in names:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            try:
                decode_image(path.read_bytes(), 8192 * 8192, "images[0]")
                assert "bomb" not in path.name
            except InvalidInput as error:
                assert error.field == "images[0]"
