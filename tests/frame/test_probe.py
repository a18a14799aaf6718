"""Environments that are captured from a point of the scene."""

from dataclasses import replace

import numpy as np
import pytest

import raysvc
from raysvc.builtin import BUILTIN_ENVIRONMENTS
from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import sheet, sphere
from raysvc.errors import Cancelled, InvalidSetting
from raysvc.frame.probe_capture import before
from raysvc.lighting.cube_map import face_cameras
from raysvc.parallel import Control
from raysvc.scene import Environment, Material, PunctualLight, Scene
from tests.frame.subjects import GREY, MIRROR, ball, constant_environment, still_life

SKY = BUILTIN_ENVIRONMENTS["clear_sky"]()
MIDDLE = {"probe_at": [0, 0, 0], "size": 32}
VIEW = {"eye": [0.5, 1.0, 4.0], "target": [0, 0, 0], "width": 48, "height": 32}
PLAIN = {"aa": "none"}
WALLS = {
    "+x": (0.8, 0.1, 0.1),
    "-x": (0.1, 0.7, 0.1),
    "+y": (0.1, 0.1, 0.8),
    "-y": (0.8, 0.7, 0.1),
    "+z": (0.7, 0.1, 0.7),
    "-z": (0.1, 0.7, 0.7),
}


def around(environment: Environment, **probe: object) -> dict:
    return {**MIDDLE, "environment": environment, **probe}


def room(thing: Material = MIRROR, radius: float = 0.5) -> Scene:
    """A ball in the middle of six walls of WALLS, 4 metres apart, under a small lamp."""
    wall = sheet(4.0, 4.0, 2, 2)
    turns = ((90, 2), (-90, 2), (180, 2), (0, 2), (-90, 0), (90, 0))
    places = 2.0 * np.array([(s, 0, 0) for s in (1, -1)] + [(0, s, 0) for s in (1, -1)])
    places = np.concatenate([places, 2.0 * np.array([(0, 0, s) for s in (1, -1)])])
    parts = [
        Part(wall.turned(degrees, axis).moved(place), number)
        for number, ((degrees, axis), place) in enumerate(zip(turns, places, strict=True))
    ]
    parts.append(Part(sphere(radius, 32), len(WALLS)))
    materials = [
        Material(name, (*colour, 1.0), metallic=0.0, roughness=1.0)
        for name, colour in WALLS.items()
    ]
    lamp = PunctualLight("point", (4.0, 4.0, 4.0), position=(0.8, 1.5, 1.2))
    return scene_of("room", parts, [*materials, replace(thing, name="thing")], lights=[lamp])


DARK = constant_environment(0.0)


def shown(frame: raysvc.Frame, layer: str = "beauty") -> np.ndarray:
    """Colours (K, 3) of the pixels that show the scene."""
    return frame.layers[layer][..., :3][frame.layers["id"] >= 0]


def both(scene: Scene, environment: Environment, view: dict, **probe: object) -> tuple:
    """Frames with rays and with a probe."""
    return (
        raysvc.render(scene, environment, view, PLAIN),
        raysvc.render(scene, around(environment, **probe), view, PLAIN),
    )


@pytest.mark.parametrize(
    ("environment", "settings", "field"),
    [
        ({}, {}, "environment.probe_at"),
        ({"probe_at": [0, 0]}, {}, "environment.probe_at"),
        ({"probe_at": [0, 0, float("nan")]}, {}, "environment.probe_at"),
        ({"probe_at": [0, 0, 2e9]}, {}, "environment.probe_at"),
        ({**MIDDLE, "size": 15}, {}, "environment.size"),
        ({**MIDDLE, "size": 513}, {}, "environment.size"),
        ({**MIDDLE, "sise": 64}, {}, "environment.sise"),
        ({**MIDDLE, "without": ["chair"]}, {}, "environment.without"),
        ({**MIDDLE, "without": [1]}, {}, "environment.without"),
        ({**MIDDLE, "without": "ball"}, {}, "environment.without"),
        ({**MIDDLE, "environment": "builtin:atlantis"}, {}, "environment.environment"),
        ({**MIDDLE, "environment": "sky.hdr"}, {}, "environment.environment"),
        ({**MIDDLE, "environment": 3}, {}, "environment.environment"),
        (3, {}, "environment"),
        (MIDDLE, {"mode": "reference"}, "environment"),
        (MIDDLE, {"bounces": 2}, "settings.bounces"),
    ],
)
def test_what_is_wrong_with_a_probe_is_named(
    environment: object, settings: dict, field: str
) -> None:
    with pytest.raises(InvalidSetting) as caught:
        raysvc.render(ball(GREY, 8), environment, VIEW, settings)  # type: ignore[arg-type]
    assert caught.value.field == field


@pytest.mark.parametrize("roughness", [0.0, 0.1, 0.3, 0.55, 1.0])
def test_where_nothing_is_around_a_probe_changes_nothing(roughness: float) -> None:
    scene = ball(Material(metallic=1.0, roughness=roughness))
    rays, probe = both(scene, SKY, VIEW, size=128)
    assert shown(probe).mean() == pytest.approx(shown(rays).mean(), rel=3e-4)
    np.testing.assert_allclose(
        probe.display().astype(int), rays.display().astype(int), rtol=0, atol=3
    )


@pytest.mark.parametrize("roughness", [0.0, 0.05])
def test_varnish_shows_a_probe_as_it_shows_the_environment(roughness: float) -> None:
    varnished = Material(metallic=0.0, roughness=0.8, clearcoat=1.0, clearcoat_roughness=roughness)
    scene = ball(varnished)
    # Near enough for the sun to be seen in it
    view = {"eye": [-2.0, 2.9, 2.0], "target": [0, 0, 0], "width": 64, "height": 64}
    view |= {"fov_y_deg": 10.0}
    rays, probe = both(scene, SKY, view, size=128)
    one, other = (frame.layers["beauty"][..., :3] for frame in (rays, probe))
    assert one.max() > 20.0
    np.testing.assert_allclose(other, one, rtol=0.02, atol=0.02)


def test_varnish_shows_the_wall_that_it_faces() -> None:
    varnished = Material(metallic=0.0, roughness=0.8, clearcoat=1.0, clearcoat_roughness=0.05)
    scene = ball(varnished)
    coated = room(scene.materials[0])
    matt = room(replace(scene.materials[0], clearcoat=0.0))
    view = {"eye": [0, 0, 1.5], "target": [0, 0, 0], "width": 24, "height": 24}
    _, probe = both(coated, DARK, view)
    _, bare = both(matt, DARK, view)
    coat = probe.layers["beauty"][12, 12, :3] - 0.96 * bare.layers["beauty"][12, 12, :3]
    # The wall behind the camera
    assert coat[0] > 3 * coat[1] > 0


@pytest.mark.parametrize("roughness", [0.0, 0.1, 0.3])
def test_the_sun_s_highlight_on_a_floor_is_counted_once(roughness: float) -> None:
    floor = Material(metallic=1.0, roughness=roughness)
    scene = scene_of("floor", [Part(sheet(8.0, 8.0, 2, 2), 0)], [floor])
    # Into the reflection of the sun
    view = {"eye": [2.0, 2.9, -2.0], "target": [0, 0, 0], "width": 96, "height": 64}
    rays, probe = both(scene, SKY, view, probe_at=[0, 1, 0], size=128)
    assert rays.layers["beauty"].max() > 20.0
    assert shown(probe).mean() == pytest.approx(shown(rays).mean(), rel=1e-3)
    assert probe.layers["beauty"].max() == pytest.approx(rays.layers["beauty"].max(), rel=0.01)


def test_the_sun_behind_glass_is_counted_once() -> None:
    towards = np.array([-0.5, np.sqrt(0.5), 0.5])
    pane = sheet(3.0, 3.0, 1, 1).upright_along(towards).moved(3.0 * towards)
    clear = Material("pane", roughness=0.0, metallic=0.0, transmission=1.0, double_sided=True)
    metal = Material("metal", metallic=1.0, roughness=0.1)
    scene = scene_of("behind glass", [Part(sphere(1.0, 48), 0), Part(pane, 1)], [metal, clear])
    view = {"eye": [-2.0, 2.9, 2.0], "target": [0, 0, 0], "width": 64, "height": 64}
    view |= {"fov_y_deg": 10.0}
    rays, probe = both(scene, SKY, view, size=128)
    one, other = (frame.layers["beauty"][..., :3] for frame in (rays, probe))
    assert one.max() > 20.0
    assert other.max() == pytest.approx(one.max(), rel=0.02)
    assert other.mean() == pytest.approx(one.mean(), rel=0.02)


def test_what_hides_the_sun_hides_it_from_mirrors() -> None:
    roof = sheet(1.0, 1.0, 1, 1).moved([-1.0, 1.42, 1.0])
    parts = [Part(sheet(8.0, 8.0, 2, 2), 0), Part(roof, 1)]
    scene = scene_of("roofed", parts, [MIRROR, replace(GREY, double_sided=True)])
    view = {"eye": [2.0, 2.9, -2.0], "target": [0, 0, 0], "width": 96, "height": 64}
    frame = raysvc.render(scene, around(SKY, probe_at=[0, 0.5, 0]), view, PLAIN)
    assert frame.layers["beauty"].max() < 10.0


@pytest.mark.parametrize("roughness", [0.0, 0.1, 0.15, 0.3])
def test_a_lamp_is_counted_once(roughness: float) -> None:
    lamp = sheet(8.0, 8.0, 1, 1).turned(180, 2).moved([8, 40, 20])
    floor = sheet(400.0, 400.0, 10, 10).moved([0, -80.0, 0])
    glow = Material("lamp", emissive=(30.0, 30.0, 30.0), double_sided=True)
    parts = [Part(sphere(1.0, 48), 0), Part(lamp, 1), Part(floor, 2)]
    ball_ = Material("ball", metallic=1.0, roughness=roughness)
    scene = scene_of("lamp", parts, [ball_, glow, GREY])
    view = {"eye": [0, 0, 5], "target": [0, 0, 0], "width": 120, "height": 120, "fov_y_deg": 25}
    dark = constant_environment(0.02)
    one, other = (
        shown(raysvc.render(scene, environment, view, {"aa": "full"})).mean()
        for environment in (dark, around(dark, size=128))
    )
    # From the ball's front the lamp is a little nearer than from the probe
    assert 0.93 * one < other < 1.01 * one


@pytest.mark.parametrize("axis", range(6))
def test_a_mirror_ball_shows_every_wall_where_it_is(axis: int) -> None:
    towards = np.eye(3)[axis // 2] * (1 if axis % 2 == 0 else -1)
    view = {"eye": list(1.5 * towards), "target": [0, 0, 0], "width": 9, "height": 9}
    frame = raysvc.render(room(), around(DARK), view, PLAIN)
    middle = frame.layers["beauty"][4, 4, :3]
    likeness = {
        name: middle @ colour / np.linalg.norm(middle) / np.linalg.norm(colour)
        for name, colour in WALLS.items()
    }
    # The ball's middle mirrors what is behind the camera
    assert max(likeness, key=likeness.__getitem__) == list(WALLS)[axis]


def test_a_probe_shows_about_what_rays_do() -> None:
    view = {"eye": [0.3, 0.4, 1.6], "target": [0, 0, 0], "width": 96, "height": 96}
    rays, probe = both(room(radius=0.1), DARK, view | {"fov_y_deg": 8}, size=128)
    on = rays.layers["object"] == 6
    differs = np.abs(rays.display().astype(int) - probe.display())[..., :3][on]
    # Walls are far from so small a ball: hardly anything moves. Rays show walls with more noise.
    assert np.median(differs) <= 8
    assert differs.mean() < 13


def test_no_ray_is_reflected_and_the_thing_itself_is_left_out() -> None:
    scene = room()
    frame = raysvc.render(scene, around(DARK), VIEW, PLAIN)
    statistics = frame.statistics
    assert "reflection" not in statistics.rays
    assert statistics.probe is not None
    assert statistics.probe.left_out == np.count_nonzero(scene.object_of_triangle == 6)
    assert statistics.to_dict()["probe"]["size"] == 32


def test_without_says_what_the_probe_does_not_see() -> None:
    scene = room()
    view = {"eye": [1.5, 0, 0], "target": [0, 0, 0], "width": 9, "height": 9}

    def middle(*without: object) -> np.ndarray:
        environment = around(constant_environment(5.0), without=list(without))
        return raysvc.render(scene, environment, view, PLAIN).layers["beauty"][4, 4, :3]

    assert middle("thing", "+x") == pytest.approx([5.0] * 3, rel=0.01)
    assert middle("thing", 0) == pytest.approx([5.0] * 3, rel=0.01)
    assert middle("thing")[0] < 4.0
    # From inside a ball that is not left out there is only the ball's back, which is not drawn
    assert middle("+x") == pytest.approx([5.0] * 3, rel=0.01)


def test_diffuse_light_and_shadows_are_those_of_the_base() -> None:
    rays, probe = both(room(GREY), SKY, VIEW)
    walls = rays.layers["object"] < 6
    np.testing.assert_array_equal(rays.layers["beauty"][walls], probe.layers["beauty"][walls])
    np.testing.assert_array_equal(rays.layers["occlusion"], probe.layers["occlusion"])


def test_a_probe_is_kept_until_something_that_it_sees_changes() -> None:
    scene, environment = room(), around(DARK)

    def rendered(scene: Scene = scene, **settings: object) -> raysvc.Frame:
        return raysvc.render(scene, environment, VIEW, {**PLAIN, **settings})

    first, second = rendered(), rendered()
    costs = first.statistics.probe, second.statistics.probe
    assert costs[0] is not None and costs[1] is not None
    assert (costs[0].rebuilt, costs[1].rebuilt) == (True, False)
    assert costs[0].capture_seconds > 0.0 and costs[0].tables_seconds > 0.0
    assert (costs[1].capture_seconds, costs[1].tables_seconds) == (0.0, 0.0)
    np.testing.assert_array_equal(first.layers["beauty"], second.layers["beauty"])

    def is_rebuilt(frame: raysvc.Frame) -> bool:
        assert frame.statistics.probe is not None
        return frame.statistics.probe.rebuilt

    assert not is_rebuilt(rendered(exposure_stops=1.0, aa="edges"))
    assert is_rebuilt(rendered(shadows=False))
    assert is_rebuilt(rendered(environment_strength=2.0))
    assert is_rebuilt(rendered(ibl_order=1))
    assert is_rebuilt(rendered(multiple_scattering=True))
    moved = scene.positions.copy()
    wall = np.unique(scene.triangles[scene.material_of_triangle == 0])
    moved[wall, 0] = 3.0
    other = rendered(scene.deformed(moved))
    assert is_rebuilt(other)
    assert not np.array_equal(other.layers["beauty"], first.layers["beauty"])
    environment = around(DARK, size=48)
    assert is_rebuilt(rendered())


@pytest.mark.parametrize("changed", [{"ibl": "split_sum"}, {"ibl_order": 1}])
def test_what_is_captured_is_filtered_as_the_frame_asks(changed: dict) -> None:
    scene = room(Material(metallic=1.0, roughness=0.12))
    plain, other = (
        raysvc.render(scene, around(DARK), VIEW, {**PLAIN, **settings})
        for settings in ({}, changed)
    )
    thing = plain.layers["object"] == 6
    assert not np.array_equal(plain.layers["beauty"][thing], other.layers["beauty"][thing])
    np.testing.assert_array_equal(plain.layers["beauty"][~thing], other.layers["beauty"][~thing])


def test_faces_lose_nothing_that_their_cameras_see() -> None:
    scene = room()
    at = np.array([0.3, -0.2, 0.9])
    often = np.zeros(len(scene.triangles))
    for camera in face_cameras(at, 8):
        may_be = before(camera, scene)
        # A point of a triangle is seen where its corners' mean is; sample all of it
        weights = np.random.default_rng(0).dirichlet(np.ones(3), 60)
        points = np.einsum("sk,fkc->fsc", weights, scene.positions[scene.triangles]) - at
        right, up = camera.world_from_camera[:3, 0], camera.world_from_camera[:3, 1]
        depth = points @ camera.forward
        inside = np.abs(points @ right) <= camera.half_height * depth
        inside &= np.abs(points @ up) <= camera.half_height * depth
        assert may_be[inside.any(axis=1)].all()
        often += may_be
    assert often.min() >= 1
    assert often.mean() < 2.0


def test_bytes_do_not_depend_on_threads() -> None:
    frames = [
        raysvc.render(still_life(), {"probe_at": [-0.9, 0.8, 0.0]}, VIEW, {"threads": threads})
        for threads in (1, 3)
    ]
    assert all(frame.statistics.probe.rebuilt for frame in frames)  # type: ignore[union-attr]
    np.testing.assert_array_equal(frames[0].layers["beauty"], frames[1].layers["beauty"])


def test_a_capture_can_be_cancelled() -> None:
    control = Control(on_progress=lambda stage, _: control.cancel() if stage == "probe" else None)
    with pytest.raises(Cancelled):
        raysvc.render(room(), around(DARK), VIEW, control=control)


def test_glass_and_holes_around_are_captured() -> None:
    pane = sheet(3.0, 3.0, 1, 1).turned(-90, 0).moved([0, 0, 1.0])
    clear = Material("pane", roughness=0.0, metallic=0.0, transmission=1.0, double_sided=True)
    wall = sheet(4.0, 4.0, 1, 1).turned(-90, 0).moved([0, 0, 2.0])
    red = Material("wall", (0.0, 0.0, 0.0, 1.0), emissive=(1.0, 0.0, 0.0), unlit=False)
    veil = Material("veil", (0.0, 0.0, 0.0, 0.5), metallic=0.0, roughness=1.0, alpha_mode="blend")
    view = {"eye": [0, 0, 0.9], "target": [0, 0, 0], "width": 9, "height": 9}
    middle = []
    for between in (clear, replace(veil, double_sided=True)):
        parts = [Part(sphere(0.5, 16), 0), Part(pane, 1), Part(wall, 2)]
        scene = scene_of("behind", parts, [MIRROR, between, red])
        frame = raysvc.render(scene, around(constant_environment(0.1)), view, PLAIN)
        middle.append(frame.layers["beauty"][4, 4, 0])
    assert middle[0] == pytest.approx(1.0, abs=0.2)
    assert middle[1] == pytest.approx(0.5, abs=0.1)
