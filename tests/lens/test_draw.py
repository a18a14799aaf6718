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
    # Of an aperture a row of pixels is one span, whose ends lie where the edge does on the mean: in
    # pixels that the edge crosses all or nothing is drawn of what it covers in part. What is right
    # is how much each row gets. There two ends are rounded to 1/64 pixel, and 32 scanlines sample
    # what curves: together less than 1/20 of the 3 pixels that the smallest rows here are wide.
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
    rows = found.sum(axis=2), expected.sum(axis=2)
    assert np.abs(rows[0] - rows[1]).max() <= (2e-6 if exact else 0.05 / 3.0) * rows[1].max()


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


def highlight_of(name, diameter, side=65):
    """(side, side) a point of 1 in the middle, drawn; and by the slow twin."""
    bokeh, share = BOKEHS[name]
    middle = side // 2
    values = np.zeros((CHANNELS, side, side))
    values[:, middle, middle] = 1.0
    found = drawn(bokeh, values, np.full((side, side), diameter))[0].astype(float)
    return found, share(middle, middle, diameter, side, side)


def variances(shape):
    """Down and across, in square pixels, about the middle."""
    offset = np.arange(len(shape)) - len(shape) // 2
    return np.array([(shape.sum(axis=axis) * offset**2).sum() for axis in (1, 0)])


@pytest.mark.parametrize("diameter", [9.0, 13.7, 28.0])
def test_a_box_has_the_variance_that_its_widths_give(diameter):
    # Pixels within are covered wholly, and one at either end by a part of it.
    half = np.rint(diameter * np.sqrt(3) / 4 * 64) / 64
    inner = np.floor(half - 0.5)
    part = half - 0.5 - inner
    expected = 2 * (np.sum(np.arange(inner + 1) ** 2) + part * (inner + 1) ** 2) / (2 * half)
    found, _ = highlight_of("box", diameter)
    assert variances(found) == pytest.approx(expected, rel=1e-6)
    # Pixels at the ends are taken to be in their middles, and half a width is on 1/64 pixel.
    assert expected == pytest.approx(diameter**2 / 16, abs=1 / 6 + half / 3 / 64)


@pytest.mark.parametrize("order", [2, 3])
@pytest.mark.parametrize("diameter", [9.0, 13.7, 28.0])
def test_smooth_boxes_have_the_variance_of_the_disc(order, diameter):
    found, _ = highlight_of(f"box of order {order}", diameter)
    assert variances(found) == pytest.approx(diameter**2 / 16, rel=1e-6)


@pytest.mark.parametrize("name", ["disc", "triangle", "six blades"])
@pytest.mark.parametrize("diameter", [9.0, 13.7, 28.0])
def test_rows_of_an_aperture_are_as_wide_as_the_opening(name, diameter):
    found, expected = highlight_of(name, diameter)
    widest = expected.sum(axis=1).max()
    assert np.abs(found.sum(axis=1) - expected.sum(axis=1)).max() < 0.01 * widest
    (down, across), (true_down, true_across) = variances(found), variances(expected)
    assert down == pytest.approx(true_down, rel=3e-3)
    # Ends at their means lose what the edge's slope varies within a row, and add nothing.
    assert true_across - 0.2 < across < true_across + 0.01


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
