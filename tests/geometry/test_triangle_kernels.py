"""The one function that turns "which triangle" into t, u and v."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from raysvc.accel.base import Triangles, hits_on
from tests.oracles.nearest_hit import nearest_hit
from tests.scenes import rays

ONE = Triangles(
    np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32), np.array([[0, 1, 2]], np.int32)
)
SINGLE = st.floats(-100, 100, width=32)
POINT = st.tuples(SINGLE, SINGLE, SINGLE).map(lambda p: np.array(p, np.float32))


def hit(scene, origin, direction, triangle=0):
    asked = rays(origin, direction)
    hits = hits_on(scene, np.full(len(asked), triangle, np.int32), asked)
    return hits.t[0], hits.barycentric[0]


@settings(deadline=None, max_examples=300)
@given(POINT, POINT, POINT, POINT, st.floats(0, 1), st.floats(0, 1))
def test_a_point_made_from_weights_is_found_again(a, b, c, origin, u, v):
    if u + v > 1:
        u, v = 1 - u, 1 - v
    corners = np.stack([a, b, c])
    p = corners.astype(float)
    point = p[0] * (1 - u - v) + p[1] * u + p[2] * v
    direction = (point - origin).astype(np.float32)
    across = np.cross(p[1] - p[0], p[2] - p[0])
    edges = max(np.linalg.norm(p[1] - p[0]), np.linalg.norm(p[2] - p[0]))
    # Not a needle, and not seen edge-on: else the rounding of the direction decides.
    assume(np.linalg.norm(across) > 1e-2 * edges**2 > 0)
    length = np.linalg.norm(direction.astype(float))
    assume(abs(across @ direction) > 1e-2 * np.linalg.norm(across) * length > 1e-6)
    assume(edges > 1e-2 * length)
    t, weights = hit(Triangles(corners, np.array([[0, 1, 2]], np.int32)), origin, direction)
    assert t == pytest.approx(1.0, abs=1e-3)
    assert weights == pytest.approx([u, v], abs=1e-2)
    assert (weights >= 0).all()
    assert weights.sum(dtype=float) <= 1 + 1e-7


def test_no_triangle_is_a_miss():
    t, weights = hit(ONE, [0, 0, 1], [0, 0, -1], triangle=-1)
    assert np.isinf(t)
    assert weights.tolist() == [0, 0]


@pytest.mark.parametrize(
    ("at", "expected"),
    [
        ((-0.5, 0.25), (0, 0.25)),
        ((0.25, -0.5), (0.25, 0)),
        ((3.0, 0.5), (1, 0)),
        ((0.5, 3.0), (0.5, 0.5)),
    ],
)
def test_weights_beside_the_triangle_are_drawn_into_it(at, expected):
    t, weights = hit(ONE, [*at, 2], [0, 0, -1])
    assert t == 2
    assert weights.tolist() == list(expected)


def test_a_ray_in_the_plane_gets_the_middle():
    t, weights = hit(ONE, [-1, 1 / 3, 0], [1, 0, 0])
    assert t == pytest.approx(4 / 3)
    assert weights == pytest.approx([1 / 3, 1 / 3])


def test_a_triangle_without_area_gets_finite_numbers():
    point = Triangles(np.ones((3, 3), np.float32), np.array([[0, 1, 2]], np.int32))
    t, weights = hit(point, [0, 0, 0], [2, 2, 2])
    assert t == pytest.approx(0.5)
    assert np.isfinite(weights).all()


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_t_is_exact_to_single_precision(rng, scale):
    positions = (rng.uniform(-1, 1, (300, 3)) * scale).astype(np.float32)
    triangles = np.arange(300, dtype=np.int32).reshape(-1, 3)
    middles = positions[triangles].mean(axis=1)
    origins = (rng.uniform(-2, 2, (100, 3)) * scale).astype(np.float32)
    asked = rays(origins, middles - origins)
    hits = hits_on(Triangles(positions, triangles), np.arange(100, dtype=np.int32), asked)
    for k in range(100):
        met = nearest_hit(origins[[k]], asked.directions[[k]], [np.inf], positions, triangles[[k]])
        assert hits.t[k] == pytest.approx(met.t[0], rel=1e-6)
