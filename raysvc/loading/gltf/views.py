"""Cameras and lights where their nodes stand (specification, 3.10; KHR_lights_punctual)."""

import math

import numpy as np
import pygltflib

from raysvc.errors import InvalidScene
from raysvc.loading.gltf.directions import unit
from raysvc.loading.gltf.document import Document, item
from raysvc.loading.gltf.extensions import Light, LightOfNode, Lights, Spot, extension
from raysvc.loading.gltf.journal import Journal
from raysvc.loading.gltf.nodes import Hierarchy
from raysvc.scene import PunctualLight, SceneCamera
from raysvc.scene.rest_shape import LARGEST_COORDINATE
from raysvc.types import Doubles

_EXTENSION = "KHR_lights_punctual"
_BRIGHTEST = 1e12


def read_cameras(document: Document, hierarchy: Hierarchy) -> tuple[SceneCamera, ...]:
    """Return a camera for every visit of a node that has one, by index of the camera."""
    gltf = document.gltf
    found: list[tuple[int, SceneCamera]] = []
    for visit, number in enumerate(hierarchy.nodes.tolist()):
        node = gltf.nodes[number]
        if node.camera is None:
            continue
        path = f"nodes[{number}]"
        camera = item(gltf.cameras, node.camera, "cameras", f"{path}.camera")
        world = rigid(hierarchy.world[visit], path, document.journal)
        name = camera.name or node.name or ""
        found.append((node.camera, _camera(camera, f"cameras[{node.camera}]", world, name)))
    shown = {index for index, _ in found}
    for index in range(len(gltf.cameras)):
        if index not in shown:
            document.journal.note("no node of the scene has this camera", f"cameras[{index}]")
    return tuple(camera for _, camera in sorted(found, key=lambda pair: pair[0]))


def _camera(camera: pygltflib.Camera, path: str, world: Doubles, name: str) -> SceneCamera:
    if camera.type == "perspective" and camera.perspective is not None:
        lens = camera.perspective
        if not 0 < lens.yfov < math.pi:
            raise InvalidScene("is not within 0..pi", f"{path}.perspective.yfov")
        if lens.aspectRatio is not None and lens.aspectRatio <= 0:
            raise InvalidScene("is not positive", f"{path}.perspective.aspectRatio")
        return SceneCamera(
            world, fov_y_deg=math.degrees(lens.yfov), aspect_ratio=lens.aspectRatio, name=name
        )
    if camera.type == "orthographic" and camera.orthographic is not None:
        width, height = abs(camera.orthographic.xmag), abs(camera.orthographic.ymag)
        if not (width > 0 and height > 0 and math.isfinite(width / height)):
            raise InvalidScene("xmag and ymag must not be 0", f"{path}.orthographic")
        return SceneCamera(world, height_m=2 * height, aspect_ratio=width / height, name=name)
    raise InvalidScene("is neither perspective nor orthographic, or lacks it", f"{path}.type")


def rigid(world: Doubles, path: str, journal: Journal) -> Doubles:
    """Return (4, 4) the transform without scale, shear and mirroring: Z is kept, Y nearly."""
    if np.abs(world[:3, 3]).max() > LARGEST_COORDINATE:
        raise InvalidScene(f"stands beyond {LARGEST_COORDINATE:g}", path)
    axes, good = unit(world[:3, :3].T)
    backward = axes[2]
    right, right_good = unit(np.cross(axes[1], backward)[None])
    if not (good[1] and good[2] and right_good[0]):
        journal.note("has no direction: its camera or light looks along -Z", path)
        turned = np.eye(3)
    else:
        turned = np.stack([right[0], np.cross(backward, right[0]), backward], axis=1)
    result = np.eye(4)
    result[:3, :3], result[:3, 3] = turned, world[:3, 3]
    return result


def read_lights(document: Document, hierarchy: Hierarchy) -> tuple[PunctualLight, ...]:
    """Return a light for every visit of a node that has one, in the order of visits."""
    gltf = document.gltf
    declared = extension(Lights, _EXTENSION, gltf, "")
    lights = declared.lights if declared is not None else []
    made = []
    for visit, number in enumerate(hierarchy.nodes.tolist()):
        node = gltf.nodes[number]
        if _EXTENSION not in (node.extensions or {}):
            continue
        path = f"nodes[{number}]"
        index = extension(LightOfNode, _EXTENSION, node, path)
        if index is None:
            continue
        light = item(lights, index.light, f"extensions.{_EXTENSION}.lights", path)
        world = rigid(hierarchy.world[visit], path, document.journal)
        made.append(
            _light(light, f"extensions.{_EXTENSION}.lights[{index.light}]", world, node.name or "")
        )
    return tuple(made)


def _light(light: Light, path: str, world: Doubles, node_name: str) -> PunctualLight:
    kind = light.type
    if light.intensity < 0 or min(light.color) < 0:
        raise InvalidScene("is negative", f"{path}.intensity")
    if light.range is not None and light.range <= 0:
        raise InvalidScene("is not positive", f"{path}.range")
    spot = light.spot or Spot()
    if not 0 <= spot.innerConeAngle < spot.outerConeAngle <= math.pi / 2 + 1e-6:
        raise InvalidScene("needs 0 <= inner < outer <= pi / 2", f"{path}.spot")
    red, green, blue = (channel * light.intensity for channel in light.color)
    if max(red, green, blue) > _BRIGHTEST:
        raise InvalidScene("is too large", f"{path}.intensity")
    x, y, z = world[:3, 3].tolist()
    dx, dy, dz = (-world[:3, 2]).tolist()
    return PunctualLight(
        kind,
        intensity=(red, green, blue),
        position=(x, y, z),
        direction=(dx, dy, dz),
        range_m=math.inf if light.range is None else light.range,
        inner_cone_rad=spot.innerConeAngle,
        outer_cone_rad=spot.outerConeAngle,
        name=light.name or node_name,
    )
