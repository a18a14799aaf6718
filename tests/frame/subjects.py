"""Small scenes and environments that the tests of frames look at."""

import numpy as np

from raysvc.builtin.mesh import Part, scene_of
from raysvc.builtin.shapes import box, sheet, sphere
from raysvc.scene import Environment, Material, PunctualLight, Scene, Texture, TextureRef

GREY = Material(name="grey", base_colour=(0.5, 0.5, 0.5, 1.0), metallic=0.0, roughness=1.0)
MIRROR = Material(name="mirror", metallic=1.0, roughness=0.0)
RED = Material(name="red", base_colour=(0.8, 0.1, 0.1, 1.0), metallic=0.0, roughness=0.5)


def constant_environment(value: float = 1.0) -> Environment:
    """The same light from everywhere."""
    return Environment(np.full((16, 32, 3), value, np.float32), name="constant")


def ball(material: Material, rings: int = 48) -> Scene:
    """One sphere of radius 1 about the origin."""
    return scene_of("ball", [Part(sphere(1.0, rings), 0)], [material])


def still_life() -> Scene:
    """A mirror ball and a red box on a chequered floor, under a lamp."""
    texels = np.full((8, 8, 4), 255, np.uint8)
    texels[(np.indices((8, 8)).sum(axis=0) % 2) == 1, :3] = 40
    floor = Material(
        name="floor",
        metallic=0.0,
        roughness=0.3,
        base_colour_texture=TextureRef(0),
        double_sided=True,
    )
    parts = [
        Part(sheet(6.0, 6.0, 1, 1), 0),
        Part(sphere(0.8, 24).moved([-0.9, 0.8, 0.0]), 1),
        Part(box(1.0, 1.0, 1.0).moved([0.9, 0.0, 0.3]), 2),
    ]
    lamp = PunctualLight("point", (20.0, 18.0, 15.0), position=(2.0, 4.0, 3.0))
    return scene_of(
        "still life",
        parts,
        [floor, MIRROR, RED],
        textures=[Texture(texels, nearest=True)],
        lights=[lamp],
    )


VIEW = {"eye": [0.5, 2.0, 5.0], "target": [0.0, 0.6, 0.0], "width": 96, "height": 54}
