"""Every structure answers like a slow loop in double precision."""

import itertools
import threading

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from raysvc.accel.base import Rays, Triangles, nearest
from raysvc.accel.registry import STRUCTURES, build
from raysvc.errors import InvalidInput
from tests.oracles.nearest_hit import nearest_hit
from tests.scenes import rays, soup

AVAILABLE = [name for name, entry in STRUCTURES.items() if entry.why_not() is None]
SEEDS = st.integers(0, 2**32 - 1)
SURE = 1e-4
"""Barycentric weight inside or outside a triangle by which a hit or miss is beyond doubt."""


@pytest.fixture(params=AVAILABLE)
def structure(request):
    return request.param


def check(structure, positions, triangles, asked, tolerance=1e-4):
    """Compare with the oracle wherever no rounding can decide."""
    scene = Triangles(np.ascontiguousarray(positions, np.float32), triangles)
    tree = build(structure, scene)
    hits = nearest(tree, scene, asked)
    occluded = tree.occluded(asked)
    assert hits.triangle.dtype == np.int32
    assert hits.triangle.shape == (len(asked),)
    assert hits.t.dtype == np.float32
    assert hits.barycentric.shape == (len(asked), 2)
    assert occluded.dtype == np.bool_
    assert (occluded == (hits.triangle >= 0)).all()
    missed = hits.triangle < 0
    assert np.isinf(hits.t[missed]).all()
    assert (hits.barycentric[missed] == 0).all()

    met = nearest_hit(asked.origins, asked.directions, asked.t_max, positions, triangles)
    doubtful = (np.abs(met.margin) < SURE).any(axis=1)
    met_t = np.nan_to_num(met.all_t, posinf=1e38)
    reach = np.nan_to_num(asked.t_max.astype(float), posinf=1e39)[:, None]
    doubtful |= (np.abs(met_t - reach) <= tolerance * met_t).any(axis=1)
    sure = ~doubtful
    assert sure.mean() > 0.5 or len(asked) < 10
    np.testing.assert_allclose(hits.t[sure], met.t[sure], rtol=tolerance)
    # Where only one triangle is that near, it is that one.
    near = met.all_t <= np.where(np.isfinite(met.t), met.t * (1 + tolerance), -1)[:, None]
    unique = sure & (near.sum(axis=1) == 1)
    assert (hits.triangle[unique] == near[unique].argmax(axis=1)).all()
    return hits


def random_rays(rng, count, *, middle=(0.0, 0.0, 0.0), scale=1.0, t_max=np.inf):
    origins = rng.uniform(-2, 2, (count, 3)) * scale + np.asarray(middle)
    directions = rng.normal(size=(count, 3))
    return rays(origins, directions, t_max)


@settings(deadline=None, max_examples=20)
@given(SEEDS, st.integers(1, 200), st.floats(0.01, 1.0))
@pytest.mark.parametrize("structure", AVAILABLE)
def test_random_triangles_are_met_as_by_the_slow_loop(structure, seed, count, size):
    rng = np.random.default_rng(seed)
    check(structure, *soup(rng, count, size=size), random_rays(rng, 200))


@settings(deadline=None, max_examples=15)
@given(SEEDS, st.sampled_from([1e-5, 1e-3, 1e3, 1e6]))
@pytest.mark.parametrize("structure", AVAILABLE)
def test_scale_does_not_matter(structure, seed, scale):
    rng = np.random.default_rng(seed)
    positions, triangles = soup(rng, 60, scale=scale)
    check(structure, positions, triangles, random_rays(rng, 150, scale=scale))


def test_scenes_far_from_the_origin_are_met(structure, rng):
    middle = (1e4, -2e4, 3e4)
    positions, triangles = soup(rng, 60, middle=middle, scale=10.0)
    asked = random_rays(rng, 300, middle=middle, scale=10.0)
    check(structure, positions, triangles, asked, tolerance=1e-3)


def test_needles_are_met(structure, rng):
    count = 80
    begin, along = rng.uniform(-1, 1, (count, 3)), rng.normal(size=(count, 3))
    thin = rng.normal(size=(count, 3)) * 1e-4
    positions = np.stack([begin, begin + along, begin + along * 0.5 + thin], axis=1).reshape(-1, 3)
    triangles = np.arange(3 * count, dtype=np.int32).reshape(-1, 3)
    # Aimed at the needles' middles, so that they are hit at all.
    positions = positions.astype(np.float32)
    middles = positions[triangles].mean(axis=1)
    origins = rng.uniform(-3, 3, (count, 3)).astype(np.float32)
    hits = check(structure, positions, triangles, rays(origins, middles - origins), 1e-3)
    assert (hits.triangle >= 0).mean() > 0.9


def test_coincident_triangles_are_met_at_their_common_distance(structure, rng):
    positions, triangles = soup(rng, 20, size=0.6)
    check(structure, positions, np.tile(triangles, (3, 1)), random_rays(rng, 200))


def test_overlapping_coplanar_triangles_are_met_at_their_plane(structure, rng):
    corners = rng.uniform(-1, 1, (30, 3, 3))
    corners[:, :, 2] = 0.25
    triangles = np.arange(90, dtype=np.int32).reshape(-1, 3)
    hits = check(structure, corners.reshape(-1, 3), triangles, random_rays(rng, 300))
    assert np.isfinite(hits.t).any()


def test_degenerate_triangles_are_never_met(structure, rng):
    positions, triangles = soup(rng, 30)
    triangles = triangles.copy()
    triangles[::3, 1] = triangles[::3, 0]
    triangles[1::9] = triangles[1::9, :1]
    hits = check(structure, positions, triangles, random_rays(rng, 400))
    assert not np.isin(hits.triangle, np.arange(0, 30, 3)).any()


@pytest.mark.parametrize("zero", [0.0, -0.0])
def test_rays_along_the_axes_are_met(structure, rng, zero):
    positions, triangles = soup(rng, 100, size=0.5)
    origins, directions = [], []
    for axis, sign in itertools.product(range(3), (1.0, -1.0)):
        direction = np.full(3, zero)
        direction[axis] = sign
        start = rng.uniform(-1, 1, (40, 3))
        start[:, axis] = -2 * sign
        origins.append(start)
        directions.append(np.tile(direction, (40, 1)))
    hits = check(
        structure, positions, triangles, rays(np.concatenate(origins), np.concatenate(directions))
    )
    assert (hits.triangle >= 0).mean() > 0.3


def test_a_ray_in_the_plane_of_a_triangle_passes(structure):
    scene = Triangles(
        np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32), np.array([[0, 1, 2]], np.int32)
    )
    tree = build(structure, scene)
    beside = rays([[0.2, 0.2, 1.0], [0.2, 0.2, -1.0]], [[1, 0, 0], [0, -1, 0]])
    assert (tree.nearest_triangle(beside) == -1).all()
    assert not tree.occluded(beside).any()


def test_reach_is_measured_in_lengths_of_the_direction(structure):
    scene = Triangles(
        np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32), np.array([[0, 1, 2]], np.int32)
    )
    tree = build(structure, scene)
    asked = rays([[0.2, 0.2, 6.0]] * 5, [[0, 0, -2.0]] * 5, [2.9, 3.1, np.inf, 0.0, 1e30])
    assert tree.nearest_triangle(asked).tolist() == [-1, 0, 0, -1, 0]
    assert tree.occluded(asked).tolist() == [False, True, True, False, True]
    assert nearest(tree, scene, asked).t[1] == 3.0


def test_random_reaches_are_kept(structure, rng):
    positions, triangles = soup(rng, 80, size=0.5)
    check(structure, positions, triangles, random_rays(rng, 400, t_max=rng.uniform(0, 1.5, 400)))


def test_questions_do_not_change_the_rays(structure, rng):
    positions, triangles = soup(rng, 20)
    tree = build(structure, Triangles(positions, triangles))
    asked = random_rays(rng, 50, t_max=3.0)
    before = [a.copy() for a in (asked.origins, asked.directions, asked.t_max)]
    tree.nearest_triangle(asked)
    tree.occluded(asked)
    for array, old in zip((asked.origins, asked.directions, asked.t_max), before, strict=True):
        assert (array == old).all()


def test_nothing_is_met_in_an_empty_scene(structure, rng):
    for positions in (np.zeros((0, 3), np.float32), np.ones((3, 3), np.float32)):
        scene = Triangles(positions, np.zeros((0, 3), np.int32))
        tree = build(structure, scene)
        hits = nearest(tree, scene, random_rays(rng, 7))
        assert (hits.triangle == -1).all()
        assert np.isinf(hits.t).all()
        assert not tree.occluded(random_rays(rng, 7)).any()
        assert tree.report.triangles == 0


def test_no_rays_have_no_answers(structure, rng):
    tree = build(structure, Triangles(*soup(rng, 3)))
    assert tree.nearest_triangle(random_rays(rng, 0)).shape == (0,)
    assert tree.occluded(random_rays(rng, 0)).shape == (0,)


def test_one_triangle_is_met_from_both_sides(structure):
    scene = Triangles(
        np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32), np.array([[0, 1, 2]], np.int32)
    )
    tree = build(structure, scene)
    hits = nearest(tree, scene, rays([[0.25, 0.5, 2], [0.25, 0.5, -2]], [[0, 0, -1], [0, 0, 1]]))
    assert hits.triangle.tolist() == [0, 0]
    assert hits.t.tolist() == [2.0, 2.0]
    assert hits.barycentric.tolist() == [[0.25, 0.5], [0.25, 0.5]]


def test_the_order_of_triangles_does_not_matter(structure, rng):
    positions, triangles = soup(rng, 100)
    asked = random_rays(rng, 300)
    shuffled = rng.permutation(100)
    first, second = (
        nearest(build(structure, scene), scene, asked)
        for scene in (Triangles(positions, triangles), Triangles(positions, triangles[shuffled]))
    )
    assert (first.t == second.t).all()
    met = second.triangle >= 0
    assert (first.triangle[met] == shuffled[second.triangle[met]]).all()


def test_no_ray_escapes_from_a_closed_surface(structure):
    sphere = closed_grid(24)
    triangles = Triangles(*sphere)
    tree = build(structure, triangles)
    targets = np.concatenate(
        [
            sphere[0],
            sphere[0][sphere[1]].mean(axis=1),
            (sphere[0][sphere[1][:, 0]] + sphere[0][sphere[1][:, 1]]) / 2,
        ]
    )
    asked = rays(np.float32([0.1, -0.2, 0.05]), targets - np.float32([0.1, -0.2, 0.05]))
    assert (tree.nearest_triangle(asked) >= 0).all()


def closed_grid(n):
    """A closed sphere of quads in triangles: positions (V, 3) float32, indices (F, 3) int32."""
    theta = np.linspace(0, np.pi, n + 1)[1:-1]
    phi = np.arange(2 * n) * np.pi / n
    ring = np.stack(
        [
            np.outer(np.sin(theta), np.cos(phi)),
            np.outer(np.cos(theta), np.ones_like(phi)),
            np.outer(np.sin(theta), np.sin(phi)),
        ],
        axis=2,
    )
    positions = np.concatenate([ring.reshape(-1, 3), [[0, 1, 0], [0, -1, 0]]])
    north, south = len(positions) - 2, len(positions) - 1
    triangles = []
    for row in range(n - 1):
        for col in range(2 * n):
            a, b = row * 2 * n + col, row * 2 * n + (col + 1) % (2 * n)
            if row == 0:
                triangles.append((north, b, a))
            if row == n - 2:
                triangles.append((south, a, b))
            else:
                triangles += [(a, b, b + 2 * n), (a, b + 2 * n, a + 2 * n)]
    return positions.astype(np.float32), np.array(triangles, np.int32)


def test_answers_repeat_to_the_bit(structure, rng):
    scene = Triangles(*soup(rng, 300))
    asked = random_rays(rng, 500)
    first = nearest(build(structure, scene), scene, asked)
    for _ in range(2):
        again = nearest(build(structure, scene), scene, asked)
        assert first.t.tobytes() == again.t.tobytes()
        assert first.triangle.tobytes() == again.triangle.tobytes()
        assert first.barycentric.tobytes() == again.barycentric.tobytes()


def test_two_threads_may_ask_at_once(structure, rng):
    scene = Triangles(*soup(rng, 300))
    tree = build(structure, scene)
    asked = [random_rays(rng, 2000) for _ in range(2)]
    alone = [(tree.nearest_triangle(r), tree.occluded(r)) for r in asked]
    wrong = []
    ready = threading.Barrier(2)

    def ask(which):
        ready.wait()
        for _ in range(10):
            if (tree.nearest_triangle(asked[which]) != alone[which][0]).any():
                wrong.append("nearest")
            if (tree.occluded(asked[which]) != alone[which][1]).any():
                wrong.append("occluded")

    threads = [threading.Thread(target=ask, args=(k,)) for k in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert wrong == []


def test_a_fresh_structure_may_be_asked_by_two_threads_first(structure, rng):
    scene = Triangles(*soup(rng, 200))
    asked = random_rays(rng, 300)
    expected = build(structure, scene).nearest_triangle(asked)
    for _ in range(5):
        tree = build(structure, scene)
        answers = []
        threads = [
            threading.Thread(target=lambda t=tree, a=answers: a.append(t.nearest_triangle(asked)))
            for _ in range(2)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert all((answer == expected).all() for answer in answers)
        assert len(answers) == 2


def test_unused_vertices_may_lie_anywhere(structure):
    positions = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1e30, 0, 0]], np.float32)
    tree = build(structure, Triangles(positions, np.array([[0, 1, 2]], np.int32)))
    assert tree.nearest_triangle(rays([0.2, 0.2, 1], [0, 0, -1])).tolist() == [0]


def test_the_report_counts_triangles_and_seconds(structure, rng):
    report = build(structure, Triangles(*soup(rng, 12))).report
    assert report.triangles == 12
    assert report.seconds >= 0


def test_rays_must_be_contiguous_single_precision():
    good = np.zeros((4, 3), np.float32)
    for bad in (
        good.astype(np.float64),
        np.zeros((4, 2), np.float32),
        np.zeros((3, 4), np.float32).T,
    ):
        with pytest.raises(InvalidInput, match="directions"):
            Rays(good, bad, np.zeros(4, np.float32))
