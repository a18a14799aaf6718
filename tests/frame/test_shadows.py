"""Soft shadows: their profile, their smoothness, and what they leave as it was."""

import dataclasses

import numpy as np
import pytest

import raysvc
from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import box, sheet, sphere
from raysvc.frame.direct_light import ALONE, DirectLight
from raysvc.frame.prepared import prepare
from raysvc.frame.settings import Settings
from raysvc.frame.statistics import Ledger
from raysvc.frame.view import camera_from
from raysvc.lighting.area_light import SunDisc
from raysvc.lighting.sun import SunLight
from raysvc.scene import Environment, Material
from tests.frame.subjects import constant_environment, still_life
from tests.tracing.points import points

PLAIN = {"aa": "none", "occlusion_samples": 0, "bounces": 0}
GREY = Material(base_colour=(0.5, 0.5, 0.5, 1.0), metallic=0.0, double_sided=True)
TOWARDS = np.array([0.0, 0.8, 0.6])
LID_HEIGHT = 1.0
VIEW = {"eye": [0.2, 0.6, 1.2], "target": [0.0, 0.0, 0.4], "width": 96, "height": 64}


def half_lid():
    """A floor, and over the half of it where x < 0 a lid."""
    lid = sheet(100.0, 100.0, 1, 1).moved([-50.0, LID_HEIGHT, 0.0])
    return scene_of("half lid", [Part(sheet(60.0, 60.0, 1, 1), 0), Part(lid, 0)], [GREY])


def sun_of(radius_deg, monkeypatch):
    """Make frames light by a sun alone, of exactly this size."""
    radius = np.radians(radius_deg)
    sun = SunLight(tuple(TOWARDS.tolist()), (3.0, 3.0, 3.0), float(radius))

    def with_sun(*arguments):
        prepared = prepare(*arguments)
        prepared.light.suns = (sun,)
        return prepared

    monkeypatch.setattr("raysvc.frame.render.prepare", with_sun)
    return radius


def floor_of(scene, view, **more):
    """Part of the sun's light on the floor, (P,), its pixels' places (P, 3), and the picture."""
    frame = raysvc.render(scene, constant_environment(0.0), view, PLAIN | more)
    camera = camera_from(raysvc.View(**view), scene)
    on_floor = np.flatnonzero((frame.layers["object"] == 0).ravel())
    origins, directions = camera.rays(on_floor)
    at = origins - directions * (origins[:, 1] / directions[:, 1])[:, None]
    whole = raysvc.render(scene, constant_environment(0.0), view, PLAIN | {"shadows": False})
    lit, unshadowed = (f.layers["beauty"][..., 0].ravel()[on_floor] for f in (frame, whole))
    return lit / unshadowed, at, frame


@pytest.mark.parametrize(
    ("radius_deg", "rms", "most"), [(1.0, 0.09, 0.25), (4.0, 0.035, 0.16), (10.0, 0.02, 0.1)]
)
def test_a_penumbra_has_the_width_and_profile_of_the_disc(
    radius_deg, rms, most, monkeypatch
) -> None:
    """It is 4, 16 and 40 pixels wide."""
    radius = sun_of(radius_deg, monkeypatch)
    part, at, _ = floor_of(half_lid(), VIEW)
    # Behind an edge at a distance d along the ray, the disc rises over 2 d tan(radius).
    half_width = LID_HEIGHT / TOWARDS[1] * np.tan(radius)
    a = np.clip(at[:, 0] / half_width, -1, 1)
    expected = 0.5 + (a * np.sqrt(1 - a**2) + np.arcsin(a)) / np.pi
    within = np.abs(a) < 1
    error = (part - expected)[within]
    assert within.sum() > 200
    assert np.sqrt(np.mean(error**2)) < rms and np.abs(error).max() < most
    assert abs(error.mean()) < 0.01
    # Beyond it, by no more than a few pixels, all is dark or lit.
    pixel = 0.015
    assert part[at[:, 0] < -half_width - 5 * pixel].max() == 0
    assert part[at[:, 0] > half_width + 5 * pixel].min() == pytest.approx(1)


def test_a_wide_penumbra_has_no_noise(monkeypatch) -> None:
    sun_of(10.0, monkeypatch)
    part, _, frame = floor_of(half_lid(), VIEW)
    picture = np.full(frame.layers["id"].size, np.nan)
    picture[np.flatnonzero((frame.layers["object"] == 0).ravel())] = part
    soft = picture.reshape(frame.layers["id"].shape)
    soft = np.where((soft > 0.1) & (soft < 0.9), soft, np.nan)
    assert np.isfinite(soft).sum() > 1000
    for axis in (0, 1):
        assert np.nanstd(np.diff(soft, 2, axis=axis)) < 0.009


def test_a_shadow_at_the_foot_of_what_casts_it_stays_sharp(monkeypatch) -> None:
    sun_of(0.27, monkeypatch)
    post = Part(box(0.3, 3.0, 0.3).turned(20, 1), 0)
    scene = scene_of("post", [Part(sheet(60.0, 60.0, 1, 1), 0), post], [GREY])
    view = {"eye": [0.0, 8.0, -0.6], "target": [0.0, 0.0, -0.6], "up": [0, 0, 1]}
    view |= {"width": 96, "height": 96, "fov_y_deg": 10}
    part, _, frame = floor_of(scene, view)
    lit = np.full(frame.layers["id"].size, np.nan)
    lit[np.flatnonzero((frame.layers["object"] == 0).ravel())] = part
    lit = lit.reshape(96, 96)
    partly = (lit > 0.1) & (lit < 0.9)
    rows = np.flatnonzero((lit < 0.05).any(axis=1))
    assert len(rows) > 20
    # Two edges in each row, each over no more than a pixel or two.
    assert partly[rows].sum(axis=1).mean() <= 4


def test_softness_keeps_the_light(monkeypatch) -> None:
    ball = Part(sphere(0.4, 40).moved([0.0, 1.2, 0.0]), 0)
    scene = scene_of("ball", [Part(sheet(60.0, 60.0, 1, 1), 0), ball], [GREY])
    # From straight above, every pixel shows as much of the floor.
    view = {"eye": [0.0, 60.0, -0.9], "target": [0.0, 0.0, -0.9], "up": [0, 0, 1]}
    view |= {"width": 96, "height": 96, "fov_y_deg": 3.5}
    lost = []
    for radius_deg in (0.01, 5.0):
        sun_of(radius_deg, monkeypatch)
        frame = raysvc.render(scene, constant_environment(0.0), view, PLAIN)
        lit = frame.layers["beauty"][..., 0]
        floor = frame.layers["object"] == 0
        lost.append((lit.max() - lit[floor]).sum())
    assert lost[1] == pytest.approx(lost[0], rel=0.02)


def test_only_penumbrae_take_more_rays(monkeypatch) -> None:
    sun_of(0.5, monkeypatch)
    lit = scene_of("floor", [Part(sheet(60.0, 60.0, 1, 1), 0)], [GREY])
    view = VIEW | {"eye": [2.5, 1.5, 0.0]}
    open_ = floor_of(lit, view)[2].statistics
    # One ray for each pixel of the floor, and none for the sky.
    assert open_.rays["shadow"] == (floor_of(lit, view)[2].layers["object"] == 0).sum()
    shaded = floor_of(half_lid(), VIEW)[2].statistics
    assert shaded.rays["shadow"] < 1.5 * VIEW["width"] * VIEW["height"]


def test_without_shadows_nothing_is_dark(monkeypatch) -> None:
    sun_of(2.0, monkeypatch)
    frame = floor_of(half_lid(), VIEW, shadows=False)[2]
    lit = frame.layers["beauty"][..., 0][frame.layers["object"] == 0]
    assert lit.min() > 0.95 * lit.max()
    assert "shadow" not in frame.statistics.rays


def test_points_alone_find_about_the_same_part(monkeypatch) -> None:
    radius = np.radians(6.0)
    scene = half_lid()
    prepared = prepare(scene, constant_environment(0.0), Settings())
    direct = DirectLight(prepared, True, 0, Ledger())
    sun = SunDisc(SunLight(tuple(TOWARDS.tolist()), (1.0, 1.0, 1.0), float(radius)))
    x = np.linspace(-0.3, 0.3, 61)
    surface = points(np.stack([x, np.zeros(61), np.zeros(61)], axis=1), (0, 1, 0))
    part = direct.alone(sun, surface, np.arange(61))
    a = np.clip(x / (LID_HEIGHT / TOWARDS[1] * np.tan(radius)), -1, 1)
    expected = 0.5 + (a * np.sqrt(1 - a**2) + np.arcsin(a)) / np.pi
    assert np.abs(part - expected).max() < 0.15
    assert np.abs(part - expected).mean() < 0.03
    # All take the same rays: no noise from one point to the next, whatever the rounding.
    assert (np.diff(part) >= 0).all()
    assert len(np.unique(part)) <= ALONE + 1


def lamp_scene():
    lamp = Material(base_colour=(0, 0, 0, 1), metallic=0.0, emissive=(30.0, 30.0, 30.0))
    parts = [
        Part(sheet(8.0, 8.0, 1, 1), 0),
        Part(sphere(0.4, 40).moved([0.0, 0.4, 0.0]), 0),
        Part(sheet(0.6, 0.6, 1, 1).turned(180, 2).moved([0.3, 2.5, 0.2]), 1),
    ]
    return scene_of("lamp", parts, [GREY, lamp])


def test_a_lamp_lights_and_shades_as_the_reference_says() -> None:
    view = {"eye": [2.0, 1.6, 3.0], "target": [0, 0.3, 0], "width": 64, "height": 40}
    dark = constant_environment(0.0)
    hybrid = raysvc.render(lamp_scene(), dark, view, {"aa": "none", "bounces": 0})
    truth = raysvc.render(
        lamp_scene(),
        dark,
        view,
        {"mode": "reference", "samples": 64, "max_path_length": 4}
        if "max_path_length" in Settings.model_fields
        else {"mode": "reference", "samples": 64},
    )
    a, b = (f.layers["beauty"][..., :3] for f in (hybrid, truth))
    inside = hybrid.layers["object"] == 0
    blocks = [x[: 40 // 4 * 4].reshape(10, 4, 16, 4, 3).mean(axis=(1, 3)) for x in (a, b)]
    whole = inside.reshape(10, 4, 16, 4).all(axis=(1, 3))
    assert whole.sum() > 40
    ratio = blocks[0][whole].sum() / blocks[1][whole].sum()
    assert ratio == pytest.approx(1.0, abs=0.04)
    error = np.abs(blocks[0] - blocks[1])[whole]
    assert error.mean() < 0.05 * blocks[1][whole].mean()


def test_a_lamp_is_mirrored_once() -> None:
    """Smooth mirrors show it by their rays, rough ones by its highlight: never both."""
    lamp = Material(base_colour=(0, 0, 0, 1), metallic=0.0, emissive=(1.0, 1.0, 1.0))
    view = {"eye": [0, 2.0, 2.0], "target": [0, 0, 0], "width": 48, "height": 48, "fov_y_deg": 50}
    total = {}
    for roughness in (0.0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4):
        floor = Material(base_colour=(1.0, 1.0, 1.0, 1.0), metallic=1.0, roughness=roughness)
        parts = [
            Part(sheet(30.0, 30.0, 1, 1), 0),
            Part(sheet(0.5, 0.5, 1, 1).turned(180, 2).moved([0, 2.0, -2.0]), 1),
        ]
        scene = scene_of("lamp", parts, [floor, lamp])
        settings = {"aa": "none", "bounces": 1, "occlusion_samples": 0}
        frame = raysvc.render(scene, constant_environment(0.0), view, settings)
        on_floor = frame.layers["object"] == 0
        total[roughness] = frame.layers["beauty"][..., 0][on_floor].sum()
    # A wider lobe spreads the lamp's picture; about as much of it reaches the camera.
    values = np.array(list(total.values()))
    assert values.min() > 0.8 * values.max()


def test_lamps_and_suns_are_the_same_with_any_number_of_threads() -> None:
    lamp = dataclasses.replace(still_life().materials[2], emissive=(3.0, 2.0, 1.0))
    scene = still_life()
    scene = dataclasses.replace(scene, materials=(*scene.materials[:2], lamp))
    view = {"eye": [0.5, 2.0, 5.0], "target": [0.0, 0.6, 0.0], "width": 96, "height": 54}
    frames = [raysvc.render(scene, camera=view, settings={"threads": n}) for n in (1, 3)]
    assert frames[0].encode("exr") == frames[1].encode("exr")


def test_a_black_environment_has_no_sun() -> None:
    assert not prepare(half_lid(), Environment(np.zeros((4, 8, 3), "f4")), Settings()).light.suns
