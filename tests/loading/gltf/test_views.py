"""Cameras and punctual lights."""

import math

import numpy as np
import pytest

from raysvc.errors import InvalidScene
from tests.loading.gltf.building import Builder

ROOT = 0.5**0.5


def looking(camera, **node):
    return Builder(nodes=[{"camera": 0, **node}], cameras=[camera])


PERSPECTIVE = {"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.01}}
ORTHOGRAPHIC = {
    "type": "orthographic",
    "orthographic": {"xmag": 3, "ymag": 2, "znear": 0, "zfar": 9},
}


def test_a_perspective_camera_keeps_its_vertical_field_of_view():
    (camera,) = looking(PERSPECTIVE, name="node").load().cameras
    assert camera.fov_y_deg == pytest.approx(math.degrees(0.8))
    assert (camera.height_m, camera.aspect_ratio, camera.name) == (None, None, "node")
    wide = {
        "type": "perspective",
        "name": "own",
        "perspective": PERSPECTIVE["perspective"] | {"aspectRatio": 1.5},
    }
    (camera,) = looking(wide, name="node").load().cameras
    assert (camera.aspect_ratio, camera.name) == (1.5, "own")


def test_an_orthographic_camera_sees_twice_its_magnification():
    (camera,) = looking(ORTHOGRAPHIC).load().cameras
    assert (camera.fov_y_deg, camera.height_m, camera.aspect_ratio) == (None, 4, 1.5)


def test_a_camera_stands_where_its_node_does_without_the_scale():
    nodes = [
        {"translation": [0, 0, 5], "scale": [2, 3, 4], "children": [1]},
        {"camera": 0, "translation": [1, 0, 0], "rotation": [0, ROOT, 0, ROOT]},
    ]
    (camera,) = Builder(nodes=nodes, cameras=[PERSPECTIVE]).load().cameras
    world = camera.world_from_camera
    assert np.allclose(world[:3, 3], [2, 0, 5])
    assert np.allclose(world[:3, :3] @ world[:3, :3].T, np.eye(3))
    assert np.linalg.det(world[:3, :3]) == pytest.approx(1)
    assert np.allclose(-world[:3, 2], [-1, 0, 0])
    assert np.allclose(world[:3, 1], [0, 1, 0])


def test_cameras_come_in_the_documents_order():
    named = [PERSPECTIVE | {"name": name} for name in "abc"]
    nodes = [{"camera": 2}, {"camera": 0}]
    scene = Builder(nodes=nodes, cameras=named).load()
    assert [camera.name for camera in scene.cameras] == ["a", "c"]
    assert any("cameras[1]" in warning for warning in scene.warnings)


def test_a_camera_without_direction_is_repaired_and_named():
    scene = looking(PERSPECTIVE, scale=[0, 0, 0], translation=[1, 2, 3]).load()
    world = scene.cameras[0].world_from_camera
    assert np.array_equal(world[:3], np.eye(4)[:3] + np.array([[0, 0, 0, x] for x in (1, 2, 3)]))
    assert any("no direction" in warning for warning in scene.warnings)


CAMERA_FAULTS = {
    "fov 0": ({"yfov": 0}, "cameras[0].perspective.yfov"),
    "fov pi": ({"yfov": 3.2}, "cameras[0].perspective.yfov"),
    "fov missing": ({"yfov": None}, "cameras[0].perspective.yfov"),
    "aspect": ({"aspectRatio": -1}, "cameras[0].perspective.aspectRatio"),
}


@pytest.mark.parametrize("name", CAMERA_FAULTS)
def test_a_faulty_camera_is_refused_by_name(name):
    change, field = CAMERA_FAULTS[name]
    camera = PERSPECTIVE | {"perspective": PERSPECTIVE["perspective"] | change}
    with pytest.raises(InvalidScene) as raised:
        looking(camera).load()
    assert raised.value.field == field


@pytest.mark.parametrize(
    "camera",
    [
        {"type": "fisheye"},
        {"type": "perspective"},
        ORTHOGRAPHIC | {"orthographic": {"xmag": 0, "ymag": 1, "znear": 0, "zfar": 1}},
    ],
)
def test_a_camera_of_no_known_kind_is_refused(camera):
    with pytest.raises(InvalidScene, match=r"cameras\[0\]"):
        looking(camera).load()


def lit(light, **node):
    return Builder(
        extensions={"KHR_lights_punctual": {"lights": [light]}},
        nodes=[{**node, "extensions": {"KHR_lights_punctual": {"light": 0}}}],
    )


def test_lights_stand_and_point_where_their_nodes_do():
    spot = {
        "type": "spot",
        "color": [1, 0.5, 0],
        "intensity": 10,
        "range": 7,
        "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.2},
    }
    (light,) = (
        lit(spot, name="lamp", translation=[1, 2, 3], rotation=[-ROOT, 0, 0, ROOT], scale=[5, 5, 5])
        .load()
        .lights
    )
    assert (light.kind, light.intensity, light.range_m, light.name) == (
        "spot",
        (10, 5, 0),
        7,
        "lamp",
    )
    assert light.position == (1, 2, 3)
    assert light.direction == pytest.approx((0, -1, 0))
    assert (light.inner_cone_rad, light.outer_cone_rad) == (0.1, 0.2)


def test_lights_have_the_extensions_defaults():
    (light,) = lit({"type": "point"}).load().lights
    assert (light.kind, light.intensity, light.range_m) == ("point", (1, 1, 1), math.inf)
    (light,) = lit({"type": "directional", "intensity": 3}).load().lights
    assert (light.direction, light.intensity) == ((0, 0, -1), (3, 3, 3))


LIGHT_FAULTS = [
    ({"type": "area"}, "type"),
    ({}, "type"),
    ({"type": "point", "intensity": -1}, "intensity"),
    ({"type": "point", "intensity": 1e300}, "intensity"),
    ({"type": "point", "color": [1, 1]}, "color"),
    ({"type": "point", "range": 0}, "range"),
    ({"type": "spot", "spot": {"innerConeAngle": 0.3, "outerConeAngle": 0.2}}, "spot"),
    ({"type": "spot", "spot": {"outerConeAngle": 2}}, "spot"),
]


@pytest.mark.parametrize(("light", "field"), LIGHT_FAULTS)
def test_a_faulty_light_is_refused_by_name(light, field):
    with pytest.raises(InvalidScene) as raised:
        lit(light).load()
    assert raised.value.field == f"extensions.KHR_lights_punctual.lights[0].{field}"


def test_a_node_may_only_use_a_light_that_is_there():
    builder = lit({"type": "point"})
    builder.tree["extensions"] = {}
    with pytest.raises(InvalidScene, match=r"nodes\[0\]"):
        builder.load()


def test_cameras_and_lights_may_not_stand_beyond_all_bounds():
    for builder in (
        looking(PERSPECTIVE, translation=[1e30, 0, 0]),
        lit({"type": "point"}, translation=[0, 1e30, 0]),
    ):
        with pytest.raises(InvalidScene, match=r"nodes\[0\]"):
            builder.load()
