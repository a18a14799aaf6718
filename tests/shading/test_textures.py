"""Textures against a slow reader: wrapping, filters, sizes."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from raysvc.scene import Material, Texture, TextureRef
from raysvc.shading.scene_tables import TEXTURE_FILTERS, SceneTables
from tests.oracles import texture as slow
from tests.scenes import chequered, quad
from tests.shading.reading import at_uv, square_pixels

WRAPS = ("repeat", "clamp", "mirror")
SEEDS = st.integers(0, 2**32 - 1)
BASE = Material(base_colour_texture=TextureRef(0), alpha_mode="blend")
DATA = Material(emissive=(1, 1, 1), occlusion_texture=TextureRef(0), occlusion_strength=1.0)


def textured(texels, wrap_u="repeat", wrap_v="repeat", nearest=False, material=BASE, **more):
    return quad(material, textures=(Texture(texels, wrap_u, wrap_v, nearest),), **more)


def rgba(surface):
    return np.concatenate([surface.base_colour, surface.alpha[:, None]], axis=1)


def random_texels(rng, height, width):
    return rng.integers(0, 256, (height, width, 4), np.uint8)


@settings(deadline=None, max_examples=60)
@given(SEEDS, st.sampled_from(WRAPS), st.sampled_from(WRAPS), st.booleans())
def test_a_point_reads_as_the_slow_reader_says(seed, wrap_u, wrap_v, nearest):
    rng = np.random.default_rng(seed)
    texels = random_texels(rng, *rng.integers(1, 6, 2))
    corners = np.array([(0, 1), (1, 1), (1, 0), (0, 0)]) * 7 - 3
    scene = textured(texels, wrap_u, wrap_v, nearest, uv=corners)
    points = rng.random((20, 2))
    # Away from borders of texels, where rounding decides which is nearest.
    size = np.array([texels.shape[1], texels.shape[0]])
    at = points * 7 - 3
    points = points[(np.abs(at * size - np.round(at * size)) > 1e-3).all(axis=1)]
    surface = at_uv(scene, points)
    for point, read in zip(points * 7 - 3, rgba(surface), strict=True):
        how = slow.nearest if nearest else slow.bilinear
        expected = how(texels, *point, (wrap_u, wrap_v), True)
        assert read == pytest.approx(expected, abs=2e-4)


def test_rows_of_a_texture_go_down_and_columns_right():
    scene = textured(chequered([0, 85], [170, 255]), nearest=True)
    read = rgba(at_uv(scene, [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)]))[:, 0]
    assert read == pytest.approx([slow.srgb_to_linear(c) for c in (0, 85, 170, 255)])


@pytest.mark.parametrize("wrap", WRAPS)
@pytest.mark.parametrize("far", [1e7, -1e7, 3e38, -3e38])
def test_coordinates_far_outside_stay_within_the_texture(wrap, far):
    texels = chequered([0, 255])
    scene = textured(texels, wrap, wrap, uv=np.full((4, 2), far, np.float32))
    read = rgba(at_uv(scene, [(0.5, 0.5)]))
    assert np.isfinite(read).all()
    if wrap == "clamp":
        assert read[0, 0] == (1.0 if far > 0 else 0.0)


@pytest.mark.parametrize("wrap", WRAPS)
@pytest.mark.parametrize("factor", [1e38, 3e38])
def test_coordinates_that_overflow_are_survived(wrap, factor):
    ref = TextureRef(0, 0, (factor, factor, 0, factor, -factor, factor))
    scene = textured(
        chequered([0, 255]),
        wrap,
        wrap,
        material=replace(BASE, base_colour_texture=ref),
        uv=np.array([(3e38, 3e38), (-3e38, 3e38), (0, 3e38), (3e38, 0)], np.float32),
    )
    for name in TEXTURE_FILTERS:
        for footprint in (0.0, 1.0, 1e30):
            read = rgba(at_uv(scene, [(0.3, 0.4)], footprint=footprint, texture_filter=name))
            assert np.isfinite(read).all()


@pytest.mark.parametrize("is_colour", [True, False])
@pytest.mark.parametrize(("height", "width"), [(4, 8), (5, 7), (1, 9), (6, 1), (3, 3), (2, 5)])
def test_smaller_sizes_are_means(rng, height, width, is_colour):
    texels = random_texels(rng, height, width)
    material = BASE if is_colour else DATA
    table = SceneTables.of(textured(texels, material=material)).textures
    last = texels
    for level in range(1, table.levels[0]):
        w, h = table.size[0, level]
        assert (h, w) == (max(last.shape[0] // 2, 1), max(last.shape[1] // 2, 1))
        begin = table.start[0, level]
        stored = table.texels[begin : begin + w * h].reshape(h, w, 4)
        expected = slow.halved(last, is_colour)
        for (row, col, channel), code in np.ndenumerate(stored):
            decode = slow.srgb_to_linear if is_colour and channel < 3 else (lambda c: c / 255)
            away = abs(decode(int(code)) - expected[row, col, channel])
            step = max(
                decode(min(int(code) + 1, 255)) - decode(int(code)),
                decode(int(code)) - decode(max(int(code) - 1, 0)),
            )
            assert away <= 0.5 * step + 1e-6
        last = stored
    assert last.shape[:2] == (1, 1)


def test_black_and_white_average_in_linear_light():
    scene = textured(chequered([0, 255], [255, 0]))
    read = rgba(at_uv(scene, [(0.5, 0.5)], footprint=100.0, texture_filter="mip"))
    assert read[0, :3] == pytest.approx([0.5] * 3, abs=0.005)


def test_data_averages_as_it_is():
    scene = textured(chequered([0, 255], [255, 0]), material=DATA)
    surface = at_uv(scene, [(0.5, 0.5)], footprint=100.0, texture_filter="mip")
    assert surface.occlusion[0] == pytest.approx(0.5, abs=0.003)


def levels_texture():
    """16 x 16 texels, no size of which looks like another."""
    return random_texels(np.random.default_rng(7), 16, 16)


@pytest.mark.parametrize("level", [0, 1, 2, 3, 4])
@pytest.mark.parametrize("tilt_deg", [0.0, 60.0])
def test_the_size_whose_texels_match_the_footprint_is_read(level, tilt_deg):
    texels = levels_texture()
    scene = textured(texels, material=DATA)
    # The quad is 2 m across, a texel 1/8 m; tilted, a pixel covers more along one axis.
    cosine = np.cos(np.deg2rad(tilt_deg))
    footprint = 2.0**level / 8 * cosine
    points = np.random.default_rng(1).random((10, 2))
    surface = at_uv(
        scene,
        points,
        footprint=footprint,
        texture_filter="mip",
        direction=(np.sqrt(1 - cosine**2), 0, -cosine),
    )
    table = SceneTables.of(scene).textures
    w, h = table.size[0, level]
    begin = table.start[0, level]
    stored = table.texels[begin : begin + w * h].reshape(h, w, 4)
    expected = [slow.bilinear(stored, *p, ("repeat", "repeat"), False)[0] for p in points]
    assert surface.occlusion == pytest.approx(expected, abs=1e-3)


def test_texture_transforms_change_which_size_is_read():
    texels = levels_texture()
    twice = replace(DATA, occlusion_texture=TextureRef(0, 0, (2, 0, 0, 0, 2, 0)))
    points = [(0.3, 0.2)]
    zoomed = at_uv(textured(texels, material=twice), points, footprint=1 / 8, texture_filter="mip")
    plain = at_uv(
        textured(texels, material=DATA), [(0.6, 0.4)], footprint=1 / 4, texture_filter="mip"
    )
    assert zoomed.occlusion == pytest.approx(plain.occlusion, abs=1e-5)


def test_sizes_blend_without_a_jump():
    scene = textured(levels_texture(), material=DATA)
    footprints = np.geomspace(0.01, 50, 4000)
    read = np.array(
        [
            SceneTables.of(scene)
            .surface(
                np.zeros(4000, np.int32),
                np.tile(np.float32([0.3, 0.2]), (4000, 1)),
                np.tile(np.float32([0, 0, -1]), (4000, 1)),
                square_pixels(np.tile([0.0, 0, -1], (4000, 1)), footprints[:, None]),
                "mip",
            )
            .occlusion
        ]
    )[0]
    assert np.abs(np.diff(read)).max() < 0.01


def test_magnified_squares_are_read_as_squares_by_every_filter():
    texels = chequered([0, 255])
    for name in TEXTURE_FILTERS:
        surface = at_uv(
            textured(texels, nearest=True, material=DATA), [(0.45, 0.5)], texture_filter=name
        )
        assert surface.occlusion.tolist() == [0.0]
    smooth = at_uv(textured(texels, material=DATA), [(0.5, 0.5)])
    assert smooth.occlusion == pytest.approx([0.5])


def test_the_nearest_filter_never_mixes_texels(rng):
    scene = textured(chequered([0, 255]), material=DATA)
    points = rng.random((200, 2))
    read = at_uv(scene, points, texture_filter="nearest").occlusion
    assert (read == (points[:, 0] > 0.5)).all()


def test_a_texture_that_several_share_is_stored_once(rng):
    texels = random_texels(rng, 4, 4)
    both = (Texture(texels), Texture(texels, wrap_u="clamp"))
    material = replace(BASE, emissive_texture=TextureRef(1), emissive=(1, 1, 1))
    table = SceneTables.of(quad(material, textures=both)).textures
    assert len(table.texels) == 16 + 4 + 1
    assert (table.start[0] == table.start[1]).all()
    assert table.sampler[:, 0].tolist() == [0, 1]
