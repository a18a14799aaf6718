"""Every formula of ray differentials against central differences in double precision."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from raysvc.geometry import differential_kernels as kernels
from tests.oracles.ray_path import (
    Sphere,
    Triangle,
    central_difference,
    follow,
    reflect,
    refract,
    unit,
)

SEEDS = st.integers(0, 2**32 - 1)
STEP = 4e-4


def as_is(vector):
    return tuple(float(x) for x in vector)


def near(step, expected):
    """Within 1e-5 of the length of what is expected."""
    expected = np.asarray(expected)
    return np.linalg.norm(np.asarray(step) - expected) <= 1e-5 * np.linalg.norm(expected) + 1e-10


class Pinhole:
    """A camera in some direction, its pixels a hundredth of a radian wide."""

    def __init__(self, rng, target=(0, 0, 0), distance=4.0):
        back = unit(rng.normal(size=3))
        self.eye = np.asarray(target) + distance * back
        self.forward = -back
        self.right = unit(np.cross(rng.normal(size=3), back))
        self.up = np.cross(back, self.right)
        self.size = 0.01

    def direction(self, x, y):
        return unit(self.forward + self.size * (x * self.right - y * self.up))

    def steps(self, x, y):
        """Differentials of the direction to the right and down."""
        d = self.direction(x, y)
        length = 1.0 / (d @ self.forward)
        return [
            kernels.unit_step(as_is(d), length, as_is(self.size * axis))
            for axis in (self.right, -self.up)
        ]


@settings(deadline=None, max_examples=50)
@given(SEEDS)
def test_directions_of_a_pinhole_camera(seed):
    rng = np.random.default_rng(seed)
    camera = Pinhole(rng)
    x, y = rng.uniform(-60, 60, 2)
    right, down = camera.steps(x, y)
    assert near(right, central_difference(lambda at: camera.direction(at, y), x, STEP))
    assert near(down, central_difference(lambda at: camera.direction(x, at), y, STEP))


def a_triangle(rng, corner_size=1.0, bend=0.4):
    """A triangle about the origin with normals that differ from corner to corner."""
    corners = rng.uniform(-1, 1, (3, 3)) * corner_size
    plane = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    assume(np.linalg.norm(plane) > 0.2 * corner_size**2)
    normals = unit(plane) + rng.normal(size=(3, 3)) * bend
    return Triangle(corners, normals / np.linalg.norm(normals, axis=1, keepdims=True))


@settings(deadline=None, max_examples=50)
@given(SEEDS)
def test_transfer_to_a_plane_and_to_a_sphere(seed):
    rng = np.random.default_rng(seed)
    camera = Pinhole(rng)
    x, y = rng.uniform(-10, 10, 2)
    for surface in (a_triangle(rng), Sphere(np.zeros(3), 1.0), Sphere(np.zeros(3), 1.0, far=True)):
        direction = camera.direction(x, y)
        t, plane, _ = surface.hit(camera.eye, direction)
        assume(abs(direction @ plane) > 0.05)
        step = kernels.transferred(
            as_is(direction), (0.0, 0.0, 0.0), camera.steps(x, y)[0], t, as_is(3.0 * plane)
        )

        def point(at, surface=surface):
            direction = camera.direction(at, y)
            return camera.eye + surface.hit(camera.eye, direction)[0] * direction

        assert near(step, central_difference(point, x, STEP))


@settings(deadline=None, max_examples=50)
@given(SEEDS)
def test_transfer_of_a_ray_whose_origin_moves(seed):
    # An orthographic camera's rays, and those that leave a mirror.
    rng = np.random.default_rng(seed)
    surface = a_triangle(rng)
    origin, moves = rng.normal(size=3) * 3, rng.normal(size=3)
    direction, turns = unit(rng.normal(size=3)), rng.normal(size=3)
    t, plane, _ = surface.hit(origin, direction)
    assume(abs(direction @ plane) > 0.05)

    def point(at):
        o, d = origin + at * moves, unit(direction + at * turns)
        return o + surface.hit(o, d)[0] * d

    turning = kernels.unit_step(as_is(direction), 1.0, as_is(turns))
    step = kernels.transferred(as_is(direction), as_is(moves), turning, t, as_is(plane))
    assert near(step, central_difference(point, 0.0, STEP))


@settings(deadline=None, max_examples=50)
@given(SEEDS)
def test_weights_of_a_triangle_and_its_interpolated_normal(seed):
    rng = np.random.default_rng(seed)
    triangle = a_triangle(rng, bend=0.7)
    a, b, c = triangle.corners
    u, v, du, dv = rng.uniform(0, 1, 4)
    gradients = kernels.barycentric_gradients(as_is(a), as_is(b), as_is(c))
    step = du * (b - a) + dv * (c - a)
    assert [np.dot(g, step) for g in gradients] == pytest.approx([du, dv], abs=1e-9)
    assert np.dot(gradients[0], np.cross(b - a, c - a)) == pytest.approx(0, abs=1e-9)

    def normal(at):
        weights = np.array([1 - u - v - at * (du + dv), u + at * du, v + at * dv])
        return unit(weights @ triangle.normals)

    corners = [as_is(n) for n in triangle.normals]
    assert near(
        kernels.interpolated_normal_step(*corners, u, v, du, dv),
        central_difference(normal, 0.0, STEP),
    )


@settings(deadline=None, max_examples=100)
@given(SEEDS, st.sampled_from([1 / 1.5, 1.5, 1 / 1.33, 2.4, 1.0]))
def test_reflection_and_refraction_where_ray_and_normal_turn(seed, eta):
    rng = np.random.default_rng(seed)
    direction, turns = unit(rng.normal(size=3)), rng.normal(size=3)
    normal, tilts = unit(rng.normal(size=3)), rng.normal(size=3)
    normal = -np.sign(direction @ normal) * normal
    cosine = -direction @ normal
    assume(cosine > 0.05)
    direction_step = kernels.unit_step(as_is(direction), 1.0, as_is(turns))
    normal_step = kernels.unit_step(as_is(normal), 1.0, as_is(tilts))
    incoming = as_is(direction), direction_step, as_is(normal), normal_step

    def at(x, event, *more):
        return event(unit(direction + x * turns), unit(normal + x * tilts), *more)

    assert near(
        kernels.reflected_step(*incoming), central_difference(lambda x: at(x, reflect), 0, STEP)
    )
    if eta * eta * (1 - cosine**2) < 0.9:
        assert near(
            kernels.refracted_step(*incoming, eta),
            central_difference(lambda x: at(x, refract, eta), 0, STEP),
        )
    if eta * eta * (1 - cosine**2) > 1:
        assert kernels.refracted_step(*incoming, eta) == (0, 0, 0)


def chained(camera, x, y, path):
    """Differentials to the right of the ray after every surface of a path, by the kernels."""
    origin, direction = camera.eye, camera.direction(x, y)
    origin_step, direction_step = (0.0, 0.0, 0.0), camera.steps(x, y)[0]
    steps = [(origin_step, direction_step)]
    for surface, event in path:
        t, plane, normal = surface.hit(origin, direction)
        origin_step = kernels.transferred(
            as_is(direction), origin_step, direction_step, t, as_is(plane)
        )
        origin = origin + t * direction
        if isinstance(surface, Sphere):
            normal_step = np.array(origin_step) / surface.radius
        else:
            a, b, c = (as_is(corner) for corner in surface.corners)
            along_b, along_c = kernels.barycentric_gradients(a, b, c)
            away = origin - surface.corners[0]
            normal_step = kernels.interpolated_normal_step(
                *(as_is(n) for n in surface.normals),
                float(np.dot(along_b, away)),
                float(np.dot(along_c, away)),
                float(np.dot(along_b, origin_step)),
                float(np.dot(along_c, origin_step)),
            )
        side = -np.sign(direction @ normal)
        incoming = (
            as_is(direction),
            direction_step,
            as_is(side * normal),
            as_is(side * np.array(normal_step)),
        )
        if event == "reflect":
            direction_step = kernels.reflected_step(*incoming)
            direction = reflect(direction, normal)
        elif event is not None:
            direction_step = kernels.refracted_step(*incoming, event[1])
            direction = refract(direction, normal, event[1])
        steps.append((origin_step, direction_step))
    return steps


def placed_along(rng, origin, direction, events):
    """A path whose surfaces stand where a ray comes by, each met well away from grazing."""
    path = []
    for kind, event in events:
        point = origin + rng.uniform(1, 3) * direction
        outwards = unit(rng.normal(size=3) * 0.2 - direction)
        if kind == "ball":
            surface = Sphere(point - outwards * rng.uniform(0.5, 2), 0.0)
            surface = Sphere(surface.centre, float(np.linalg.norm(point - surface.centre)))
        elif kind == "out":
            surface = Sphere(path[-1][0].centre, path[-1][0].radius, far=True)
        else:
            across = unit(np.cross(outwards, rng.normal(size=3)))
            other = np.cross(outwards, across)
            corners = point + np.array([across, -across + other, -across - other])
            normals = outwards + 0.15 * rng.normal(size=(3, 3))
            surface = Triangle(corners, normals / np.linalg.norm(normals, axis=1, keepdims=True))
        path.append((surface, event))
        origin, direction = follow(origin, direction, path[-1:])[-1]
    return path


GLASS = [("ball", ("refract", 1 / 1.5)), ("out", ("refract", 1.5))]
CHAINS = {
    "mirrors": [("ball", "reflect"), ("mesh", "reflect"), ("ball", "reflect"), ("mesh", None)],
    "mirrors and glass": [("ball", "reflect"), ("mesh", "reflect"), *GLASS, ("mesh", None)],
    "a pane with curved normals": [("mesh", ("refract", 1 / 1.33)), ("mesh", ("refract", 1.33))],
    "glass and a mirror": [*GLASS, ("mesh", "reflect"), *GLASS, ("ball", None)],
}


@settings(deadline=None, max_examples=25)
@given(SEEDS)
@pytest.mark.parametrize("events", CHAINS.values(), ids=CHAINS.keys())
def test_chains_of_mirrors_and_glass(events, seed):
    rng = np.random.default_rng(seed)
    camera = Pinhole(rng)
    x, y = rng.uniform(-30, 30, 2)
    with np.errstate(invalid="ignore"):
        path = placed_along(rng, camera.eye, camera.direction(x, y), events)
        derivative = central_difference(
            lambda at: follow(camera.eye, camera.direction(at, y), path), x, STEP
        )
    # Light that is reflected inside has no path; nearly along a surface, differences are coarse.
    assume(np.isfinite(derivative).all() and np.abs(derivative).max() < 1e2)
    for steps, expected in zip(chained(camera, x, y, path), derivative, strict=True):
        for step, truth in zip(steps, expected, strict=True):
            assert near(step, truth)


# What is degenerate


@pytest.mark.parametrize("cosine", [0.0, 1e-30, -1e-12, 1e-5])
def test_a_grazing_ray_moves_far_but_not_infinitely_far(cosine):
    direction = as_is(unit([1.0, cosine, 0.0]))
    step = kernels.transferred(direction, (0.0, 1.0, 0.0), (0.0, 0.0, 0.0), 1.0, (0.0, 2.0, 0.0))
    assert np.linalg.norm(step) == pytest.approx(1 / kernels.LEAST_COSINE, rel=1e-3)


def test_refraction_at_the_critical_angle_is_finite():
    sine = np.nextafter(1 / 1.5, 0)
    direction = (sine, -np.sqrt(1 - sine * sine), 0.0)
    step = kernels.refracted_step(direction, (0.8, 0.6, 0.0), (0.0, 1.0, 0.0), (0.1, 0.0, 0.0), 1.5)
    assert np.isfinite(step).all()


def test_a_triangle_without_area_has_no_gradients():
    a, b = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
    assert kernels.barycentric_gradients(a, b, b) == ((0, 0, 0), (0, 0, 0))
    assert kernels.barycentric_gradients(a, a, a) == ((0, 0, 0), (0, 0, 0))
    huge = (1e200, 0.0, 0.0)
    assert np.isfinite(kernels.barycentric_gradients(a, huge, (0.0, 1e200, 0.0))).all()


def test_normals_that_cancel_do_not_turn():
    up, down = (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)
    assert kernels.interpolated_normal_step(up, down, up, 0.5, 0.0, 1.0, 1.0) == (0, 0, 0)


def test_what_is_handed_on_is_bounded():
    assert kernels.bounded((3.0, -4.0, 1e-3)) == (3.0, -4.0, 1e-3)
    assert kernels.bounded((3e12, -4e12, 0.0)) == pytest.approx((0.75e8, -1e8, 0.0))
    assert kernels.bounded((1e308, 1e308, 1e308)) == pytest.approx((1e8, 1e8, 1e8))
    for bad in (np.inf, -np.inf, np.nan):
        assert kernels.bounded((1.0, bad, 0.0)) == (0, 0, 0)
        assert kernels.bounded((bad, 1.0, bad)) == (0, 0, 0)
