"""Elliptical weighted average against a Gaussian summed texel by texel."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from raysvc.shading.ellipse_kernels import (
    longer_direction,
    squared_axes,
    turned_into,
    widened,
)
from raysvc.shading.ewa_kernels import LEAST_VARIANCE, MAX_ANISOTROPY, ewa, ewa_level
from raysvc.shading.texel_kernels import DATA
from tests.oracles import texture as slow
from tests.shading.filtering import WRAPS, Reader, random_texels, steps_of

SEEDS = st.integers(0, 2**32 - 1)
EYE = np.eye(2)


# The matrix of a footprint


def as_spread(m):
    return (float(m[0, 0]), float(m[0, 1]), float(m[1, 1]))


def as_matrix(spread):
    return np.array([[spread[0], spread[1]], [spread[1], spread[2]]])


@settings(deadline=None, max_examples=100)
@given(SEEDS, st.floats(1e-3, 1e3), st.floats(0.0, 1.0))
def test_axes_are_those_of_the_footprint(seed, longer, part):
    rng = np.random.default_rng(seed)
    steps = steps_of(rng, longer, longer * part)
    m = as_spread(steps @ steps.T)
    squares = squared_axes(m)
    assert squares[0] == pytest.approx(longer**2, rel=1e-9)
    assert squares[1] == pytest.approx((longer * part) ** 2, rel=1e-6, abs=1e-9 * longer**2)
    along = np.array(longer_direction(m, squares[0]))
    assert np.linalg.norm(along) == pytest.approx(1)
    if part < 0.99:
        assert as_matrix(m) @ along == pytest.approx(squares[0] * along, abs=1e-7 * longer**2)
    least = 0.25 * longer**2
    fat = as_matrix(widened(m, *squares, least))
    expected = [max((longer * part) ** 2, least), longer**2]
    assert np.linalg.eigvalsh(fat) == pytest.approx(expected, rel=1e-6)
    a = rng.normal(size=(2, 2))
    turned = as_matrix(turned_into(m, tuple(map(float, a[0])), tuple(map(float, a[1]))))
    assert turned == pytest.approx(a @ as_matrix(m) @ a.T, rel=1e-9, abs=1e-9)


def test_a_footprint_without_extent_has_no_axes():
    assert squared_axes((0.0, 0.0, 0.0)) == (0, 0)
    assert longer_direction((0.0, 0.0, 0.0), 0.0) == (1, 0)
    assert longer_direction((0.0, 0.0, 4.0), 4.0) == (0, 1)
    assert longer_direction((4.0, 0.0, 4.0), 4.0) == (1, 0)


# The filter


@settings(deadline=None, max_examples=60)
@given(SEEDS, st.sampled_from(WRAPS), st.sampled_from(WRAPS), st.booleans())
def test_the_largest_size_is_read_as_the_slow_sum_says(seed, wrap_u, wrap_v, is_colour):
    rng = np.random.default_rng(seed)
    texels = random_texels(rng, *rng.integers(2, 9, 2))
    reader = Reader(texels, (wrap_u, wrap_v), is_colour=is_colour)
    # The shorter axis short enough for the largest size, the longer one long enough to be filtered.
    longer, shorter = rng.uniform(1.5, 12), rng.uniform(0.8, 1.9)
    steps = steps_of(rng, max(longer, shorter), shorter)
    uv = rng.uniform(-3, 3, 2)
    expected = slow.gaussian(
        texels, *uv, steps @ steps.T / 12 + EYE / 6, (wrap_u, wrap_v), is_colour
    )
    assert reader("ewa", uv, steps) == pytest.approx(expected, abs=1e-5)


@settings(deadline=None, max_examples=30)
@given(SEEDS, st.sampled_from(WRAPS), st.integers(1, 3))
def test_smaller_sizes_are_read_for_wider_footprints(seed, wrap, level):
    rng = np.random.default_rng(seed)
    reader = Reader(random_texels(rng, 64, 32), (wrap, wrap))
    shorter = 2.0**level * rng.uniform(2.01, 3.9)
    steps = steps_of(rng, shorter * rng.uniform(1, 4), shorter)
    uv = rng.uniform(-1, 1, 2)
    # In texels of that size: the pixel, interpolation of the largest, less the averaging since.
    shrunk = 0.5**level
    variance = steps @ steps.T * shrunk**2 / 12 + EYE * (shrunk**2 / 6 - (1 - shrunk**2) / 12)
    expected = slow.gaussian(reader.level(level), *uv, variance, (wrap, wrap), False)
    assert reader("ewa", uv, steps) == pytest.approx(expected, abs=1e-5)


@settings(deadline=None, max_examples=60)
@given(SEEDS, st.floats(0.0, 9.0), st.floats(0.0, 1.0), st.sampled_from(WRAPS))
def test_a_constant_stays_constant(seed, log_longer, part, wrap):
    rng = np.random.default_rng(seed)
    height, width = rng.integers(1, 70, 2)
    texels = np.full((height, width, 4), rng.integers(0, 256, 4), np.uint8)
    reader = Reader(texels, (wrap, wrap))
    longer = 2.0**log_longer
    read = reader("ewa", rng.uniform(-2, 2, 2), steps_of(rng, longer, longer * part))
    assert read == pytest.approx(texels[0, 0] / 255, abs=2e-6)


def test_a_ramp_is_read_as_its_value_at_the_centre(rng):
    ramp = np.repeat(np.arange(256, dtype=np.uint8)[None, :, None], 4, axis=2)
    reader = Reader(np.repeat(ramp, 64, axis=0), ("clamp", "clamp"))
    for longer in (1.0, 1.5, 3.0, 10.0, 40.0):
        for uv in rng.uniform(0.35, 0.65, (10, 2)):
            read = reader("ewa", uv, steps_of(rng, longer, rng.uniform(0, longer)))
            # The centre of texel 0 has value 0, that of texel 255 has 255; the sum over texels is
            # an integral to within a few hundredths of their size.
            away = 0.5 + 0.05 * longer
            assert read[0] * 255 == pytest.approx(uv[0] * 256 - 0.5, abs=away)


def test_fine_detail_becomes_its_mean(rng):
    texels = np.indices((256, 256)).sum(axis=0) % 2 * 255
    reader = Reader(np.repeat(texels[..., None], 4, axis=2).astype(np.uint8))
    for longer in (4.0, 7.0, 20.0, 100.0):
        steps = steps_of(rng, longer, longer * rng.uniform(0.5, 1))
        assert reader("ewa", rng.random(2), steps) == pytest.approx([0.5] * 4, abs=0.01)


@settings(deadline=None, max_examples=200)
@given(SEEDS, st.floats(0.0, 12.0), st.floats(-20.0, 0.0))
def test_few_texels_are_read_however_long_the_footprint(seed, log_longer, log_part):
    rng = np.random.default_rng(seed)
    height, width = (int(size) for size in rng.integers(1, 3000, 2))
    texels = np.zeros((height, width, 4), np.uint8)
    reader = _reader_of(height, width, texels)
    longer = 2.0**log_longer
    steps = steps_of(rng, longer, longer * 2.0**log_part)
    spread, level = ewa_level(as_spread(steps @ steps.T))
    axes = squared_axes(spread)
    assert axes[0] <= axes[1] * MAX_ANISOTROPY**2 * (1 + 1e-9)
    if level < reader.tables.textures.levels[0] - 1:
        _, weights = ewa(reader.tables.textures, 0, level, (0.3, 0.4), spread, DATA)
        # The mean of the weight over the ellipse is 0.297.
        assert weights / 0.297 < 1000


_READERS: dict[tuple[int, int], Reader] = {}


def _reader_of(height, width, texels):
    """A few sizes are enough, and large ones are slow to make."""
    key = (height, width) if len(_READERS) < 8 else list(_READERS)[height % 8]
    if key not in _READERS:
        _READERS[key] = Reader(texels)
    return _READERS[key]


@pytest.mark.parametrize(("name", "largest"), [("ewa", 0.04), ("sat", 0.02)])
@pytest.mark.parametrize("part", [1.0, 0.4, 0.1])
def test_what_is_read_hardly_jumps_as_the_footprint_grows(name, largest, part):
    # Noise of all sizes, as textures have, of deviation 0.24.
    rng = np.random.default_rng(5)
    wave = np.fft.rfft2(rng.normal(size=(128, 128)))
    wave /= np.maximum(np.hypot(*np.meshgrid(np.arange(65), np.fft.fftfreq(128, 1 / 128))), 1)
    noise = np.fft.irfft2(wave, (128, 128))
    grey = np.clip(128 + 60 * noise / noise.std(), 0, 255).astype(np.uint8)
    reader = Reader(np.repeat(grey[..., None], 4, axis=2))
    turn = steps_of(rng, 1.0, part)
    for uv in rng.random((5, 2)):
        read = [reader(name, uv, size * turn)[0] for size in np.geomspace(0.5, 200, 600)]
        assert np.abs(np.diff(read)).max() < largest


def test_a_texture_of_one_row_is_filtered_along_it_alone(rng):
    row = random_texels(rng, 1, 64)
    reader = Reader(row)
    tall = reader("ewa", (0.3, 0.2), [[0.5, 0], [0, 50.0]])
    assert tall == pytest.approx(slow.bilinear(row, 0.3, 0.2, ("repeat",) * 2, False), abs=1e-6)
    wide = reader("ewa", (0.3, 0.2), [[3.0, 0], [0, 50.0]])
    assert np.isfinite(wide).all()
    assert LEAST_VARIANCE == pytest.approx(1 / 6)
