"""The lens of a frame: what it shows of what is hidden, and what it leaves alone."""

from dataclasses import replace

import numpy as np
import pytest

import raysvc
from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import sheet, sphere
from raysvc.scene import Material, Scene, SceneCamera
from tests.frame.subjects import constant_environment, still_life

UNLIT = {"unlit": True, "double_sided": True}
PLAIN = {"background": [0.0, 0.0, 0.0], "occlusion_samples": 0, "shadows": False}
VIEW = {"eye": [0, 0, 5], "target": [0, 0, 0], "width": 120, "height": 68, "fov_y_deg": 40.0}


def colour(name: str, rgb: tuple[float, float, float], **changes: object) -> Material:
    return Material(name, base_colour=(*rgb, 1.0), **{**UNLIT, **changes})


def upright(width: float, height: float, where: list[float], material: int) -> Part:
    return Part(sheet(width, height, 1, 1).turned(90, 0).moved(where), material)


def post_before_a_wall(post: Material) -> Scene:
    """A near post hides the middle of a wall that is green, and blue just behind the post."""
    parts = [
        upright(20, 20, [0, 0, -2], 0),
        upright(1.0, 20, [0, 0, -1.99], 1),
        upright(0.4, 20, [0, 0, 2.5], 2),
    ]
    return scene_of("post", parts, [colour("g", (0, 1, 0)), colour("b", (0, 0, 1)), post])


RED = colour("r", (1, 0, 0))


def rendered(scene: Scene, view: dict, **settings: object) -> np.ndarray:
    frame = raysvc.render(scene, constant_environment(), VIEW | view, PLAIN | settings)
    return frame.layers["beauty"]


NEAR_BLUR = {"aperture_radius": 0.12, "focus_distance": 7.0}


def test_what_is_behind_a_blurred_foreground_is_traced_and_not_guessed() -> None:
    """The blue strip is wholly hidden from the middle of the lens; only its rim sees it."""
    sharp = rendered(post_before_a_wall(RED), {})
    assert np.all(sharp[..., 2] == 0)
    true = rendered(post_before_a_wall(RED), NEAR_BLUR, mode="reference", samples=256)
    blurred = rendered(post_before_a_wall(RED), NEAR_BLUR)
    gathered = rendered(post_before_a_wall(RED), NEAR_BLUR, lens="gather")
    assert true[..., 2].max() > 0.2
    assert np.abs(blurred - true)[10:-10].mean() < 0.01
    assert np.abs(blurred - true)[10:-10].max() < 0.2
    assert np.abs(gathered - true).mean() > 2 * np.abs(blurred - true).mean()


@pytest.mark.parametrize("alpha_mode", ["blend", "mask"])
def test_a_pane_is_blurred_by_its_own_depth(alpha_mode: str) -> None:
    pane = Material("pane", (1.0, 0.0, 0.0, 0.6), alpha_mode=alpha_mode, alpha_cutoff=0.5, **UNLIT)
    scene = post_before_a_wall(pane)
    true = rendered(scene, NEAR_BLUR, mode="reference", samples=256)
    blurred = rendered(scene, NEAR_BLUR)
    assert np.abs(blurred - true)[10:-10].mean() < 0.012
    assert np.ptp(blurred[34, :, 0]) > 0.5


def test_a_transparent_background_is_seen_past_a_blurred_edge() -> None:
    scene = scene_of("card", [upright(1.5, 1.5, [0, 0, 1], 0)], [RED])
    view = {"aperture_radius": 0.1, "focus_distance": 9.0}
    true = rendered(scene, view, mode="reference", samples=256, background="transparent")
    blurred = rendered(scene, view, background="transparent")
    assert blurred[0, 0, 3] == 0
    assert np.abs(blurred - true).mean() < 0.01
    assert np.allclose(blurred[..., 0], blurred[..., 3], atol=1e-5)


def test_something_nearer_and_blurred_by_more_than_the_picture_is_a_veil() -> None:
    parts = [upright(20, 20, [0, 0, 0], 0), upright(0.05, 0.05, [0, 0, 4.9], 1)]
    scene = scene_of("veil", parts, [colour("g", (0, 1, 0)), RED])
    view = {"aperture_radius": 0.4, "focus_distance": 5.0}
    blurred = rendered(scene, view)
    assert raysvc.render(scene, camera=VIEW | view).statistics.max_coc_px > 120
    assert np.isfinite(blurred).all()
    assert 0 < blurred[5, 5, 0] < 0.2 and blurred[..., 1].min() > 0.5
    # One colour takes the other's place: nothing is brighter or darker than a surface.
    assert np.allclose(blurred[..., 0] + blurred[..., 1], 1.0, atol=1e-3)


def test_pixels_in_focus_keep_the_bits_that_they_have_without_a_lens() -> None:
    view = {"aperture_radius": 0.2, "focus_distance": 5.0}
    scene = scene_of(
        "focus",
        [upright(1, 1, [0, 0, 0], 0), upright(30, 30, [0, 0, -9], 1)],
        [RED, colour("g", (0, 1, 0))],
    )
    blurred = raysvc.render(scene, camera=VIEW | view)
    sharp = raysvc.render(scene, camera=VIEW | view, settings={"lens": "none"})
    in_focus = np.abs(blurred.layers["coc"]) < 1
    assert 100 < in_focus.sum() < 0.3 * in_focus.size
    assert np.array_equal(blurred.layers["beauty"][in_focus], sharp.layers["beauty"][in_focus])


def test_a_silhouette_in_focus_stays_smooth_before_a_blurred_background() -> None:
    """Pixels that it cuts show part of it, whether their centre does or not."""
    wall = [upright(30, 30, [0, 0, -9], 1)]
    ball = Part(sphere(0.7, 64), 0)
    scene = scene_of("ball", [ball, *wall], [RED, colour("g", (0, 1, 0))])
    view = {"aperture_radius": 0.05, "focus_distance": 4.95}
    true = rendered(scene, view, mode="reference", samples=64)
    blurred = rendered(scene, view)
    rough = rendered(scene, view, aa="none")
    edge = (true[..., 0] > 0.1) & (true[..., 0] < 0.9)
    assert np.abs(blurred - true)[edge].mean() < 0.6 * np.abs(rough - true)[edge].mean()


def test_rotation_turns_what_a_highlight_becomes_as_it_turns_the_lens() -> None:
    lamp = Material("lamp", (0.0, 0.0, 0.0, 1.0), emissive=(40.0, 40.0, 40.0))
    scene = scene_of("lamp", [Part(sphere(0.08, 16).moved([0, 0, -20]), 0)], [lamp])
    view = {"aperture_radius": 0.12, "focus_distance": 3.0, "fov_y_deg": 12.0}
    blades = {"aperture_blades": 3}
    # Paths that find the lamp are few; pictures through the lens all do.
    samples = {"lens": "accumulate", "lens_samples": 256}
    # Of eight samples in a pixel too few or too many may show so small a lamp.
    fine = {"aa_samples": 64}
    for turned in (0.0, 180.0):
        pictures = [
            rendered(scene, view, **blades, **mode, aperture_rotation_deg=turned)[..., 0]
            for mode in (fine, samples)
        ]
        for picture in pictures:
            rows = np.flatnonzero(picture.max(axis=1) > 0.2 * picture.max())
            wide = (picture[rows] > 0.2 * picture.max()).sum(axis=1)
            narrow_end, wide_end = wide[:3].mean(), wide[-3:].mean()
            assert (narrow_end < wide_end) == (turned == 0.0)
        # The lamp has 3.4 pixels, the triangle 169: over 4 x 4 pixels 256 * 3.4 / 169 * 16 = 82 of
        # the samples meet it, and of random ones the mean deviation would be 0.8 / sqrt(82) = 0.09.
        one, other = (p.reshape(17, 4, 30, 4).mean(axis=(1, 3)) for p in pictures)
        assert np.abs(one - other).mean() < 0.09 * other.mean()


def test_the_bits_do_not_depend_on_the_number_of_threads() -> None:
    view = {"eye": [0.5, 2.0, 5.0], "target": [0.0, 0.6, 0.0], "aperture_radius": 0.15}
    one, two = (
        raysvc.render(
            still_life(), camera=VIEW | view, settings={"threads": threads, "aperture_blades": 6}
        ).layers["beauty"]
        for threads in (1, 3)
    )
    assert np.array_equal(one, two)


@pytest.mark.parametrize("double_sided", [True, False])
def test_the_inside_of_a_closed_thing_is_not_what_it_hides(double_sided: bool) -> None:
    """A ray that goes on inside of a ball leaves it before it meets what the lens sees."""
    red = Material("ball", (1.0, 0.0, 0.0, 1.0), unlit=True, double_sided=double_sided)
    parts = [Part(sphere(0.5, 48).moved([0, 0, 2.0]), 0), upright(20, 20, [0, 0, -4], 1)]
    scene = scene_of("ball", parts, [red, colour("g", (0, 1, 0))])
    view = {"aperture_radius": 0.15, "focus_distance": 9.0}
    true = rendered(scene, view, mode="reference", samples=256)
    blurred = rendered(scene, view)
    assert np.abs(blurred - true).mean() < 0.006


def test_an_orthographic_lens_sees_behind_things_too() -> None:
    pose = np.eye(4)
    pose[:3, 3] = [0, 0, 5]
    camera = SceneCamera(pose, height_m=4.0)
    post = post_before_a_wall(RED)
    scene = replace(post, cameras=(camera,))
    view = {"width": 120, "height": 68, "gltf_camera": 0}
    view |= {"aperture_radius": 0.4, "focus_distance": 7.0}
    pictures = [
        raysvc.render(scene, constant_environment(), view, PLAIN | mode).layers["beauty"]
        for mode in ({}, {"mode": "reference", "samples": 256})
    ]
    assert pictures[1][..., 2].max() > 0.1
    assert np.abs(pictures[0] - pictures[1])[10:-10].mean() < 0.01


def test_without_a_lens_nothing_hidden_is_looked_for() -> None:
    for lens, view in (("none", NEAR_BLUR), ("gather", NEAR_BLUR), ("spread", {})):
        scene = post_before_a_wall(RED)
        frame = raysvc.render(scene, camera=VIEW | view, settings={"lens": lens, "aa": "none"})
        assert "primary" not in frame.statistics.rays
    frame = raysvc.render(scene, camera=VIEW | NEAR_BLUR, settings={"aa": "none"})
    assert 0 < frame.statistics.rays["primary"] < 0.6 * 120 * 68


def test_small_lamps_out_of_focus_keep_their_light() -> None:
    """A lamp of two pixels, anti-aliased, is spread with all of its light and no more."""
    lamp = Material("lamp", (0.0, 0.0, 0.0, 1.0), emissive=(40.0, 40.0, 40.0))
    balls = [Part(sphere(0.08, 16).moved([x, 0.3 * x, -20]), 0) for x in (-1.1, 0.03, 0.77)]
    scene = scene_of("lamps", balls, [lamp])
    view = {"fov_y_deg": 12.0, "focus_distance": 3.0}
    sharp = rendered(scene, view)
    blurred = rendered(scene, view | {"aperture_radius": 0.1})
    assert blurred[..., 0].max() < 0.1 * sharp[..., 0].max()
    assert blurred[..., 0].sum() == pytest.approx(sharp[..., 0].sum(), rel=0.02)
