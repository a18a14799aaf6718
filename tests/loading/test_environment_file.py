"""Environment maps: right way round, finite, and refused clearly."""

import time
from pathlib import Path

import numpy as np
import OpenEXR
import pytest

from raysvc.builtin import BUILTIN_ENVIRONMENTS
from raysvc.errors import InvalidEnvironment, InvalidInput, LimitExceeded, NotFound, Unsupported
from raysvc.limits import Limits
from raysvc.loading import load_environment
from raysvc.loading.environment_file import MAX_RADIANCE
from raysvc.loading.files import Files
from raysvc.scene import Environment


def hdr(pixels: np.ndarray, axes: str = "-Y {height} +X {width}") -> bytes:
    """Flat Radiance file of (H, W, 4) uint8 RGBE pixels in the order given."""
    height, width = pixels.shape[:2]
    head = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n{axes.format(height=height, width=width)}\n"
    return head.encode() + pixels.astype(np.uint8).tobytes()


def numbered(height: int, width: int) -> np.ndarray:
    """RGBE pixels whose red counts rows and whose green counts columns, as multiples of 1/128."""
    rows, columns = np.indices((height, width))
    return np.stack([rows + 1, columns + 1, np.full_like(rows, 128), np.full_like(rows, 129)], 2)


def decoded(rgbe: np.ndarray) -> np.ndarray:
    return (rgbe[..., :3] / 128.0).astype(np.float32)


@pytest.fixture
def exr(tmp_path: Path):
    """Make an OpenEXR file of channels, and read it as an environment."""

    def load(channels: dict[str, np.ndarray], **header: object) -> Environment:
        path = tmp_path / "made.exr"
        OpenEXR.File(
            {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage, **header},
            channels,
        ).write(str(path))
        return load_environment(path)

    return load


def test_a_radiance_file_is_decoded_exactly():
    pixels = numbered(4, 8)
    environment = load_environment({"a.hdr": hdr(pixels)})
    assert np.array_equal(environment.radiance, decoded(pixels))
    assert environment.name == "a"
    assert environment.warnings == ()


@pytest.mark.parametrize(
    ("axes", "upright"),
    [
        ("+Y {height} +X {width}", lambda p: p[::-1]),
        ("-Y {height} -X {width}", lambda p: p[:, ::-1]),
        ("+Y {height} -X {width}", lambda p: p[::-1, ::-1]),
        ("+X {height} -Y {width}", lambda p: p.transpose(1, 0, 2)),
        ("-X {height} -Y {width}", lambda p: p[::-1].transpose(1, 0, 2)),
        ("+X {height} +Y {width}", lambda p: p[:, ::-1].transpose(1, 0, 2)),
        ("-X {height} +Y {width}", lambda p: p[::-1, ::-1].transpose(1, 0, 2)),
    ],
)
def test_scanlines_in_any_order_are_turned_upright(axes, upright):
    pixels = numbered(4, 8) if "Y {height}" in axes else numbered(8, 4)
    environment = load_environment({"a.hdr": hdr(pixels, axes)})
    assert np.array_equal(environment.radiance, upright(decoded(pixels)))


def test_absurdly_bright_pixels_are_clamped_with_a_warning():
    pixels = numbered(2, 4)
    pixels[0, 0] = 255
    environment = load_environment({"a.hdr": hdr(pixels)})
    assert environment.radiance.max() == np.float32(MAX_RADIANCE)
    assert np.isfinite(environment.radiance.sum(dtype=np.float32))
    assert "3 values were above" in environment.warnings[0]


def test_a_map_that_is_not_two_to_one_is_warned_of():
    environment = load_environment({"a.hdr": hdr(numbered(4, 4))})
    assert "4 x 4 is not 2:1" in environment.warnings[0]


def test_xyz_pixels_are_refused_by_name():
    data = hdr(numbered(2, 4)).replace(b"rle_rgbe", b"rle_xyze")
    with pytest.raises(Unsupported, match=r"a\.hdr.*XYZ"):
        load_environment({"a.hdr": data})


@pytest.mark.parametrize("dtype", [np.float16, np.float32])
@pytest.mark.parametrize("layout", ["RGB", "RGBA", "separate", "layer", "Y", "one"])
def test_all_layouts_of_exr_channels_are_read(exr, rng, dtype, layout):
    rgb = rng.random((4, 8, 3)).astype(dtype)
    grey = np.repeat(rgb[..., :1], 3, axis=2)
    alpha = np.ones((4, 8, 1), dtype)
    channels, expected = {
        "RGB": ({"RGB": rgb}, rgb),
        "RGBA": ({"RGBA": np.concatenate([rgb, alpha], 2)}, rgb),
        "separate": ({c: np.ascontiguousarray(rgb[..., i]) for i, c in enumerate("RGB")}, rgb),
        "layer": (
            {f"sky.{c}": np.ascontiguousarray(rgb[..., i]) for i, c in enumerate("RGB")},
            rgb,
        ),
        "Y": ({"Y": np.ascontiguousarray(rgb[..., 0])}, grey),
        "one": ({"radiance": np.ascontiguousarray(rgb[..., 0])}, grey),
    }[layout]
    environment = exr(channels)
    assert environment.radiance.dtype == np.float32
    assert np.array_equal(environment.radiance, expected.astype(np.float32))
    assert environment.warnings == ()


def test_the_main_layer_wins_over_others(exr, rng):
    main, other = rng.random((2, 2, 4, 3)).astype(np.float32)
    channels = {}
    for i, c in enumerate("RGB"):
        channels[c] = np.ascontiguousarray(main[..., i])
        channels[f"AO.{c}"] = np.ascontiguousarray(other[..., i])
    assert np.array_equal(exr(channels).radiance, main)


def test_without_the_attribute_an_exr_file_is_not_turned(exr, rng):
    rgb = rng.random((4, 8, 3)).astype(np.float32)
    assert np.array_equal(exr({"RGB": rgb}).radiance, rgb)


def test_openexrs_own_lat_long_maps_are_turned_so_that_plus_z_is_behind(exr):
    # ImfEnvmap.h: the centre column is +Z, and +X a quarter of the width to the left of it.
    rgb = np.zeros((8, 16, 3), np.float32)
    rgb[:, 8], rgb[:, 4] = (0, 0, 1), (1, 0, 0)
    turned = exr({"RGB": rgb}, envmap=OpenEXR.ENVMAP_LATLONG).radiance
    assert np.all(turned[:, 0] == (0, 0, 1))
    assert np.all(turned[:, 12] == (1, 0, 0))


def test_a_cube_map_is_unsupported(exr):
    rgb = np.zeros((12, 2, 3), np.float32)
    with pytest.raises(Unsupported, match="cube"):
        exr({"RGB": rgb}, envmap=OpenEXR.ENVMAP_CUBE)


def test_values_that_are_no_radiance_are_replaced_with_a_warning(exr):
    rgb = np.ones((2, 4, 3), np.float32)
    rgb[0, 0], rgb[0, 1, 0], rgb[1, 1, 2] = -1.0, np.nan, np.inf
    environment = exr({"RGB": rgb})
    assert np.all(environment.radiance[0, 0] == 0)
    assert environment.radiance[0, 1].tolist() == [0, 1, 1]
    assert environment.radiance[1, 1].tolist() == [1, 1, np.float32(MAX_RADIANCE)]
    assert len(environment.warnings) == 3


def test_channels_that_are_no_colour_are_refused(exr):
    with pytest.raises(InvalidEnvironment, match="neither R, G and B nor Y"):
        exr({name: np.zeros((2, 4), np.float32) for name in ("U", "V")})


def test_maps_larger_than_the_limit_are_refused_before_decoding(exr, tmp_path):
    exr({"RGB": np.zeros((8, 16, 3), np.float32)})
    small = Limits(max_environment_pixels=100)
    with pytest.raises(LimitExceeded, match=r"16 x 8.*100"):
        load_environment(tmp_path / "made.exr", small)
    with pytest.raises(LimitExceeded, match=r"16 x 8.*100"):
        load_environment({"a.hdr": hdr(numbered(8, 16))}, small)


@pytest.mark.parametrize("name", sorted(BUILTIN_ENVIRONMENTS))
def test_built_in_environments_are_found_by_name(name):
    assert load_environment(f"builtin:{name}").name == name


def test_an_unknown_name_is_answered_with_the_names_that_there_are():
    with pytest.raises(NotFound, match="clear_sky, studio, gradient"):
        load_environment("builtin:nowhere")


@pytest.mark.parametrize(
    "data", [b"", b"hello", b"#?RADIANCE\n", b"\x76\x2f\x31\x01", b"\x76\x2f\x31\x01" + b"\0" * 99]
)
def test_what_is_no_environment_is_refused_by_name(data):
    with pytest.raises(InvalidEnvironment, match=r"a\.hdr"):
        load_environment({"a.hdr": data})


def test_every_truncation_of_a_file_is_refused_or_read(exr, tmp_path):
    exr({"RGB": np.ones((4, 8, 3), np.float32)})
    whole = (tmp_path / "made.exr").read_bytes()
    for length in range(0, len(whole), 7):
        with pytest.raises(InvalidInput):
            load_environment({"a.exr": whole[:length]})


def test_a_missing_file_and_several_files_are_refused(tmp_path):
    with pytest.raises(InvalidEnvironment, match="missing"):
        load_environment(tmp_path / "none.hdr")
    with pytest.raises(InvalidEnvironment, match="one file"):
        load_environment({"a.hdr": b"", "b.hdr": b""})


def test_files_in_memory_are_taken():
    files = Files.from_memory({"x/a.hdr": hdr(numbered(2, 4))}, "x/a.hdr")
    assert load_environment(files).radiance.shape == (2, 4, 3)


@pytest.mark.assets
def test_the_labels_of_openexrs_orientation_map_come_out_right(assets):
    environment = load_environment(assets / "hdr" / "OrientationLatLong.exr")
    dark = environment.radiance.max(axis=2) < 0.3
    # The axes are drawn as an L: Y upwards from the label's middle, and X or Z to one side.
    for column, sign in ((512, 1), (256, -1), (768, 1)):
        near = dark[250:260, column - 60 : column + 61].any(axis=0)
        right, left = near[62:].mean(), near[:59].mean()
        assert (right > 0.8 > left) if sign > 0 else (left > 0.8 > right)


@pytest.mark.assets
@pytest.mark.parametrize("folder", ["hdr"])
def test_real_maps_load(assets, folder):
    for path in sorted((assets / folder).iterdir()):
        environment = load_environment(path)
        assert environment.radiance.shape == (512, 1024, 3)
        assert environment.warnings == ()


@pytest.mark.assets
def test_hostile_maps_are_refused_or_read_in_little_time(assets):
    loaded = set()
    for path in [
        *sorted((assets / "hostile" / "crafted").glob("*.hdr")),
        *sorted((assets / "hostile" / "oiio").iterdir()),
    ]:
        start = time.perf_counter()
        try:
            load_environment(path)
            loaded.add(path.name)
        except InvalidInput as error:
            assert path.name in str(error)
        assert time.perf_counter() - start < 2.0
    assert loaded == {
        "hdr_exp255.hdr",
        "hdr_flat_ok.hdr",
        "hdr_flipped_axes.hdr",
        "seed.exr",
        "seed.hdr",
    }
