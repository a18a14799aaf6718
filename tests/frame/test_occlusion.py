"""Ambient light in pictures: closed forms, smoothness, bent normals, and how far it reaches."""

import numpy as np
import pytest

import raysvc
from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import box, sheet, sphere
from raysvc.scene import Material
from tests.frame.subjects import constant_environment

BLACK = Material(base_colour=(0, 0, 0, 1), metallic=0.0, roughness=1.0, double_sided=True)
GREY = Material(base_colour=(0.5, 0.5, 0.5, 1), metallic=0.0, roughness=1.0, double_sided=True)


def beside_a_wall():
    """A floor, and a high black wall along the plane x = 0."""
    wall = sheet(4000.0, 4000.0, 1, 1).turned(90, 2)
    return scene_of("wall", [Part(sheet(8000.0, 8000.0, 1, 1), 0), Part(wall, 1)], [GREY, BLACK])


def under_a_ball():
    ball = sphere(1.0, 60).moved([0.0, 1.5, 0.0])
    return scene_of("ball", [Part(sheet(60.0, 60.0, 1, 1), 0), Part(ball, 1)], [GREY, BLACK])


def floor_of(scene, view, **settings):
    frame = raysvc.render(
        scene, constant_environment(1.0), view, {"aa": "none", "bounces": 0} | settings
    )
    camera = raysvc.frame.view.camera_from(raysvc.View(**view), scene)
    on_floor = np.flatnonzero((frame.layers["object"] == 0).ravel())
    origins, directions = camera.rays(on_floor)
    at = origins - directions * (origins[:, 1] / directions[:, 1])[:, None]
    return frame, on_floor, at


def test_beside_an_endless_wall_half_is_free_and_bent_away() -> None:
    view = {"eye": [3.0, 2.0, 0.0], "target": [1.0, 0, 0.0], "width": 64, "height": 48}
    frame, on_floor, _ = floor_of(beside_a_wall(), view)
    visible = frame.layers["occlusion"].ravel()[on_floor]
    assert visible == pytest.approx(np.full(len(visible), 0.5), abs=0.03)
    bent = frame.layers["bent_normal"].reshape(-1, 3)[on_floor].astype(float)
    # Mean of the cosine-weighted directions with x > 0: (4 / 3 pi, 2 / 3) of its height.
    expected = np.array([4 / (3 * np.pi), 2 / 3, 0])
    expected /= np.linalg.norm(expected)
    assert (bent @ expected).min() > 0.99
    assert np.linalg.norm(bent, axis=1) == pytest.approx(np.ones(len(bent)), abs=1e-5)


def test_under_a_ball_its_form_factor_is_hidden() -> None:
    view = {"eye": [0.0, 1.1, 2.2], "target": [0, 0.0, 1.2], "width": 96, "height": 64}
    frame, on_floor, at = floor_of(under_a_ball(), view)
    visible = frame.layers["occlusion"].ravel()[on_floor]
    # A ball that is all above the horizon: r^2 cos / d^2 (Howell, configuration B-45).
    distance2 = (at[:, [0, 2]] ** 2).sum(axis=1) + 1.5**2
    hidden = 1.5 / distance2**1.5
    near = distance2 < 30.0
    error = visible - (1 - hidden)
    assert near.sum() > 500
    assert np.sqrt((error[near] ** 2).mean()) < 0.012
    assert np.abs(error[near]).max() < 0.06


def test_sixteen_rays_look_smooth() -> None:
    view = {"eye": [0.0, 3.0, 5.0], "target": [0, 0.0, 0.5], "width": 96, "height": 64}
    frame, on_floor, _ = floor_of(under_a_ball(), view)
    picture = np.full(frame.layers["occlusion"].size, np.nan)
    picture[on_floor] = frame.layers["occlusion"].ravel()[on_floor]
    picture = picture.reshape(64, 96)
    for axis in (0, 1):
        rough = np.diff(picture, 2, axis=axis)
        assert np.nanstd(rough) < 0.012


def test_bent_normals_and_occlusion_of_the_open_are_the_normals_and_1() -> None:
    ball = scene_of("ball", [Part(sphere(1.0, 48), 0)], [GREY])
    view = {"eye": [0, 0, 4.0], "target": [0, 0, 0], "width": 32, "height": 32}
    frame = raysvc.render(ball, constant_environment(), view, {"aa": "none"})
    seen = frame.layers["id"] >= 0
    cosine = (frame.layers["bent_normal"] * frame.layers["normal"])[seen].sum(axis=1)
    assert cosine.min() > 0.9999
    assert frame.layers["occlusion"][seen].min() == 1.0
    assert not frame.layers["bent_normal"][~seen].any()


def test_a_radius_limits_how_far_it_reaches() -> None:
    view = {"eye": [0.0, 1.2, 5.0], "target": [0, 0.0, 0.5], "width": 32, "height": 24}
    near = floor_of(under_a_ball(), view, occlusion_radius=0.4)[0].layers["occlusion"]
    far = floor_of(under_a_ball(), view)[0].layers["occlusion"]
    assert near[far < 0.9].min() == 1.0 and far.min() < 0.7


def test_by_default_it_reaches_all_that_is_there() -> None:
    """A room that is closed is dark, however long it is: no light comes through walls."""
    hall = scene_of("hall", [Part(box(2.0, 2.0, 60.0).moved([0, -1, 0]), 0)], [GREY])
    view = {"eye": [0.1, 0.07, 29.0], "target": [0, 0, 0], "width": 24, "height": 24}
    frame = raysvc.render(hall, constant_environment(3.0), view, {"aa": "none"})
    assert frame.layers["beauty"][..., :3].max() < 1e-3
    assert not frame.layers["occlusion"].any()


def test_points_without_samples_are_open() -> None:
    view = {"eye": [3.0, 2.0, 0.0], "target": [1.0, 0, 0.0], "width": 16, "height": 12}
    frame, on_floor, _ = floor_of(beside_a_wall(), view, occlusion_samples=0)
    assert (frame.layers["occlusion"] == 1).all()
    bent = frame.layers["bent_normal"].reshape(-1, 3)[on_floor]
    assert bent == pytest.approx(frame.layers["normal"].reshape(-1, 3)[on_floor], abs=1e-6)
    assert "occlusion" not in frame.statistics.rays
