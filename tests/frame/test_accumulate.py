"""The mean of pictures through a pinhole all over the lens, against paths through the lens."""

from dataclasses import replace

import numpy as np
import pytest

import raysvc
from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import sphere
from raysvc.errors import Cancelled, InvalidSetting, LimitExceeded
from raysvc.frame.refocus import refocus
from raysvc.limits import Limits
from raysvc.parallel import Control
from raysvc.scene import SceneCamera
from tests.frame.subjects import constant_environment, still_life
from tests.frame.test_lens import NEAR_BLUR, PLAIN, RED, VIEW, post_before_a_wall, rendered

ACCUMULATED = {"lens": "accumulate"}


@pytest.mark.parametrize("blades", [0, 3])
def test_it_is_what_paths_through_the_lens_see(blades: int) -> None:
    scene, opening = post_before_a_wall(RED), {"aperture_blades": blades}
    true = rendered(scene, NEAR_BLUR, mode="reference", samples=256, **opening)
    found = rendered(scene, NEAR_BLUR, **ACCUMULATED, lens_samples=256, **opening)
    # Both draw their own 256 places of the lens; of random ones, three standard deviations of a
    # pixel's difference would be 3 sqrt(2) 0.5 / 16 = 0.13.
    assert np.abs(found - true).mean() < 0.002
    assert np.abs(found - true).max() < 0.13


def test_an_orthographic_lens_leans_its_rays() -> None:
    pose = np.eye(4)
    pose[:3, 3] = [0, 0, 5]
    scene = replace(post_before_a_wall(RED), cameras=(SceneCamera(pose, height_m=4.0),))
    view = {"width": 120, "height": 68, "gltf_camera": 0}
    view |= {"aperture_radius": 0.4, "focus_distance": 7.0}
    pictures = [
        raysvc.render(scene, constant_environment(), view, PLAIN | mode).layers["beauty"]
        for mode in (ACCUMULATED | {"lens_samples": 256}, {"mode": "reference", "samples": 256})
    ]
    assert pictures[1][..., 2].max() > 0.1
    assert np.abs(pictures[0] - pictures[1]).mean() < 0.002


def test_more_samples_come_nearer_and_one_is_a_pinhole() -> None:
    scene = post_before_a_wall(RED)
    true = rendered(scene, NEAR_BLUR, mode="reference", samples=1024)
    errors = [
        np.abs(rendered(scene, NEAR_BLUR, **ACCUMULATED, lens_samples=n) - true).mean()
        for n in (1, 16, 128)
    ]
    assert errors[1] < 0.3 * errors[0] and errors[2] < 0.4 * errors[1]


def test_layers_and_a_frame_without_a_lens_are_those_of_the_middle() -> None:
    scene, light = still_life(), constant_environment()
    few = ACCUMULATED | {"lens_samples": 2}
    found = raysvc.render(scene, light, VIEW | NEAR_BLUR, few)
    spread = raysvc.render(scene, light, VIEW | NEAR_BLUR)
    for name in ("depth", "id", "coc"):
        assert np.array_equal(found.layers[name], spread.layers[name]), name
    assert found.statistics.max_coc_px == spread.statistics.max_coc_px > 1
    plain = raysvc.render(scene, light, VIEW).layers["beauty"]
    assert np.array_equal(raysvc.render(scene, light, VIEW, few).layers["beauty"], plain)


def test_chance_evens_out_over_the_samples() -> None:
    """Soft shadows and occlusion of a sharp picture are asked anew for each of them."""
    scene, light = still_life(), constant_environment()
    view = VIEW | {"aperture_radius": 1e-9, "eye": [0.5, 2.0, 5.0]}
    seeds = [
        [
            raysvc.render(scene, light, view, ACCUMULATED | {"lens_samples": n, "seed": seed})
            for seed in (3, 4)
        ]
        for n in (1, 16)
    ]
    few, many = (np.abs(a.layers["beauty"] - b.layers["beauty"]).mean() for a, b in seeds)
    assert many < 0.4 * few


def test_a_sharp_picture_is_accumulated_too() -> None:
    """As anti-aliasing: nearer to many pictures than one whose edges alone are smooth."""
    scene, light = still_life(), constant_environment()
    view = VIEW | {"eye": [0.5, 2.0, 5.0]}
    many = {"aa": "accumulate", "aa_samples": 64, "seed": 5}
    true = raysvc.render(scene, light, view, many).layers["beauty"]
    errors = [
        np.abs(raysvc.render(scene, light, view, settings).layers["beauty"] - true).mean()
        for settings in ({"aa": "accumulate", "aa_samples": 16}, {"aa": "edges"})
    ]
    assert errors[0] < 0.6 * errors[1]
    frame = raysvc.render(scene, light, view | NEAR_BLUR, {"aa": "accumulate", "aa_samples": 2})
    assert frame.statistics.edge_fraction == 1.0
    assert frame.statistics.max_coc_px > 1


def test_the_bits_do_not_depend_on_the_number_of_threads() -> None:
    few = ACCUMULATED | {"lens_samples": 3, "seed": 2**32 - 1}
    one, two = (
        raysvc.render(still_life(), camera=VIEW | NEAR_BLUR, settings=few | {"threads": threads})
        for threads in (1, 3)
    )
    assert np.array_equal(one.layers["beauty"], two.layers["beauty"])


def test_a_probe_is_captured_once() -> None:
    probe = {"probe_at": (0.0, 0.5, 0.0), "size": 16, "environment": constant_environment()}
    few = ACCUMULATED | {"lens_samples": 3}
    frame = raysvc.render(still_life(), probe, VIEW | NEAR_BLUR, few)
    assert frame.statistics.probe is not None and frame.statistics.probe.rebuilt
    without = raysvc.render(still_life(), constant_environment(), VIEW | NEAR_BLUR, few)
    assert not np.array_equal(frame.layers["beauty"], without.layers["beauty"])


def test_it_tells_how_far_it_is_and_stops() -> None:
    heard = []

    def hear(stage: str, fraction: float) -> None:
        heard.append((stage, fraction))
        if stage == "lens" and fraction >= 0.5:
            control.cancel()

    control = Control(threads=1, on_progress=hear)
    scene = scene_of("ball", [Part(sphere(0.5, 8), 0)], [RED])
    with pytest.raises(Cancelled):
        raysvc.render(
            scene,
            camera=VIEW | NEAR_BLUR,
            settings=ACCUMULATED | {"lens_samples": 4},
            control=control,
        )
    assert [fraction for stage, fraction in heard if stage == "lens"] == [0.0, 0.25, 0.5]


def test_more_samples_than_a_service_grants_are_refused() -> None:
    limits, view = Limits(max_paths=120 * 68 * 4), VIEW | NEAR_BLUR
    with pytest.raises(LimitExceeded, match=r"settings\.lens_samples"):
        raysvc.render(still_life(), camera=view, settings=ACCUMULATED, limits=limits)
    raysvc.render(still_life(), camera=VIEW, settings=ACCUMULATED, limits=limits)


def test_a_finished_picture_cannot_be_sampled_again() -> None:
    picture, depth = np.ones((8, 8, 4), np.float32), np.ones((8, 8), np.float32)
    with pytest.raises(InvalidSetting, match=r"settings\.lens"):
        refocus(picture, depth, {"aperture_radius": 0.1}, ACCUMULATED)
