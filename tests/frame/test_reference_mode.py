"""Whole frames in reference mode: what they agree with, what changes them, what stops them."""

import threading

import numpy as np
import pytest

import raysvc
from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import sheet, sphere
from raysvc.errors import Cancelled, DeadlineExceeded, LimitExceeded
from raysvc.lens.coc import coc_px
from raysvc.limits import Limits
from raysvc.parallel import Control
from raysvc.scene import Material
from tests.frame.subjects import GREY, VIEW, ball, constant_environment, still_life
from tests.oracles.directional_albedo import directional_albedo

REFERENCE = {"mode": "reference", "samples": 4}
FRONT = {"eye": [0.0, 0.0, 4.0], "target": [0.0, 0.0, 0.0], "width": 48, "height": 48}
SMALL = VIEW | {"width": 64, "height": 36}


def rendered(scene=None, view=SMALL, environment=None, **settings):
    scene = still_life() if scene is None else scene
    return raysvc.render(scene, environment, view, REFERENCE | settings)


def beauty(*arguments, **settings):
    return rendered(*arguments, **settings).layers["beauty"]


def test_the_same_request_gives_the_same_bytes_with_1_2_and_5_threads():
    view = SMALL | {"aperture_radius": 0.05}
    encoded = {rendered(view=view, threads=threads).encode("exr") for threads in (1, 2, 5)}
    assert len(encoded) == 1


def test_the_same_request_gives_the_same_bytes_when_samples_come_in_one_more_pass():
    """Samples beyond the first pass are added, in the same order for every pixel."""
    whole = beauty(samples=24).astype(float)
    first = beauty(samples=16).astype(float)
    rest = (whole * 24 - first * 16) / 8
    assert rest.min() > -1e-3
    assert not np.allclose(rest, first)


@pytest.mark.parametrize(
    "changed",
    [{"seed": 1}, {"samples": 5}, {"bounces": 1}, {"environment_yaw_deg": 90}, {"lens": "none"}],
)
def test_a_setting_changes_the_picture(changed):
    view = SMALL | {"aperture_radius": 0.1}
    assert not np.array_equal(beauty(view=view), beauty(view=view, **changed))


@pytest.mark.parametrize(
    "changed",
    [
        {"occlusion_samples": 0},
        {"shadows": False},
        {"aa": "none"},
        {"texture_filter": "nearest"},
        {"ibl_lobe_samples": 1},
        {"trees": "per_material"},
    ],
)
def test_approximations_of_the_hybrid_mode_do_not_touch_it(changed):
    np.testing.assert_array_equal(beauty(), beauty(**changed))


def test_structures_and_seeds_agree_on_the_whole():
    """Without a sun, whose light off the mirror ball only few paths find."""
    sky = constant_environment()
    one = beauty(None, SMALL, sky, samples=64, structure="embree")
    other = beauty(None, SMALL, sky, samples=64, structure="bvh", seed=9)
    assert not np.array_equal(one, other)
    np.testing.assert_allclose(one.mean(axis=(0, 1)), other.mean(axis=(0, 1)), rtol=2e-3)


@pytest.mark.parametrize("structure", ["bvh_stackless", "kd", "bih"])
def test_structures_that_agree_give_the_same_bytes(structure):
    np.testing.assert_array_equal(beauty(structure="bvh"), beauty(structure=structure))


@pytest.mark.parametrize("metallic", [0.0, 1.0])
def test_a_ball_under_constant_light_shows_the_directional_albedo(metallic):
    base = (0.8, 0.5, 0.2)
    material = Material(base_colour=(*base, 1.0), metallic=metallic, roughness=0.4)
    frame = rendered(ball(material, 96), FRONT, constant_environment(), samples=64)
    normal, seen = frame.layers["normal"], frame.layers["id"] >= 0
    rows, cols = np.nonzero(seen)
    tan = np.tan(np.radians(20))
    towards = np.stack(
        [(cols + 0.5 - 24) / 24 * tan, (24 - rows - 0.5) / 24 * tan, -np.ones(len(rows))], axis=1
    )
    towards /= np.linalg.norm(towards, axis=1)[:, None]
    cosine = -np.einsum("nk,nk->n", towards, normal[seen])
    for near in (0.9, 0.6):
        chosen = np.abs(cosine - near) < 0.03
        expected = directional_albedo(cosine[chosen].mean(), base, metallic, 0.4)
        shown = frame.layers["beauty"][seen][chosen][:, :3].mean(axis=0)
        np.testing.assert_allclose(shown, expected, rtol=5e-3)


def test_unlit_surfaces_are_anti_aliased_as_fully_as_hybrid_ones():
    """Both average the square of the pixel."""
    white = Material(unlit=True, double_sided=True)
    tilted = sheet(1.3, 0.9, 1, 1).turned(90, 0).turned(17, 2)
    scene = scene_of("card", [Part(tilted, 0)], [white])
    black = {"background": [0, 0, 0]}
    full = raysvc.render(scene, None, FRONT, black | {"aa": "full", "aa_samples": 64})
    found = beauty(scene, FRONT, samples=256, **black)
    assert np.abs(found - full.layers["beauty"]).max() < 0.06
    area_px = 1.3 * 0.9 * (24 / (4 * np.tan(np.radians(20)))) ** 2
    assert found[..., 0].sum() == pytest.approx(area_px, rel=2e-3)


@pytest.mark.parametrize("background", ["environment", "transparent", [0.25, 0.5, 0.75]])
def test_the_background_is_behind_everything(background):
    pane = Material(base_colour=(0.0, 1.0, 0.0, 0.25), alpha_mode="blend", unlit=True)
    scene = scene_of("pane", [Part(sheet(1.2, 1.2, 1, 1).turned(90, 0), 0)], [pane])
    found = beauty(scene, FRONT, constant_environment(2.0), background=background, samples=256)
    behind = {"environment": (2, 2, 2, 1), "transparent": (0, 0, 0, 0)}.get(
        str(background), (0.25, 0.5, 0.75, 1)
    )
    np.testing.assert_allclose(found[0, 0], behind, rtol=1e-6)
    expected = 0.75 * np.array(behind) + 0.25 * np.array([0, 1, 0, 1])
    np.testing.assert_allclose(found[24, 24], expected, atol=0.02)


@pytest.mark.parametrize("distance", [2.0, 6.0])
def test_a_bright_dot_blurs_to_its_circle_of_confusion(distance):
    dot = Material(unlit=True)
    size = 0.004 * distance
    scene = scene_of("dot", [Part(sphere(size, 16).moved([0, 0, -distance]), 0)], [dot])
    view = {
        "world_from_camera": np.eye(4).tolist(),
        "fov_y_deg": 20,
        "width": 64,
        "height": 64,
        "aperture_radius": 0.2,
        "focus_distance": 3.0,
    }
    frame = rendered(scene, view, samples=512, background=[0, 0, 0])
    light = frame.layers["beauty"][..., 0].astype(float)
    at = np.arange(64) - 31.5
    across = (light.sum(axis=0) @ at**2) / light.sum()
    # A disc of diameter d has variance d^2 / 16 along an axis; so has the dot, and a pixel 1/12
    px = 64 / (2 * np.tan(np.radians(10)))
    camera = raysvc.frame.view.camera_from(raysvc.View(**view), scene)
    coc = abs(coc_px(camera, np.float32([distance]))[0])
    assert coc > 8
    expected = coc**2 / 16 + (2 * size * px / distance) ** 2 / 16 + 1 / 12
    assert across == pytest.approx(expected, rel=0.03)
    # And it is a disc: even inside, nothing outside
    radius = np.hypot(*np.meshgrid(at, at))
    inside = light[radius < coc / 2 - 2]
    assert inside.std() < 0.25 * inside.mean()
    assert light[radius > coc / 2 + 2.5].sum() < 0.002 * light.sum()


def test_layers_are_those_of_the_raster():
    view = SMALL | {"aperture_radius": 0.05}
    frame, hybrid = rendered(view=view), raysvc.render(still_life(), camera=view)
    for name in ("depth", "normal", "albedo", "id", "object", "material", "coc"):
        np.testing.assert_array_equal(frame.layers[name], hybrid.layers[name])
    assert set(hybrid.layers) - set(frame.layers) == {"occlusion", "bent_normal", "edge"}
    assert frame.statistics.max_coc_px == hybrid.statistics.max_coc_px > 0
    assert "coc" not in rendered(view=view, lens="none").layers


def test_statistics_and_progress():
    told = []
    control = Control(on_progress=lambda stage, part: told.append((stage, part)))
    frame = raysvc.render(
        still_life(), camera=SMALL, settings=REFERENCE | {"samples": 40}, control=control
    )
    statistics = frame.statistics.to_dict()
    names = [stage["name"] for stage in statistics["stages"]]
    assert names == ["prepare", "rasterise", "layers", "paths"]
    assert statistics["rays"]["primary"] == 64 * 36 * 40
    assert {"primary", "path", "shadow"} == set(statistics["rays"])
    assert statistics["edge_fraction"] == 0.0
    parts = [part for stage, part in told if stage == "paths"]
    assert parts == sorted(parts) and len(parts) == 9
    assert parts[-1] == 1.0


def test_an_empty_scene_is_all_background():
    scene = ball(GREY, 8)
    triangles = {
        name: np.zeros((0, *getattr(scene, name).shape[1:]), np.int32)
        for name in ("triangles", "material_of_triangle", "object_of_triangle")
    }
    vertices = {
        name: getattr(scene, name)
        for name in ("positions", "normals", "tangents", "uv", "colours", "materials")
    }
    frame = rendered(
        raysvc.Scene(**vertices, **triangles), {"width": 8, "height": 4}, constant_environment()
    )
    assert (frame.layers["beauty"] == 1).all()


def test_a_frame_without_any_light_is_black():
    found = beauty(ball(GREY, 16), FRONT, constant_environment(0.0))
    assert not found[..., :3].any()


def test_a_cancelled_frame_stops():
    reached = threading.Event()

    def progress(stage, fraction):
        if stage == "paths":
            reached.set()
            control.cancel()

    control = Control(threads=2, on_progress=progress)
    with pytest.raises(Cancelled):
        raysvc.render(still_life(), camera=VIEW, settings=REFERENCE, control=control)
    assert reached.is_set()


def test_a_deadline_ends_a_frame():
    with pytest.raises(DeadlineExceeded):
        rendered(samples=65536, deadline_s=0.5)


def test_more_paths_than_the_limit_are_refused_by_name():
    limits = Limits(max_paths=64 * 36 * 4)
    with pytest.raises(LimitExceeded) as caught:
        raysvc.render(
            still_life(), camera=SMALL, settings=REFERENCE | {"samples": 5}, limits=limits
        )
    assert caught.value.field == "settings.samples"
    raysvc.render(still_life(), camera=SMALL, settings={"samples": 5}, limits=limits)
    raysvc.render(still_life(), camera=SMALL, settings=REFERENCE, limits=limits)
