import numpy as np
import pytest

import raysvc
from raysvc.accel.base import Triangles
from raysvc.accel.registry import build
from raysvc.compare.ray_sets import RAY_KINDS, ray_set
from raysvc.errors import InvalidSetting
from raysvc.scene import PunctualLight
from tests.scenes import camera, mesh, quad

COUNT = 3000


@pytest.fixture(scope="module")
def cornell():
    return raysvc.load("builtin:cornell")


def inside(**more):
    """A camera that looks into the Cornell box, which is a little wider than a metre."""
    return camera(eye=(0, 1, 3.5), target=(0, 1, 0), width=60, height=40, **more)


def floor_below():
    """A square of 20 metres at z = 0, and a camera that looks down on it aslant."""
    return quad(half=10.0), camera(eye=(1, -3, 4), target=(0, 0, 0), up=(0, 0, 1), half_height=0.3)


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def arrays(rays):
    return rays.origins, rays.directions, rays.t_max


@pytest.mark.parametrize("kind", RAY_KINDS)
@pytest.mark.parametrize("count", [1, 777, COUNT])
def test_there_are_exactly_as_many_rays_as_wanted_and_they_are_unit(kind, count, cornell):
    rays = ray_set(kind, cornell, inside(), count, 0).rays
    assert len(rays) == count
    np.testing.assert_allclose(np.linalg.norm(rays.directions, axis=1), 1.0, atol=1e-6)
    assert np.isfinite(rays.origins).all()
    assert (rays.t_max > 0).all()


@pytest.mark.parametrize("kind", RAY_KINDS)
def test_a_seed_decides_the_rays(kind, cornell):
    first, again, other = (ray_set(kind, cornell, inside(), COUNT, seed).rays for seed in (3, 3, 4))
    for a, b in zip(arrays(first), arrays(again), strict=True):
        np.testing.assert_array_equal(a, b)
    # Mirrors and cameras leave nothing to chance where every pixel shows something.
    if kind in ("random", "diffuse"):
        assert (first.directions != other.directions).any()


def test_random_rays_are_uniform_in_the_box_and_on_the_sphere(cornell):
    rays = ray_set("random", cornell, inside(), 20_000, 1).rays
    low, high = cornell.bounds()
    place = (rays.origins - low) / (high - low)
    assert (place >= 0).all() and (place <= 1).all()
    # Ten standard errors of the mean, and of the mean square.
    np.testing.assert_allclose(place.mean(axis=0), 0.5, atol=10 * 0.29 / 20_000**0.5)
    np.testing.assert_allclose(place.var(axis=0), 1 / 12, atol=0.01)
    np.testing.assert_allclose(rays.directions.mean(axis=0), 0.0, atol=10 * 0.58 / 20_000**0.5)
    spread = rays.directions.T @ rays.directions / 20_000
    np.testing.assert_allclose(spread, np.eye(3) / 3, atol=0.02)


def test_primary_rays_are_the_cameras_tile_by_tile(cornell):
    view = camera(width=64, height=48)
    rays = ray_set("primary", cornell, view, 64 * 48, 0).rays
    pixel = [row * 64 + col for row in range(8) for col in range(8)]
    origins, directions = view.rays(np.array(pixel))
    np.testing.assert_array_equal(rays.directions[:64], directions)
    np.testing.assert_array_equal(rays.origins[:64], origins)
    _, all_directions = view.rays(np.arange(64 * 48))
    assert {tuple(d) for d in rays.directions} == {tuple(d) for d in all_directions}


def test_a_view_keeps_its_shape_whatever_the_number_of_rays(cornell):
    view = camera(width=160, height=90)
    corner = unit(view.rays(np.array([0]))[1])[0]
    rays = ray_set("primary", cornell, view, 5000, 0).rays
    assert rays.directions[0] @ corner > 0.9998


def test_reflections_go_on_as_off_a_mirror():
    scene, view = floor_below()
    rays = ray_set("reflection", scene, view, COUNT, 0).rays
    arriving = unit(rays.origins - view.eye)
    np.testing.assert_allclose(rays.directions, arriving * [1, 1, -1], atol=1e-4)
    assert np.isinf(rays.t_max).all()


def test_diffuse_rays_follow_the_cosine():
    scene, view = floor_below()
    cosine = ray_set("diffuse", scene, view, 20_000, 0).rays.directions[:, 2].astype(float)
    assert (cosine > 0).all()
    assert cosine.mean() == pytest.approx(2 / 3, abs=0.01)
    assert (cosine**2).mean() == pytest.approx(1 / 2, abs=0.01)
    turn = ray_set("diffuse", scene, view, 20_000, 0).rays.directions[:, :2].mean(axis=0)
    np.testing.assert_allclose(turn, 0.0, atol=0.02)


def test_shadow_rays_end_at_the_light():
    scene, view = floor_below()
    light = PunctualLight("point", (1.0, 1.0, 1.0), position=(2.0, 3.0, 4.0))
    lit = mesh(scene.positions, scene.triangles, lights=(light,))
    made = ray_set("shadow", lit, view, COUNT, 0)
    assert made.query == "occluded"
    ends = made.rays.origins + made.rays.directions * made.rays.t_max[:, None]
    np.testing.assert_allclose(ends, np.tile([2, 3, 4], (COUNT, 1)), atol=0.01)


def test_without_lights_shadow_rays_look_for_the_sun():
    scene, view = floor_below()
    assert scene.lights == ()
    rays = ray_set("shadow", scene, view, 100, 0).rays
    assert len({tuple(d) for d in rays.directions}) == 1
    assert rays.directions[0, 1] > 0
    assert np.isinf(rays.t_max).all()


@pytest.mark.parametrize("kind", ["reflection", "diffuse"])
def test_rays_do_not_meet_what_they_leave(kind):
    scene, view = floor_below()
    rays = ray_set(kind, scene, view, COUNT, 0).rays
    structure = build("bvh", Triangles(scene.positions, scene.triangles))
    assert not structure.occluded(rays).any()
    assert (rays.origins[:, 2] > 0).all()


def test_where_pixels_are_empty_more_are_sampled():
    scene = quad(half=0.4)
    rays = ray_set("reflection", scene, camera(), COUNT, 0).rays
    assert len({tuple(o) for o in rays.origins}) == COUNT


@pytest.mark.parametrize("kind", ["reflection", "diffuse", "shadow"])
def test_a_camera_that_sees_nothing_is_refused(kind):
    with pytest.raises(InvalidSetting) as raised:
        ray_set(kind, quad(), camera(target=(0, 0, 10)), 100, 0)
    assert raised.value.field == "camera"
