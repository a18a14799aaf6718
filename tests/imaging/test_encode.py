"""What is encoded can be read back, and the same arrays give the same bytes."""

import io
import time
import zipfile

import numpy as np
import OpenEXR
import OpenImageIO
import pytest
from PIL import Image

from raysvc.errors import InvalidInput
from raysvc.imaging.encode import (
    encode_hdr,
    encode_jpeg,
    encode_png,
    encode_png16,
    encode_webp,
)
from raysvc.imaging.encode_layers import encode_exr, encode_npz
from raysvc.imaging.layer_picture import layer_picture
from raysvc.loading import load_environment

SIZE = (37, 53)


@pytest.fixture
def layers(rng):
    ids = rng.integers(-1, 50, SIZE).astype(np.int32)
    depth = np.where(ids < 0, np.inf, rng.random(SIZE) * 9).astype(np.float32)
    return {
        "beauty": (rng.random((*SIZE, 4)) * 10).astype(np.float32),
        "depth": depth,
        "normal": rng.normal(size=(*SIZE, 3)).astype(np.float32),
        "albedo": rng.random((*SIZE, 3)).astype(np.float32),
        "id": ids,
    }


def smooth_picture(channels):
    y, x = np.mgrid[: SIZE[0], : SIZE[1]]
    planes = [x * 4, y * 6, (x + y) * 2, 255 - x][:channels]
    return np.stack(planes, axis=-1).astype(np.uint8)


def opened(data):
    with Image.open(io.BytesIO(data)) as image:
        return image.format, np.asarray(image)


@pytest.mark.parametrize("channels", [3, 4])
def test_png_keeps_every_bit(channels, rng):
    picture = rng.integers(0, 256, (*SIZE, channels), dtype=np.uint8)
    kind, back = opened(encode_png(picture))
    assert kind == "PNG"
    assert np.array_equal(back, picture)


@pytest.mark.parametrize("channels", [3, 4])
def test_png_of_sixteen_bits_keeps_every_bit(channels, rng, tmp_path):
    picture = rng.integers(0, 65536, (*SIZE, channels), dtype=np.uint16)
    path = tmp_path / "picture.png"
    path.write_bytes(encode_png16(picture))
    plain = OpenImageIO.ImageSpec()
    plain.attribute("oiio:UnassociatedAlpha", 1)
    reader = OpenImageIO.ImageInput.open(str(path), plain)
    back = reader.read_image(OpenImageIO.UINT16)
    reader.close()
    assert np.array_equal(back, picture)


@pytest.mark.parametrize("encode", [encode_jpeg, encode_webp])
def test_lossy_formats_stay_close(encode):
    picture = smooth_picture(3)
    _, back = opened(encode(picture))
    assert np.abs(back.astype(int) - picture).mean() < 3


def test_webp_keeps_alpha_exactly():
    picture = smooth_picture(4)
    _, back = opened(encode_webp(picture))
    assert np.array_equal(back[..., 3], picture[..., 3])


def test_jpeg_shows_what_is_transparent_as_black():
    picture = np.full((8, 8, 4), 200, np.uint8)
    picture[..., 3] = 0
    assert opened(encode_jpeg(picture))[1].max() <= 1


def read_exr(data):
    with OpenEXR.File(io.BytesIO(data), separate_channels=True) as file:
        return {name: channel.pixels for name, channel in file.channels().items()}


def test_exr_keeps_every_layer_to_the_bit(layers):
    channels = read_exr(encode_exr(layers))
    for i, name in enumerate("RGBA"):
        assert np.array_equal(channels[name], layers["beauty"][..., i])
    for i, name in enumerate("XYZ"):
        assert np.array_equal(channels[f"normal.{name}"], layers["normal"][..., i])
    for i, name in enumerate("RGB"):
        assert np.array_equal(channels[f"albedo.{name}"], layers["albedo"][..., i])
    assert np.array_equal(channels["depth.Z"], layers["depth"])
    assert channels["id.I"].dtype == np.uint32
    assert np.array_equal(channels["id.I"].astype(np.int32), layers["id"])
    assert len(channels) == 4 + 3 + 3 + 1 + 1


def test_exr_in_half_rounds_colour_but_not_depth_or_id(layers):
    layers["beauty"][0, 0] = 1e9
    channels = read_exr(encode_exr(layers, half=True))
    assert channels["R"].dtype == np.float16
    assert channels["R"][0, 0] == 65504
    assert np.allclose(channels["G"][1:], layers["beauty"][1:, :, 1], rtol=1e-3)
    assert np.array_equal(channels["depth.Z"], layers["depth"])
    assert channels["id.I"].dtype == np.uint32


def test_npz_keeps_every_layer_to_the_bit(layers):
    with np.load(io.BytesIO(encode_npz(layers))) as back:
        assert set(back) == set(layers)
        for name, array in layers.items():
            assert np.array_equal(back[name], array)


def test_the_same_arrays_give_the_same_bytes_at_another_time(layers, monkeypatch):
    picture = smooth_picture(4)
    encoders = [
        lambda: encode_png(picture),
        lambda: encode_png16(picture.astype(np.uint16) * 257),
        lambda: encode_jpeg(picture),
        lambda: encode_webp(picture),
        lambda: encode_exr(layers),
        lambda: encode_npz(layers),
    ]
    before = [encode() for encode in encoders]
    now = time.time()
    monkeypatch.setattr(time, "time", lambda: now + 1e6)
    assert [encode() for encode in encoders] == before


def test_files_carry_no_date_and_no_machine(layers):
    with zipfile.ZipFile(io.BytesIO(encode_npz(layers))) as archive:
        assert {info.date_time for info in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
    with OpenEXR.File(io.BytesIO(encode_exr(layers))) as file:
        assert not {"capDate", "owner", "comments", "software"} & set(file.header())
    png = encode_png16(smooth_picture(3).astype(np.uint16))
    assert b"tIME" not in png and b"tEXt" not in png and b"Software" not in png


def test_layers_of_different_sizes_are_refused(layers):
    layers["depth"] = layers["depth"][1:]
    with pytest.raises(InvalidInput, match="one size"):
        encode_exr(layers)


def test_a_layer_with_no_channel_names_is_refused_by_name(layers):
    layers["normal"] = layers["beauty"]
    with pytest.raises(InvalidInput, match="normal: no channels"):
        encode_exr(layers)


def test_layers_can_be_looked_at(layers):
    for name, array in layers.items():
        picture = layer_picture(name, array)
        assert picture.shape == (*SIZE, 3) and picture.dtype == np.uint8
    assert np.all(layer_picture("id", layers["id"])[layers["id"] < 0] == 0)
    assert layer_picture("id", layers["id"])[layers["id"] >= 0].min() >= 64


def test_depth_is_brightest_where_it_is_nearest():
    shown = layer_picture("depth", np.float32([[1.0, 2.0, 3.0, np.inf]]))
    assert shown[0, :, 0].tolist() == [255, 140, 26, 0]


def test_normals_are_shown_around_grey():
    shown = layer_picture("normal", np.float32([[[0, 0, 1], [-1, 0, 0]]]))
    assert shown[0].tolist() == [[128, 128, 255], [0, 128, 128]]


@pytest.mark.parametrize("size", [(3, 5), (16, 40)])
def test_a_radiance_file_keeps_radiance_to_its_shared_exponent(rng, size):
    radiance = (10.0 ** rng.uniform(-3, 5, (*size, 3))).astype(np.float32)
    data = encode_hdr(radiance)
    assert data == encode_hdr(radiance.copy())
    found = load_environment({"light.hdr": data}).radiance
    step = radiance.max(axis=2, keepdims=True) / 128
    assert (np.abs(found - radiance) <= step).all()
