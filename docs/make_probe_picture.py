"""Draws docs/images/dynamic_environments.png: reflections by rays on the left, out of a probe on
the right.

Run from the root of the repository: python -m docs.make_probe_picture
"""

from pathlib import Path

import numpy as np
from PIL import Image

import raysvc
from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import box, sheet, sphere
from raysvc.scene import Material, Scene

IMAGES = Path(__file__).parent / "images"
SIZE = {"width": 256, "height": 144}
COLOURS = {"red": (0.75, 0.08, 0.06), "green": (0.1, 0.5, 0.12), "grey": (0.36, 0.35, 0.33)}
BALL = (0.0, 0.85, 0.2)
"""Middle of the ball in the yard."""


def main() -> None:
    """Render both scenes both ways, and lay them out."""
    yard_view = {"eye": [0.5, 1.3, 4.6], "target": [0.0, 0.8, 0.0], "fov_y_deg": 40.0}
    subjects = (
        (yard(), yard_view, {"probe_at": list(BALL)}),
        (raysvc.load("builtin:shiny"), {"gltf_camera": 0}, {"probe_at": [1.6, 0.95, -0.9]}),
    )
    rows = []
    for scene, view, probe in subjects:
        frames = [
            raysvc.render(scene, around, {**view, **SIZE}, {"aa": "full"})
            for around in (None, {**probe, "size": 256})
        ]
        rows.append(np.hstack([frame.display()[..., :3] for frame in frames]))
    Image.fromarray(np.vstack(rows)).save(IMAGES / "dynamic_environments.png", optimize=True)


def yard() -> Scene:
    """A ball of glossy metal between coloured walls, under the sky."""
    wall = sheet(4.0, 2.0, 4, 2).turned(90, 0)
    parts = [
        Part(sheet(20.0, 20.0, 8, 8), 2),
        Part(wall.turned(90, 1).moved([-2.2, 1.0, 0.2]), 0),
        Part(wall.turned(-90, 1).moved([2.2, 1.0, 0.2]), 1),
        Part(wall.moved([0.0, 1.0, -1.8]), 2),
        Part(box(0.5, 0.5, 0.5).turned(30, 1).moved([1.1, 0.0, 1.2]), 0),
        Part(sphere(0.8, 64).moved(BALL), 3),
    ]
    matt = [
        Material(name, (*colour, 1.0), metallic=0.0, roughness=1.0, double_sided=True)
        for name, colour in COLOURS.items()
    ]
    metal = Material("metal", (0.95, 0.93, 0.9, 1.0), metallic=1.0, roughness=0.12)
    return scene_of("yard", parts, [*matt, metal])


if __name__ == "__main__":
    main()
