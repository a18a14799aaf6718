"""Pixels of triangles, as pictures and against exact arithmetic."""

from fractions import Fraction

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from raysvc.raster.spans import ONE
from tests.oracles.coverage import covered
from tests.raster.drawing import drawn, pixel_camera, pixel_scene, times_covered

SEEDS = st.integers(0, 2**32 - 1)


def picture(points, triangles, width=8, height=5, **more):
    return drawn(pixel_scene(points, triangles), pixel_camera(width, height), **more)


def test_a_square_covers_the_centres_inside():
    square = picture([(1, 1), (1, 4), (6, 4), (6, 1)], [[0, 1, 2], [0, 2, 3]])
    assert square == [
        "........",
        ".abbbb..",
        ".aabbb..",
        ".aaaab..",
        "........",
    ]


def test_a_triangle_with_corners_on_centres_has_its_top_and_left_edges():
    assert picture([(0.5, 0.5), (0.5, 4.5), (4.5, 0.5)], [[0, 1, 2]]) == [
        "aaaa....",
        "aaa.....",
        "aa......",
        "a.......",
        "........",
    ]


def test_its_other_half_has_the_rest():
    corners = [(0.5, 0.5), (0.5, 4.5), (4.5, 0.5), (4.5, 4.5)]
    assert picture(corners, [[0, 1, 2], [1, 3, 2]]) == [
        "aaaa....",
        "aaab....",
        "aabb....",
        "abbb....",
        "........",
    ]


def test_triangles_reach_beyond_the_picture_on_all_sides():
    assert picture([(-50, -50), (-50, 500), (500, -50)], [[0, 1, 2]]) == ["aaaaaaaa"] * 5


def test_a_sliver_between_centres_covers_nothing():
    assert (
        picture([(0, 1.6), (8, 1.6), (8, 2.4), (0, 2.4)], [[0, 1, 2], [0, 2, 3]])
        == ["........"] * 5
    )


def test_a_narrow_strip_over_centres_is_one_pixel_wide():
    strip = picture([(2.4, 0), (2.4, 5), (2.6, 5), (2.6, 0)], [[0, 1, 2], [0, 2, 3]])
    assert [row.replace("b", "a") for row in strip] == ["..a....."] * 5


def test_backs_are_seen_only_of_double_sided_triangles():
    points, back = [(0, 0), (8, 0), (0, 5)], [[0, 1, 2]]
    assert picture(points, back, double_sided=False) == ["........"] * 5
    assert picture(points, back)[0] == "aaaaaaa."
    assert picture(points, [[0, 2, 1]], double_sided=False)[0] == "aaaaaaa."


def test_the_nearer_triangle_is_seen_and_crossing_ones_both():
    whole = [[0, 1, 2], [3, 4, 5]]
    far = [(-20, -20, 1), (-20, 40, 1), (40, -20, 1)]
    near = [(-20, -20, 2), (-20, 40, 2), (40, -20, 2)]
    assert picture(far + near, whole) == ["bbbbbbbb"] * 5
    assert picture(near + far, whole) == ["aaaaaaaa"] * 5
    slanted = [(x, y, 1 + (x - 4) * 0.1) for x, y, _ in far]
    assert picture(far + slanted, whole) == ["aaaabbbb"] * 5


def test_of_equally_near_triangles_the_first_is_seen():
    points = [(0, 0), (0, 9), (9, 0)] * 2
    assert picture(points, [[0, 1, 2], [3, 4, 5]])[0] == "aaaaaaaa"


SIXTEENTHS = st.integers(-40, 200).map(lambda n: Fraction(n, 16))
CORNER = st.tuples(SIXTEENTHS, SIXTEENTHS)


@settings(deadline=None, max_examples=150)
@given(st.tuples(CORNER, CORNER, CORNER))
def test_coverage_is_exact_where_edges_run_through_centres(corners):
    expected = covered(corners, 9, 7)
    scene = pixel_scene([(float(x), float(y)) for x, y in corners], [[0, 1, 2]])
    assert (times_covered(scene, pixel_camera(9, 7)) == expected).all()


@settings(deadline=None, max_examples=60)
@given(SEEDS)
def test_coverage_is_exact_for_corners_anywhere(seed):
    rng = np.random.default_rng(seed)
    steps = rng.integers(-3 * ONE, 12 * ONE, (3, 2))
    # Coordinates that single precision and the fixed point both hold.
    steps = steps // 256 * 256
    expected = covered([tuple(Fraction(int(c), ONE) for c in p) for p in steps], 9, 7)
    scene = pixel_scene(steps / ONE, [[0, 1, 2]])
    assert (times_covered(scene, pixel_camera(9, 7)) == expected).all()


@settings(deadline=None, max_examples=100)
@given(SEEDS, st.integers(3, 12), st.booleans(), st.integers(0, 2))
def test_a_polygon_cut_into_triangles_is_covered_once(seed, count, clockwise, snap):
    rng = np.random.default_rng(seed)
    turn = 1 if clockwise else -1
    angle = np.sort(rng.uniform(0, 2 * np.pi, count))[::turn]
    rim = np.stack([12 + 9 * np.cos(angle), 10 + 8 * np.sin(angle)], axis=1)
    hub = rng.uniform(8, 12, 2)
    if snap:
        # On centres (1) or on halves of pixels (2), where many edges run through centres.
        step = 1.0 if snap == 1 else 0.5
        rim, hub = np.round(rim / step) * step + 0.5, np.round(hub / step) * step + 0.5
    fan = [[count, k, (k + 1) % count] for k in range(count)]
    # A hub outside the polygon makes triangles overlap: those turned round take away.
    signed = times_signed(fan, [*rim, hub])
    assert set(np.unique(signed)) <= {0, 1}


def times_signed(fan, points):
    """(21, 25) fragments counted with the sign of their triangle's orientation."""
    total = np.zeros((21, 25), int)
    p = np.array(points, np.float32).astype(float)
    for triangle in fan:
        a, b, c = p[triangle]
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        alone = pixel_scene(p[triangle], [[0, 1, 2]])
        total += int(np.sign(area)) * times_covered(alone, pixel_camera(25, 21))
    return total if total.sum() >= 0 else -total


@settings(deadline=None, max_examples=60)
@given(SEEDS, st.sampled_from([1.0, 0.5, 0.37]))
def test_a_mesh_of_the_plane_covers_every_pixel_once(seed, spacing):
    rng = np.random.default_rng(seed)
    n = 10
    y, x = np.mgrid[0 : n + 1, 0 : n + 1] * (3.0 * spacing) - 2.5
    inner = (slice(1, -1), slice(1, -1))
    for axis in (x, y):
        axis[inner] += rng.choice([0.0, 0.25, 0.5, rng.random()], axis[inner].shape) * spacing
    corner = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    a, b, c, d = corner[:-1, :-1], corner[:-1, 1:], corner[1:, 1:], corner[1:, :-1]
    flip = rng.random((n, n)) < 0.5
    first = np.where(flip[..., None], np.stack([a, b, c], -1), np.stack([a, b, d], -1))
    second = np.where(flip[..., None], np.stack([a, c, d], -1), np.stack([b, c, d], -1))
    triangles = np.concatenate([first.reshape(-1, 3), second.reshape(-1, 3)])
    scene = pixel_scene(np.stack([x.ravel(), y.ravel()], axis=1), triangles)
    size = int(3 * spacing * n - 4)
    assert (times_covered(scene, pixel_camera(size, size)) == 1).all()
