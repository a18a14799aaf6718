"""Draws the pictures of README.md, docs/how_it_works.md and other pages.

Run from the root of the repository: python -m docs.make_pictures
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image

import raysvc
from raysvc.builtin.lat_long import texel_directions
from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import sheet, sphere
from raysvc.imaging.layer_picture import layer_picture
from raysvc.imaging.tone_map import display8
from raysvc.scene import Environment, Material, PunctualLight

IMAGES = Path(__file__).parent / "images"
STRIP = ("albedo", "normal", "depth", "id", "occlusion", "edge")
SUN, SUN_RADIUS_RAD = (-0.6, 0.6, -0.45), np.radians(3.0)
FILTERED = (0.0, 0.15, 0.3, 0.5, 0.75)
ENVIRONMENTS = ("clear_sky", "studio", "gradient")


def hero() -> None:
    """The park, as README shows it."""
    scene = raysvc.load("builtin:torus_park")
    view = {"gltf_camera": "default", "width": 640, "height": 360}
    frame = raysvc.render(scene, camera=view, settings={"aa": "full"})
    _save("torus_park", frame.display()[..., :3])


def layers() -> None:
    """What is known of each pixel, for one frame."""
    scene = raysvc.load("builtin:shiny")
    frame = raysvc.render(scene, camera={"gltf_camera": "default", "width": 320, "height": 180})
    pictures = [layer_picture(name, frame.layers[name]) for name in STRIP]
    rows = [np.hstack(pictures[:3]), np.hstack(pictures[3:])]
    _save("layers", np.vstack(rows))


def environments() -> None:
    """One scene under every built-in environment."""
    scene = raysvc.load("builtin:shiny")
    view = {"gltf_camera": "default", "width": 320, "height": 180, "aperture_radius": 0.05}
    pictures = [
        raysvc.render(
            scene, raysvc.load_environment(f"builtin:{name}"), view, {"aa": "full", "bounces": 3}
        ).display()[..., :3]
        for name in ENVIRONMENTS
    ]
    _save("environments", np.hstack(pictures))


def reference() -> None:
    """The same frame in both modes, hybrid on the left."""
    scene = raysvc.load("builtin:shiny")
    studio = raysvc.load_environment("builtin:studio")
    view = {"gltf_camera": "default", "width": 400, "height": 225, "aperture_radius": 0.04}
    modes = {"aa": "full", "bounces": 3}, {"mode": "reference", "samples": 256}
    frames = [raysvc.render(scene, studio, view, settings) for settings in modes]
    _save("reference", np.hstack([frame.display()[..., :3] for frame in frames]))


def shadows() -> None:
    """A light without size, a sun of 3 degrees, occlusion and bent normals."""
    shiny = raysvc.load("builtin:shiny")
    matt = (replace(material, metallic=0.0, roughness=1.0) for material in shiny.materials)
    scene = replace(shiny, materials=tuple(matt))
    towards = np.array(SUN) / np.linalg.norm(SUN)
    lamp = PunctualLight(
        "directional", (3.0, 3.0, 3.0), direction=tuple(float(-x) for x in towards)
    )
    sky = np.full((512, 1024, 3), 0.3, np.float32)
    disc = sky.copy()
    inside = texel_directions(512, 1024) @ towards > np.cos(SUN_RADIUS_RAD)
    disc[inside] += np.float32(3.0 / (np.pi * np.sin(SUN_RADIUS_RAD) ** 2))
    view = {"eye": [1.2, 3.2, 6.2], "target": [0.2, 0.2, 0.6], "fov_y_deg": 36.0}
    view |= {"width": 320, "height": 180}
    settings = {"aa": "full", "aa_samples": 16}
    hard = raysvc.render(replace(scene, lights=(lamp,)), Environment(sky), view, settings)
    soft = raysvc.render(scene, Environment(disc), view, settings)
    pictures = [frame.display()[..., :3] for frame in (hard, soft)]
    layers = [layer_picture(name, soft.layers[name]) for name in ("occlusion", "bent_normal")]
    _save("shadows", np.vstack([np.hstack(pictures), np.hstack(layers)]))


def cornell() -> None:
    """A box lit by a lamp in both modes, hybrid on the left."""
    scene = raysvc.load("builtin:cornell")
    view = {"gltf_camera": "default", "width": 240, "height": 240}
    modes = {"aa": "full"}, {"mode": "reference", "samples": 256}
    frames = [raysvc.render(scene, None, view, settings) for settings in modes]
    _save("cornell", np.hstack([frame.display()[..., :3] for frame in frames]))


def glass() -> None:
    """Glass and varnish."""
    scene = raysvc.load("builtin:glass")
    view = {"gltf_camera": "default", "width": 480, "height": 270}
    frame = raysvc.render(scene, camera=view, settings={"bounces": 3, "aa": "full"})
    _save("glass", frame.display()[..., :3])


def brushed() -> None:
    """Brushed balls on a brushed floor in both modes, hybrid on the left."""
    gold = Material(base_colour=(0.95, 0.8, 0.5, 1.0))
    looks = [replace(gold, roughness=r, anisotropy=a) for r in (0.15, 0.35) for a in (0.4, 0.9)]
    floor = Material(base_colour=(0.2, 0.2, 0.2, 1.0), roughness=0.3, anisotropy=0.8)
    balls = [Part(sphere(0.7, 64).moved([1.6 * k - 2.4, 0.0, 0.0]), k) for k in range(4)]
    scene = scene_of(
        "brushed", [*balls, Part(sheet(12.0, 12.0, 1, 1).moved([0, -0.7, 0]), 4)], [*looks, floor]
    )
    studio = raysvc.load_environment("builtin:studio")
    view = {"eye": [0.0, 1.2, 7.0], "target": [0.0, -0.1, 0.0], "fov_y_deg": 22.0}
    view |= {"width": 400, "height": 150}
    modes = {"aa": "full"}, {"mode": "reference", "samples": 512}
    frames = [raysvc.render(scene, studio, view, settings) for settings in modes]
    _save("brushed", np.hstack([frame.display()[..., :3] for frame in frames]))


def filtered() -> None:
    """Two environments, filtered for a row of roughnesses, and their irradiance over pi."""
    rows = []
    for name in ("clear_sky", "studio"):
        environment = raysvc.load_environment(f"builtin:{name}")
        maps = [raysvc.filtered_map(environment, r, 256, 128) for r in FILTERED]
        maps.append(raysvc.irradiance_map(environment, 256, 128) / np.float32(np.pi))
        shown = [display8(picture, "pbr_neutral") for picture in maps]
        rows += [np.hstack(shown[:3]), np.hstack(shown[3:])]
    _save("filtered", np.vstack(rows))


def _save(name: str, picture: np.ndarray) -> None:
    Image.fromarray(picture).save(IMAGES / f"{name}.png", optimize=True)


if __name__ == "__main__":
    hero()
    layers()
    environments()
    reference()
    shadows()
    cornell()
    glass()
    brushed()
    filtered()
