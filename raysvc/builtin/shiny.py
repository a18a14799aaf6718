"""Shiny things on a chequered floor: gold torus, mirror ball, rough steel and red plastic."""

from raysvc.builtin.mesh import Part, camera_at, scene_of
from raysvc.builtin.patterns import chequer
from raysvc.builtin.shapes import sheet, sphere, torus
from raysvc.scene import Material, Scene, TextureRef

GROUND_SIZE = 14.0
FIELDS = 20
"""Fields of the chequer along one side."""

MATERIALS = (
    Material("floor", metallic=0.0, roughness=0.25, base_colour_texture=TextureRef(0)),
    Material("gold", (1.0, 0.71, 0.29, 1.0), metallic=1.0, roughness=0.15),
    Material("mirror", (0.96, 0.96, 0.97, 1.0), metallic=1.0, roughness=0.0),
    Material("steel", (0.62, 0.64, 0.68, 1.0), metallic=1.0, roughness=0.42),
    Material("plastic", (0.62, 0.035, 0.03, 1.0), metallic=0.0, roughness=0.22),
)


def shiny() -> Scene:
    """Return the scene: about 100,000 triangles, five materials."""
    parts = [
        Part(sheet(GROUND_SIZE, GROUND_SIZE, 20, 20).textured(FIELDS / 2, FIELDS / 2), 0),
        Part(torus(1.0, 0.38, rings=80, triangles=33_600).moved([-0.55, 0.38, 0.5]), 1),
        Part(sphere(0.95, 105).moved([1.6, 0.95, -0.9]), 2),
        Part(sphere(0.5, 87).moved([1.35, 0.5, 1.15]), 3),
        Part(sphere(0.7, 87).moved([-2.3, 0.7, -1.5]), 4),
    ]
    return scene_of(
        "shiny",
        parts,
        MATERIALS,
        textures=[chequer((226, 224, 220), (62, 70, 84))],
        cameras=[camera_at((0.9, 2.1, 6.2), (-0.05, 0.55, -0.1), 36.0, 16 / 9)],
    )
