"""Glass and varnish on a chequered floor: a ball, a ring of amber, a bubble, a frosted and a
stained pane, car paint and lacquered wood.
"""

from raysvc.builtin.mesh import Part, camera_at, scene_of
from raysvc.builtin.patterns import chequer
from raysvc.builtin.shapes import sheet, sphere, torus
from raysvc.scene import Material, Scene, TextureRef

GROUND_SIZE = 14.0
FIELDS = 20
"""Fields of the chequer along one side."""

MATERIALS = (
    Material("floor", metallic=0.0, roughness=0.6, base_colour_texture=TextureRef(0)),
    Material(
        "crown glass",
        metallic=0.0,
        roughness=0.0,
        ior=1.52,
        transmission=1.0,
        solid=True,
        absorption=(0.12, 0.03, 0.07),
    ),
    Material(
        "amber",
        metallic=0.0,
        roughness=0.05,
        ior=1.55,
        transmission=1.0,
        solid=True,
        absorption=(0.25, 1.6, 6.0),
    ),
    Material("bubble", metallic=0.0, roughness=0.0, ior=1.33, transmission=1.0, double_sided=True),
    Material(
        "frosted pane",
        (0.93, 0.97, 0.96, 1.0),
        metallic=0.0,
        roughness=0.35,
        transmission=1.0,
        double_sided=True,
    ),
    Material(
        "stained pane",
        (0.12, 0.32, 0.85, 1.0),
        metallic=0.0,
        roughness=0.0,
        transmission=0.9,
        double_sided=True,
    ),
    Material(
        "car paint",
        (0.5, 0.012, 0.02, 1.0),
        metallic=0.6,
        roughness=0.5,
        clearcoat=1.0,
        clearcoat_roughness=0.03,
    ),
    Material(
        "lacquered wood",
        (0.34, 0.15, 0.05, 1.0),
        metallic=0.0,
        roughness=0.8,
        clearcoat=1.0,
        clearcoat_roughness=0.18,
    ),
)


def glass() -> Scene:
    """Return the scene: about 100,000 triangles, eight materials."""
    pane = sheet(1.1, 1.5, 1, 1).turned(90, 0).moved([0.0, 0.75, 0.0])
    parts = [
        Part(sheet(GROUND_SIZE, GROUND_SIZE, 20, 20).textured(FIELDS / 2, FIELDS / 2), 0),
        Part(sphere(0.9, 105).moved([-0.35, 0.9, 0.35]), 1),
        Part(torus(0.52, 0.2, rings=60, triangles=21_600).moved([1.15, 0.2, 1.5]), 2),
        Part(sphere(0.42, 75).moved([-1.75, 0.9, 1.2]), 3),
        Part(pane.turned(-12, 1).moved([2.35, 0.0, -0.1]), 4),
        Part(pane.turned(25, 1).moved([-2.35, 0.0, -0.2]), 5),
        Part(sphere(0.8, 87).moved([1.25, 0.8, -1.7]), 6),
        Part(sphere(0.65, 75).moved([-1.55, 0.65, -1.9]), 7),
    ]
    return scene_of(
        "glass",
        parts,
        MATERIALS,
        textures=[chequer((226, 224, 220), (62, 70, 84))],
        cameras=[camera_at((0.3, 1.9, 6.4), (-0.1, 0.65, -0.1), 36.0, 16 / 9)],
    )
