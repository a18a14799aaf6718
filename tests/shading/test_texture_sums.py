"""Textures' summed-area tables against sums texel by texel."""

import threading

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from raysvc.scene import Material, Texture, TextureRef
from raysvc.shading.material_table import material_table
from raysvc.shading.scene_tables import SceneTables
from raysvc.shading.texel_kernels import COLOUR, DATA
from raysvc.shading.texture_sum_kernels import ONE, box_sum
from raysvc.shading.texture_sums import ENTRY_BYTES, texture_sums
from tests.oracles import texture as slow
from tests.scenes import quad
from tests.shading.filtering import WRAPS, Reader, random_texels, steps_of

SEEDS = st.integers(0, 2**32 - 1)
CODES = {"repeat": 0, "clamp": 1, "mirror": 2}


@settings(deadline=None, max_examples=80)
@given(SEEDS, st.sampled_from(WRAPS), st.sampled_from(WRAPS), st.booleans())
def test_any_rectangle_is_the_sum_of_its_texels(seed, wrap_u, wrap_v, is_colour):
    rng = np.random.default_rng(seed)
    texels = random_texels(rng, *rng.integers(1, 6, 2))
    reader = Reader(texels, (wrap_u, wrap_v), is_colour=is_colour)
    sums, kind = reader.tables.sums.made(), reader.kind
    low = rng.uniform(-12, 12, 2)
    high = low + rng.uniform(0.01, 14, 2)
    if rng.random() < 0.3:
        low, high = np.round(low), np.round(high) + 1
    total = box_sum(
        sums,
        int(sums.start[0, kind]),
        (texels.shape[1], texels.shape[0]),
        (CODES[wrap_u], CODES[wrap_v]),
        tuple(map(float, low)),
        tuple(map(float, high)),
    )
    area = np.prod(high - low)
    expected = slow.box_mean(texels, low, high, (wrap_u, wrap_v), is_colour)
    assert np.array(total) / ONE == pytest.approx(expected * area, abs=1e-6 * max(area, 1))


@settings(deadline=None, max_examples=60)
@given(SEEDS, st.sampled_from(WRAPS))
def test_an_upright_footprint_is_a_rectangle_one_texel_wider(seed, wrap):
    rng = np.random.default_rng(seed)
    texels = random_texels(rng, 7, 5)
    wide, tall = rng.uniform(1.5, 20, 2)
    uv = rng.uniform(-1, 2, 2)
    half = 0.5 * np.sqrt(np.array([wide, tall]) ** 2 + 1)
    middle = uv * [5, 7]
    expected = slow.box_mean(texels, middle - half, middle + half, (wrap, wrap), False)
    read = Reader(texels, (wrap, wrap))("sat", uv, [[wide, 0], [0, tall]])
    assert read == pytest.approx(expected, abs=1e-6)


def test_a_whole_number_of_copies_is_the_exact_mean(rng):
    texels = random_texels(rng, 4, 4)
    mean = texels.reshape(-1, 4).mean(axis=0) / 255
    for copies in (1, 2, 50):
        steps = np.sqrt((4.0 * copies) ** 2 - 1) * np.eye(2)
        assert Reader(texels)("sat", rng.random(2), steps) == pytest.approx(mean, abs=1e-6)


@settings(deadline=None, max_examples=60)
@given(SEEDS, st.floats(0.0, 30.0), st.floats(0.0, 1.0), st.sampled_from(WRAPS))
def test_a_constant_stays_constant(seed, log_longer, part, wrap):
    rng = np.random.default_rng(seed)
    texels = np.full((*rng.integers(1, 20, 2), 4), rng.integers(0, 256, 4), np.uint8)
    longer = 2.0**log_longer
    steps = steps_of(rng, longer, longer * part)
    read = Reader(texels, (wrap, wrap))("sat", rng.uniform(-2, 2, 2), steps)
    assert read == pytest.approx(texels[0, 0] / 255, abs=1e-5)


def test_a_slanted_footprint_is_covered_by_boxes_of_its_variance(rng):
    """A mean of squares of the distance from the centre is the pixel's variance."""
    for part in (1.0, 0.5, 0.2, 0.05):
        longer = 12.0
        steps = steps_of(rng, longer, part * longer)
        # Squares of the distance from the middle along both axes, in two digits each
        square = (np.arange(32) - 15.5) ** 2
        texels = np.zeros((32, 32, 4), np.uint8)
        texels[..., 0], texels[..., 1] = square // 1, (square % 1) * 255
        texels[..., 2], texels[..., 3] = texels[..., 0].T, texels[..., 1].T
        read = Reader(texels, ("clamp", "clamp"))("sat", (0.5, 0.5), steps) * 255
        variance = np.diag(steps @ steps.T) / 12 + 1 / 6
        assert read[::2] + read[1::2] / 255 == pytest.approx(variance, rel=0.02, abs=0.05)


def test_a_seam_is_not_seen(rng):
    reader = Reader(random_texels(rng, 8, 8))
    steps = steps_of(rng, 5.0, 2.0)
    for uv in ((0.0, 0.3), (0.999, 0.0), (0.5, 0.5)):
        there = [reader("sat", np.add(uv, shift), steps) for shift in ((0, 0), (1, 0), (-3, 7))]
        assert there[1] == pytest.approx(there[0], abs=1e-6)
        assert there[2] == pytest.approx(there[0], abs=1e-6)


def two_slots():
    ref = TextureRef(0)
    return Material(base_colour_texture=ref, occlusion_texture=ref)


def test_a_texture_read_as_colour_and_as_data_has_two_tables(rng):
    texels = random_texels(rng, 4, 4)
    tables = SceneTables.of(quad(two_slots(), textures=(Texture(texels),)))
    sums = tables.sums.made()
    assert (sums.start >= 0).all()
    last = {kind: sums.start[0, kind] + 24 for kind in (DATA, COLOUR)}
    codes = texels[..., 0].reshape(-1)
    assert sums.sums[last[DATA], 0] / ONE == pytest.approx((codes / 255).sum(), abs=1e-5)
    linear = sum(slow.srgb_to_linear(int(code)) for code in codes)
    assert sums.sums[last[COLOUR], 0] / ONE == pytest.approx(linear, abs=1e-5)


def test_textures_that_no_slot_reads_have_none(rng):
    textures = (Texture(random_texels(rng, 4, 4)), Texture(random_texels(rng, 4, 4)))
    tables = SceneTables.of(quad(Material(normal_texture=TextureRef(1)), textures=textures))
    sums = tables.sums.made()
    assert sums.start[0].tolist() == [-1, -1]
    assert sums.start[1].tolist() == [0, -1]


def test_tables_fit_their_budget_by_starting_smaller(rng):
    large, small = random_texels(rng, 64, 64), random_texels(rng, 16, 16)
    materials = (
        Material(occlusion_texture=TextureRef(0)),
        Material(occlusion_texture=TextureRef(1)),
    )
    scene = quad(materials[0], textures=(Texture(large), Texture(small)), materials=materials)
    textures = SceneTables.of(scene).textures
    budget = 33 * 33 * ENTRY_BYTES + 17 * 17 * ENTRY_BYTES
    sums = texture_sums(material_table(materials), textures, budget)
    assert len(sums.sums) * ENTRY_BYTES <= budget
    assert sums.level[:, DATA].tolist() == [1, 0]
    least = texture_sums(material_table(materials), textures, 0)
    assert len(least.sums) == 8
    whole = texture_sums(material_table(materials), textures)
    assert whole.level.max() == 0


def test_textures_that_are_less_sharp_are_named(rng, monkeypatch):
    texels = random_texels(rng, 32, 32)
    sums = SceneTables.of(quad(two_slots(), textures=(Texture(texels),))).sums
    assert not sums.are_made
    assert sums.warnings == ()
    assert sums.are_made
    monkeypatch.setattr("raysvc.shading.texture_sums.texture_sums", _small_sums)
    sums = SceneTables.of(quad(two_slots(), textures=(Texture(texels),))).sums
    assert len(sums.warnings) == 1
    assert "of 1 textures" in sums.warnings[0]


def _small_sums(materials, textures):
    return texture_sums(materials, textures, 1000)


def test_tables_are_made_once_and_when_asked_for(rng):
    texels = random_texels(rng, 32, 32)
    tables = SceneTables.of(quad(two_slots(), textures=(Texture(texels),)))
    assert not tables.sums.are_made
    made = []
    threads = [threading.Thread(target=lambda: made.append(tables.sums.made())) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(each is made[0] for each in made)
