"""The lens on pictures: what must hold for every picture and every bokeh."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from raysvc.errors import Cancelled, InvalidInput
from raysvc.lens.aperture import Aperture
from raysvc.lens.bokeh import Bokeh
from raysvc.lens.gather import gather
from raysvc.lens.points import LensPoints
from raysvc.lens.spread import LARGEST_VALUE, LEAST_COVER, slices_of, spread, spread_points
from raysvc.parallel import Control
from tests.lens.pictures import even, highlight, random_coc, random_picture
from tests.oracles.spread import mix, smooth_kernel

SEEDS = st.integers(0, 2**32 - 1)
BOKEHS = {
    "box": Bokeh("box", 1),
    "box2": Bokeh("box", 2),
    "box3": Bokeh("box", 3),
    "disc": Bokeh(),
    "pentagon": Bokeh(aperture=Aperture(5, 10.0)),
}
every_bokeh = pytest.mark.parametrize("bokeh", BOKEHS.values(), ids=BOKEHS)


@every_bokeh
@pytest.mark.parametrize("diameter", [-30.0, -3.0, 1.5, 8.0, 25.0, 70.0])
def test_one_blur_everywhere_keeps_the_total_light(bokeh, diameter, rng):
    rgba = random_picture(rng, 64, 96)
    blurred = spread(rgba, even(rgba, diameter), bokeh)
    before, after = (array.sum(axis=(0, 1), dtype=float) for array in (rgba, blurred))
    # All shapes keep their light (`test_draw`), and mirrored at borders as well. Only where shapes
    # that are no mirror images of themselves meet their reflections do they not cover all pixels
    # alike; what covers too much is then made whole, and light with it, by as much as the picture
    # is brighter or darker there than on the mean. In the interior no shape loses anything: see the
    # highlight below.
    assert after == pytest.approx(before, rel=1e-6 if bokeh != BOKEHS["pentagon"] else 1e-4)


@every_bokeh
@pytest.mark.parametrize("diameter", [2.0, 12.3, 31.9, 47.0, 130.0])
def test_a_highlight_keeps_its_energy_and_leaves_nothing_beside_it(bokeh, diameter):
    rgba = highlight(320, 400, 1e9)
    blurred = spread(rgba, even(rgba, diameter), bokeh)[..., 0].astype(float)
    assert blurred.sum() == pytest.approx(1e9, rel=1e-6)
    y, x = np.mgrid[:320, :400] + 0.5
    far = (
        np.hypot(x - 200.5, y - 160.5) > bokeh.half_per_diameter * 1.5 * diameter + 3 + diameter / 8
    )
    assert np.all(blurred[far] == 0)


@pytest.mark.parametrize("diameter", [20.0, 50.0, 100.0])
def test_a_highlight_through_a_disc_is_flat_and_round(diameter):
    rgba = highlight(201, 201, 1.0)
    blurred = spread(rgba, even(rgba, diameter))[..., 0] * np.pi * diameter**2 / 4
    y, x = np.mgrid[:201, :201] - 100.0
    radius = np.hypot(x, y)
    soft = 2 + diameter / 12
    assert np.allclose(blurred[radius < diameter / 2 - soft], 1, atol=0.03)
    assert np.all(blurred[radius > diameter / 2 + soft] == 0)


@settings(deadline=None, max_examples=25)
@given(SEEDS, st.sampled_from(sorted(BOKEHS)), st.floats(0.5, 200.0))
def test_a_constant_picture_stays_constant_up_to_its_border(seed, name, largest):
    rng = np.random.default_rng(seed)
    colour = np.append(rng.random(3) * 10, 1).astype(np.float32)
    coc = random_coc(rng, largest=largest)
    blurred = spread(np.broadcast_to(colour, (*coc.shape, 4)).copy(), coc, BOKEHS[name])
    assert np.allclose(blurred, colour, rtol=1e-5)


@settings(deadline=None, max_examples=25)
@given(SEEDS, st.sampled_from(sorted(BOKEHS)))
def test_blurring_is_linear_in_the_picture(seed, name):
    rng = np.random.default_rng(seed)
    first, second = (random_picture(rng, opaque=False) for _ in range(2))
    coc = random_coc(rng)
    bokeh = BOKEHS[name]
    apart = spread(first, coc, bokeh) + 2 * spread(second, coc, bokeh)
    assert np.allclose(spread(first + 2 * second, coc, bokeh), apart, rtol=1e-4, atol=1e-4)


@settings(deadline=None, max_examples=25)
@given(SEEDS, st.sampled_from(["box", "box2", "box3", "disc"]))
def test_mirroring_the_picture_mirrors_the_blur(seed, name):
    rng = np.random.default_rng(seed)
    # Sides that halve evenly: the fill's pyramid is then symmetric as well.
    rgba, coc = random_picture(rng, 32, 32), random_coc(rng, 32, 32)
    mirror = spread(
        np.ascontiguousarray(rgba[:, ::-1]), np.ascontiguousarray(coc[:, ::-1]), BOKEHS[name]
    )
    assert np.allclose(mirror[:, ::-1], spread(rgba, coc, BOKEHS[name]), rtol=1e-4, atol=1e-3)


@every_bokeh
@pytest.mark.parametrize("threads", [2, 5])
@pytest.mark.parametrize("opaque", [True, False])
def test_the_bits_do_not_depend_on_the_number_of_threads(bokeh, threads, opaque, rng):
    rgba, coc = random_picture(rng, 220, 120, opaque), random_coc(rng, 220, 120, 90.0)
    one = spread(rgba, coc, bokeh, control=Control(threads=1))
    assert np.array_equal(one, spread(rgba, coc, bokeh, control=Control(threads=threads)))


@pytest.mark.parametrize("diameter", [1.0, 2.3, 9.0, 31.0])
def test_gathering_with_one_size_is_spreading(diameter, rng):
    rgba = random_picture(rng, 40, 50)
    coc = even(rgba, diameter)
    assert np.allclose(gather(rgba, coc), spread(rgba, coc, Bokeh("box")), rtol=1e-5, atol=1e-5)


def test_gathering_leaks_where_spreading_does_not():
    """Its known fault: what is sharp in front bleeds into the blurred background."""
    rgba, coc = cards(near=0.0, far=20.0)
    assert gather(rgba, coc)[32, 34, 0] > 0.2
    assert spread(rgba, coc)[32, 34, 0] < 1e-6


@pytest.mark.slow
def test_order_three_of_a_large_picture_with_highlights_is_accurate(rng):
    rgba = random_picture(rng, 1080, 1920)
    rgba[rng.random((1080, 1920)) < 1e-4, :3] = 500.0
    diameter = 31.0
    found = spread(rgba, even(rgba, diameter), Bokeh("box", 3))
    lines = smooth_kernel(diameter, 3)
    expected = 0.0
    for part, line in zip(mix(diameter, 3), lines, strict=True):
        values = rgba[..., 0].astype(float)
        for _ in range(2):
            size = len(values)
            wide = np.concatenate([values[::-1], values, values[::-1]])
            begin = size - len(line) // 2
            values = sum(w * wide[begin + k : begin + k + size] for k, w in enumerate(line)).T
        expected = expected + part * values
    assert np.abs(found[..., 0] - expected).max() < 1e-4


def test_nothing_out_of_focus_returns_the_picture_itself(rng):
    rgba = random_picture(rng)
    assert spread(rgba, even(rgba, 0.0)) is rgba


@every_bokeh
def test_sharp_pixels_keep_their_bits_beside_a_blurred_background(bokeh, rng):
    rgba = random_picture(rng)
    coc = np.where(rng.random(rgba.shape[:2]) < 0.5, 0.8, 18.0).astype(np.float32)
    blurred = spread(rgba, coc, bokeh)
    assert np.array_equal(blurred[coc < 1], rgba[coc < 1])
    assert not np.array_equal(blurred, rgba)


@every_bokeh
def test_sharp_pixels_out_of_reach_of_the_foreground_keep_their_bits(bokeh, rng):
    rgba = random_picture(rng, 40, 40)
    coc = np.zeros((40, 40), np.float32)
    coc[:, :5] = -8.0
    blurred = spread(rgba, coc, bokeh)
    assert np.array_equal(blurred[:, 13:], rgba[:, 13:])
    assert not np.array_equal(blurred[:, 5:8], rgba[:, 5:8])


def cards(near, far, height=64, width=64):
    """A red card in the left half before green, with a blur for each."""
    rgba = np.zeros((height, width, 4), np.float32)
    rgba[..., 3] = 1
    rgba[:, : width // 2, 0] = 1.0
    rgba[:, width // 2 :, 1] = 1.0
    coc = np.where(np.arange(width) < width // 2, near, far) * np.ones((height, 1))
    return rgba, coc.astype(np.float32)


def test_a_blurred_foreground_spreads_half_across_its_silhouette():
    side = 16.0
    rgba, coc = cards(-side / (np.sqrt(3) / 2), 0.0)
    edge = spread(rgba, coc, Bokeh("box"))[32]
    expected = np.clip(0.5 - (np.arange(64) + 0.5 - 32) / side, 0, 1)
    assert np.abs(edge[:, 0] - expected).max() < 0.04
    assert np.abs(edge[:, 1] - (1 - expected)).max() < 0.04


def test_a_blurred_background_is_whole_up_to_a_sharp_silhouette():
    rgba, coc = cards(0.0, 20.0)
    blurred = spread(rgba, coc)
    assert np.array_equal(blurred[:, :32], rgba[:, :32])
    assert np.allclose(blurred[:, 32:], rgba[:, 32:], atol=1e-6)


def test_a_known_background_is_seen_through_the_blurred_edge_before_it():
    """Behind the foreground is something blue that the picture does not show."""
    rgba, coc = cards(-20.0, 0.0)
    hidden = np.zeros((64, 64, 4), np.float32)
    hidden[..., 2:] = 1.0
    points = LensPoints.of_picture(rgba, coc)
    behind = LensPoints.of_picture(hidden, np.zeros((64, 64), np.float32))
    seen = spread_points(
        points.behind(behind), Bokeh(), slices_of(points, None), Control(threads=1)
    )[32]
    cover = seen[:, 0]
    assert 0.2 < cover[28] < 0.8 and cover[10] == pytest.approx(1.0, abs=1e-5)
    assert np.allclose(seen[:32, 2], 1 - cover[:32], atol=1e-5)
    assert np.all(seen[:32, 1] == 0) and np.allclose(seen[:, 3], 1)


def test_a_surface_that_recedes_has_no_seam_though_something_is_behind_it():
    """Through all slices, before the focus and behind, nothing of what is behind shines through."""
    height, width = 40, 400
    rgba = np.ones((height, width, 4), np.float32)
    coc = np.broadcast_to(np.linspace(-40, 40, width, dtype=np.float32), (height, width)).copy()
    hidden = np.zeros_like(rgba)
    hidden[..., 3] = 1
    points = LensPoints.of_picture(rgba, coc)
    behind = LensPoints.of_picture(hidden, np.full((height, width), 60.0, np.float32))
    for layers in (None, 4):
        both = points.behind(behind)
        seen = spread_points(both, Bokeh(), slices_of(both, layers), Control(threads=1))
        assert seen[..., 0].min() > 0.93


def test_blurs_of_different_depth_cover_independently():
    """Half a near thing over half a far thing leaves a quarter of what is sharp behind."""
    shape = (60, 60)
    half = np.full((*shape, 4), 0.5, np.float32) * np.float32([1, 0, 0, 1])
    points = LensPoints.of_picture(half, np.full(shape, -40.0, np.float32))
    cover = np.full(60 * 60, 0.5, np.float32)
    near = LensPoints(shape, points.pixel, points.coc_px, points.rgba, cover)
    middle = LensPoints(
        shape, points.pixel, np.full(3600, -6.0, np.float32), points.rgba[:, [1, 0, 2, 3]], cover
    )
    back = LensPoints.of_picture(np.ones((*shape, 4), np.float32), np.zeros(shape, np.float32))
    every = near.behind(middle).behind(back)
    seen = spread_points(every, Bokeh(), slices_of(every, None), Control(threads=1))
    assert np.allclose(seen[30, 30], [0.75, 0.5, 0.25, 1.0], atol=1e-4)


def test_a_transparent_background_stays_transparent():
    rgba = np.zeros((40, 40, 4), np.float32)
    rgba[:, :20] = (0.5, 0.5, 0.5, 1.0)
    blurred = spread(rgba, even(rgba, 10.0))
    assert np.all(blurred[:, :14, 3] > 0.999) and np.all(blurred[:, 26:, 3] == 0)
    assert np.allclose(blurred[..., 0], 0.5 * blurred[..., 3], atol=1e-6)


@every_bokeh
def test_a_blur_larger_than_the_picture_is_finite_and_keeps_the_light(bokeh, rng):
    rgba = random_picture(rng, 64, 96)
    blurred = spread(rgba, even(rgba, -1e6), bokeh)
    # A veil of LEAST_COVER is what float32 has left of one, and divided by it: two roundings.
    rounding = 2 * 2.0**-24 / LEAST_COVER
    assert blurred.sum(dtype=float) == pytest.approx(rgba.sum(dtype=float), rel=1e-6 + rounding)
    assert blurred[..., :3].std() < 0.2 * rgba[..., :3].std()


@every_bokeh
@pytest.mark.parametrize("shape", [(1, 1), (1, 50), (7, 3)])
def test_the_smallest_pictures(bokeh, shape, rng):
    rgba = random_picture(rng, *shape)
    blurred = spread(rgba, random_coc(rng, *shape, 100.0), bokeh)
    assert blurred.shape == rgba.shape and np.isfinite(blurred).all()
    assert blurred.min() >= -1e-5 and blurred.max() <= rgba.max() * (1 + 1e-5)


def test_what_is_not_finite_is_limited_with_a_warning(rng):
    rgba = random_picture(rng)
    rgba[3, 4, 0], rgba[5, 6, 1] = np.nan, np.inf
    warnings = []
    blurred = spread(rgba, even(rgba, 5.0), warnings=warnings)
    assert np.isfinite(blurred).all() and blurred.max() <= LARGEST_VALUE
    assert len(warnings) == 1 and "2 pixels" in warnings[0]


def test_shapes_that_do_not_match_are_refused(rng):
    with pytest.raises(InvalidInput, match="coc_px"):
        spread(random_picture(rng), np.zeros((3, 3), np.float32))


def test_an_undefined_circle_of_confusion_is_refused(rng):
    rgba = random_picture(rng)
    with pytest.raises(InvalidInput, match="coc_px: must be finite"):
        spread(rgba, even(rgba, np.nan))


def test_a_cancelled_control_stops_it(rng):
    rgba, control = random_picture(rng), Control(threads=1)
    control.cancel()
    with pytest.raises(Cancelled):
        spread(rgba, random_coc(rng), control=control)
