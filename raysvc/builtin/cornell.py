"""The Cornell box, from the measurements at https://www.graphics.cornell.edu/online/box/data.html

Millimetres there are metres here; the room is turned so that its open front faces +Z. Wall colours
are the Rec.709 values that renderers commonly take for the measured spectra.
"""

import numpy as np

from raysvc.builtin.mesh import Mesh, Part, camera_at, merged, scene_of
from raysvc.builtin.shapes import sheet
from raysvc.scene import Material, Scene
from raysvc.types import Doubles

WHITE, RED, GREEN, LIGHT = range(4)
EMISSION = (18.4, 14.0, 6.75)
MATERIALS = (
    Material("white", (0.725, 0.71, 0.68, 1.0), metallic=0.0, roughness=1.0),
    Material("red", (0.63, 0.065, 0.05, 1.0), metallic=0.0, roughness=1.0),
    Material("green", (0.14, 0.45, 0.091, 1.0), metallic=0.0, roughness=1.0),
    Material("light", (0.78, 0.78, 0.78, 1.0), metallic=0.0, roughness=1.0, emissive=EMISSION),
)
SIZE = np.array([0.5560, 0.5488, 0.5592])
LAMP = ((0.213, 0.343), (0.227, 0.332))
"""The lamp's extent in the measurements' x and z."""

# Tops of the blocks as in the measurements: corners (x, z) in order, and height.
SHORT_BLOCK = (((0.130, 0.065), (0.082, 0.225), (0.240, 0.272), (0.290, 0.114)), 0.165)
TALL_BLOCK = (((0.423, 0.247), (0.265, 0.296), (0.314, 0.456), (0.472, 0.406)), 0.330)


def cornell() -> Scene:
    """Return the scene."""
    width, height, depth = SIZE
    level, upright = sheet(width, depth, 8, 8), sheet(depth, height, 8, 8).turned(90, 0)
    white = [
        level.moved([0, 0, 0]),
        level.turned(180, 2).moved([0, height, 0]),
        sheet(width, height, 8, 8).turned(90, 0).moved([0, height / 2, -depth / 2]),
    ]
    left = upright.turned(90, 1).moved([-width / 2, height / 2, 0])
    right = upright.turned(-90, 1).moved([width / 2, height / 2, 0])
    (x0, x1), (z0, z1) = LAMP
    lamp_centre = _from_measured(0.5 * (x0 + x1), height - 5e-4, 0.5 * (z0 + z1))
    parts = [
        Part(merged(white), WHITE),
        Part(left, RED),
        Part(right, GREEN),
        Part(_block(*SHORT_BLOCK), WHITE),
        Part(_block(*TALL_BLOCK), WHITE),
        Part(sheet(x1 - x0, z1 - z0, 1, 1).turned(180, 2).moved(lamp_centre), LIGHT),
    ]
    return scene_of(
        "cornell",
        parts,
        MATERIALS,
        cameras=[camera_at((0.0, 0.273, 1.0796), (0.0, 0.273, 0.0), 39.3, 1.0)],
    )


def _from_measured(x: float, y: float, z: float) -> Doubles:
    """Point about the room's middle; the measurements look along +z, with +x to the left."""
    return np.array([0.5 * SIZE[0] - x, y, 0.5 * SIZE[2] - z])


def _block(corners: tuple[tuple[float, float], ...], height: float) -> Mesh:
    """Block without a bottom over a quadrilateral (x, z) of the measurements."""
    ring = np.array([_from_measured(x, height, z) for x, z in corners])
    outward = ring - ring.mean(axis=0)
    # Put the corners in counter-clockwise order seen from above.
    ring = ring[np.argsort(np.arctan2(-outward[:, 2], outward[:, 0]))]
    foot = ring * (1.0, 0.0, 1.0)
    sides = [_quad(foot[i], foot[(i + 1) % 4], ring[(i + 1) % 4], ring[i]) for i in range(4)]
    return merged([_quad(*ring), *sides])


def _quad(a: Doubles, b: Doubles, c: Doubles, d: Doubles) -> Mesh:
    """Flat quadrilateral, counter-clockwise from its lower left corner."""
    normal = np.cross(b - a, d - a)
    normal /= np.linalg.norm(normal)
    along = (b - a) / np.linalg.norm(b - a)
    return Mesh(
        positions=np.stack([a, b, c, d]),
        normals=np.tile(normal, (4, 1)),
        tangents=np.tile(np.append(along, 1.0), (4, 1)),
        uv=np.array([[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]]),
        colours=np.ones((4, 3)),
        triangles=np.array([[0, 1, 2], [0, 2, 3]], np.int32),
    )
