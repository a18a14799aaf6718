"""A fence close to the camera, a ball and a box behind it, and lamps far away: the hard case of
depth of field, for what the blurred fence hides is seen through it."""

from raysvc.builtin.mesh import Part, camera_at, scene_of
from raysvc.builtin.patterns import chequer
from raysvc.builtin.shapes import box, sheet, sphere
from raysvc.scene import Material, Scene, TextureRef

PICKETS = 11
APART_M = 0.16
FENCE_Z_M = 3.6
LAMPS = ((-3.4, 1.5), (-2.2, 2.3), (-1.1, 1.4), (-0.2, 2.1), (1.3, 1.6), (2.1, 2.6), (3.3, 1.9))
"""Where lamps hang on the far side: to the right and up, in metres."""

MATERIALS = (
    Material("floor", metallic=0.0, roughness=0.9, base_colour_texture=TextureRef(0)),
    Material("wood", (0.35, 0.2, 0.1, 1.0), metallic=0.0, roughness=0.8),
    Material("red", (0.7, 0.08, 0.07, 1.0), metallic=0.0, roughness=0.6),
    Material("lamp", (0.0, 0.0, 0.0, 1.0), metallic=0.0, emissive=(60.0, 48.0, 30.0)),
)


def fence() -> Scene:
    """Return the scene: some 18,000 triangles, four materials."""
    parts = [Part(sheet(40.0, 40.0, 4, 4).textured(20.0, 20.0), 0)]
    for i in range(PICKETS):
        where = [(i - PICKETS // 2) * APART_M, 0.8, FENCE_Z_M]
        parts.append(Part(box(0.05, 1.6, 0.02).moved(where), 1))
    rail = box(PICKETS * APART_M, 0.06, 0.02)
    parts += [Part(rail.moved([0.0, y, FENCE_Z_M + 0.021]), 1) for y in (0.55, 1.05)]
    parts.append(Part(sphere(0.6, 48).moved([0.0, 0.6, 0.0]), 2))
    parts.append(Part(box(0.5, 0.5, 0.5).moved([-1.3, 0.25, -1.5]), 2))
    parts += [Part(sphere(0.06, 12).moved([x, y, -9.0]), 3) for x, y in LAMPS]
    return scene_of(
        "fence",
        parts,
        MATERIALS,
        textures=[chequer((226, 224, 220), (62, 70, 84))],
        cameras=[camera_at((0.0, 0.9, 5.0), (0.0, 0.8, 0.0), 40.0, 16 / 9)],
    )
