"""Drawing shapes by their edges against drawing them pixel by pixel."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from raysvc.lens.aperture import Aperture
from raysvc.lens.bokeh import Bokeh
from raysvc.lens.sources import CHANNELS, Sources
from raysvc.lens.sum_kernels import fold
from tests.oracles import spread as slow

SEEDS = st.integers(0, 2**32 - 1)
BOKEHS = {
    "box": (Bokeh("box", 1), slow.square),
    "box of order 2": (Bokeh("box", 2), slow.smooth(2)),
    "box of order 3": (Bokeh("box", 3), slow.smooth(3)),
    "disc": (Bokeh(), slow.aperture()),
    "triangle": (Bokeh(aperture=Aperture(3, 20.0)), slow.aperture(3, 20.0)),
    "six blades": (Bokeh(aperture=Aperture(6)), slow.aperture(6)),
}
SCALE = np.full(CHANNELS, 2.0**50)


def drawn(bokeh, values, size_px, rows=None):
    """(CHANNELS, H, W) sums of values of all pixels, drawn `rows` at a time."""
    _, height, width = values.shape
    number = np.arange(height * width, dtype=np.int64)
    sources = Sources(
        number[::width].copy(),
        number[::width] + width,
        (number % width).astype(np.int32),
        size_px.reshape(-1).astype(np.float32),
        np.ascontiguousarray(values.reshape(CHANNELS, -1).T, np.float32),
    )
    pen = bokeh.pen(float(np.abs(size_px).max()))
    out = np.zeros((height, width, CHANNELS), np.float32)
    for first in range(0, height, rows or height):
        last = min(first + (rows or height), height)
        top, bottom = pen.rows(first, last, height)
        shape = bottom - top + 2, width + 2 * pen.reach + 2, CHANNELS
        deltas = np.zeros(shape, np.int64)
        pen.draw(sources, SCALE, top, bottom, -pen.reach, deltas)
        fold(deltas, 1 / SCALE, height, top, -pen.reach, first, out[first:last])
    return np.moveaxis(out, 2, 0)


@pytest.mark.parametrize("name", BOKEHS)
def test_shapes_of_all_sizes_equal_their_slow_twins(name, rng):
    bokeh, share = BOKEHS[name]
    height, width = 11, 14
    # Of a disc of few pixels a row is covered in part: its edges are then where they are on the
    # mean, which is not the same.
    exact = bokeh.shape == "box"
    least = 1.0 if exact else 3.0
    values = rng.random((CHANNELS, height, width))
    # On 1/32 pixel, where both draw the same square; up to what goes beyond two borders.
    size = np.round(rng.uniform(-11, 11, (height, width)) * 32) / 32
    size[np.abs(size) < least] = least
    expected = slow.splat(
        values,
        np.ones((height, width)),
        np.where(size < 0, -1, 1) * abs(size),
        share if "box" not in name else lambda y, x, d, *s: share(y, x, abs(d), *s),
    )
    found = drawn(bokeh, values, size)
    assert np.abs(found - expected).max() <= (2e-6 if exact else 0.1) * expected.max()


@pytest.mark.parametrize("name", BOKEHS)
@pytest.mark.parametrize("rows", [1, 5, 8])
def test_rows_drawn_apart_have_the_same_bits(name, rows, rng):
    bokeh, _ = BOKEHS[name]
    values, size = rng.random((CHANNELS, 24, 20)), rng.uniform(-15, 15, (24, 20))
    size[np.abs(size) < 1] = 1.0
    assert np.array_equal(drawn(bokeh, values, size, rows), drawn(bokeh, values, size))


@settings(deadline=None, max_examples=20)
@given(SEEDS, st.sampled_from(sorted(BOKEHS)), st.floats(1.0, 20.0))
def test_the_total_is_kept(seed, name, largest):
    rng = np.random.default_rng(seed)
    values = rng.random((CHANNELS, 24, 33)) ** 6 * 50
    size = np.maximum(rng.uniform(0, largest, (24, 33)), 1.0)
    found = drawn(BOKEHS[name][0], values, size)
    assert found.sum(axis=(1, 2), dtype=float) == pytest.approx(values.sum(axis=(1, 2)), rel=1e-6)


@pytest.mark.parametrize("name", BOKEHS)
@pytest.mark.parametrize("diameter", [9.0, 13.7, 28.0])
def test_a_point_becomes_a_shape_of_the_discs_variance(name, diameter):
    values = np.zeros((CHANNELS, 65, 65))
    values[:, 32, 32] = 1.0
    found = drawn(BOKEHS[name][0], values, np.full((65, 65), diameter))[0].astype(float)
    offset = np.arange(65) - 32.0
    variance = (found.sum(axis=0) * offset**2).sum()
    blades = BOKEHS[name][0].aperture.blades
    # A regular polygon with its corners on the circle is less wide than the disc.
    turn = 2 * np.pi / blades if blades else 0.0
    narrower = (2 + np.cos(turn)) / 3
    expected = narrower * diameter**2 / 16
    # Edges within pixels are softer by up to a pixel's width.
    assert 0.95 * expected < variance < 1.03 * expected + 1 / 6


@pytest.mark.parametrize(("sign", "up"), [(1, True), (-1, False)])
def test_what_is_near_shows_the_opening_upside_down(sign, up):
    values = np.zeros((CHANNELS, 41, 41))
    values[:, 20, 20] = 1.0
    found = drawn(Bokeh(aperture=Aperture(3)), values, np.full((41, 41), sign * 30.0))[0]
    rows = np.flatnonzero(found.any(axis=1))
    above, below = 20 - rows[0], rows[-1] - 20
    assert (above > 1.5 * below) if up else (below > 1.5 * above)


def test_rotation_turns_counter_clockwise():
    values = np.zeros((CHANNELS, 41, 41))
    values[:, 20, 20] = 1.0
    found = drawn(Bokeh(aperture=Aperture(3, 90.0)), values, np.full((41, 41), 30.0))[0]
    columns = np.flatnonzero(found.any(axis=0))
    assert 20 - columns[0] > 1.5 * (columns[-1] - 20)
