"""The raster shows what rays through the centres of pixels meet, on real scenes."""

import numpy as np
import pytest

import raysvc
from raysvc.accel.base import Rays
from raysvc.builtin import BUILTIN_SCENES
from raysvc.frame.view import View, camera_from
from raysvc.shading.scene_tables import SceneTables
from raysvc.tracing.world import World
from tests.raster.drawing import raster

WIDTH, HEIGHT = 640, 360
LEAST = 0.999


def agreement(scene, view, structure="auto"):
    """Parts of the pixels that show the triangle which a ray meets, and that show any at all."""
    tables = SceneTables.of(scene)
    seen = raster(scene, view, double_sided=tables.double_sided).visible()
    pixel = np.arange(WIDTH * HEIGHT)
    origins, directions = view.rays(pixel)
    asked = Rays(origins, directions, np.full(len(pixel), np.inf, np.float32))
    ray, hits = World(scene, tables, structure).along(asked)
    met = np.full(len(pixel), -1, np.int32)
    # The first of each ray: later assignments would win.
    met[ray[::-1]] = hits.triangle[::-1]
    return float((seen == met).mean()), float((seen >= 0).mean())


@pytest.mark.parametrize("name", ["torus_park", "shiny", "cornell"])
def test_built_in_scenes_agree(name):
    scene = BUILTIN_SCENES[name]()
    view = camera_from(View(gltf_camera="default", width=WIDTH, height=HEIGHT), scene)
    part, filled = agreement(scene, view)
    assert filled > 0.2
    assert part >= LEAST, f"{part:.6f}"


@pytest.mark.assets
def test_the_flight_helmet_agrees(assets):
    scene = raysvc.load(assets / "gltf" / "FlightHelmet" / "FlightHelmet.gltf")
    view = camera_from(View(width=WIDTH, height=HEIGHT), scene)
    part, filled = agreement(scene, view)
    assert filled > 0.1
    assert part >= LEAST, f"{part:.6f}"
