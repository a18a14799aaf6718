"""A polished torus in a park: 20,872 and 255,488 triangles, 288,852 in all over four materials.

The counts are those of the scene in the 2009 talk that this project follows ("Shiny, Blurry
Things"): a torus, a park, and two further materials, here stone and iron. The park is all one
material; vertex colours tell grass from bark and leaves.
"""

import numpy as np

from raysvc.builtin.ground import SANDSTONE, beside_path, height_of_ground, path_mesh
from raysvc.builtin.mesh import Mesh, Part, camera_at, merged, scene_of
from raysvc.builtin.park_furniture import bench, lamp_post, plinth
from raysvc.builtin.patterns import mottled, paving
from raysvc.builtin.plants import Foliage, blades, broadleaf, bush, planted, slender
from raysvc.builtin.shapes import fine_disc, torus
from raysvc.scene import Material, Scene, TextureRef
from raysvc.types import Doubles

TORUS_TRIANGLES = 20_872
PARK_TRIANGLES = 255_488
FURNITURE_TRIANGLES = 12_492
LAWN_TRIANGLES = 46_000
LAWN_RADIUS = 34.0
PLAZA_RADIUS = 2.7
PLINTH_HEIGHT = 0.5

GOLD, PARK, STONE, IRON = range(4)
MATERIALS = (
    Material("gold", (1.0, 0.74, 0.42, 1.0), metallic=1.0, roughness=0.06),
    Material(
        "park", metallic=0.0, roughness=0.85, double_sided=True, base_colour_texture=TextureRef(0)
    ),
    Material("stone", metallic=0.0, roughness=0.7, base_colour_texture=TextureRef(1)),
    Material("iron", (0.30, 0.33, 0.32, 1.0), metallic=1.0, roughness=0.3),
)
GRASS = (0.13, 0.22, 0.045)
OAK = Foliage((0.10, 0.19, 0.035), 0.24, 4_900)
LIME = Foliage((0.17, 0.25, 0.045), 0.23, 4_800)
CHERRY = Foliage((0.68, 0.34, 0.36), 0.11, 18_000)
FAR_CHERRY = Foliage((0.68, 0.34, 0.36), 0.20, 3_500)
POPLAR = Foliage((0.085, 0.17, 0.05), 0.25, 2_200)
SHRUB = Foliage((0.09, 0.18, 0.04), 0.11, 1_000)
FLOWERS = Foliage((0.52, 0.13, 0.20), 0.09, 1_100)

# Kind of tree, foliage, height in metres, and where it stands (x, z); the camera is at (-1.3, 6.2).
TREES = (
    (broadleaf, OAK, 9.0, (-8.6, -11.5)),
    (broadleaf, LIME, 8.0, (8.5, -13.0)),
    (broadleaf, CHERRY, 5.4, (6.7, -4.0)),
    (broadleaf, LIME, 8.5, (-15.0, 3.0)),
    (broadleaf, OAK, 9.0, (14.0, 5.0)),
    (broadleaf, OAK, 8.5, (-8.0, 15.5)),
    (broadleaf, FAR_CHERRY, 5.0, (-4.2, -18.0)),
    (slender, POPLAR, 11.0, (-16.0, -18.0)),
    (slender, POPLAR, 12.5, (-13.0, -20.5)),
    (slender, POPLAR, 10.0, (-2.2, -25.5)),
    (slender, POPLAR, 11.5, (0.1, -26.5)),
    (slender, POPLAR, 10.5, (2.3, -25.0)),
    (slender, POPLAR, 12.0, (14.5, -21.0)),
    (slender, POPLAR, 11.0, (17.5, -19.0)),
    (slender, POPLAR, 12.0, (-23.0, 10.0)),
    (slender, POPLAR, 11.5, (22.0, 12.0)),
    (slender, POPLAR, 12.0, (0.5, 25.0)),
    (slender, POPLAR, 11.0, (-3.5, 26.0)),
)
# Radius in metres, foliage, and where.
BUSHES = (
    (0.9, SHRUB, (-5.6, -4.4)),
    (0.7, FLOWERS, (-4.7, -5.3)),
    (1.1, SHRUB, (-6.9, -5.4)),
    (0.8, FLOWERS, (3.9, -6.4)),
    (1.0, SHRUB, (5.0, -7.2)),
    (0.9, SHRUB, (10.5, -4.0)),
    (1.2, SHRUB, (-13.0, -14.0)),
    (1.3, SHRUB, (1.5, -19.0)),
    (1.3, SHRUB, (-1.5, -20.5)),
    (1.4, SHRUB, (12.0, -18.0)),
    (0.9, FLOWERS, (7.5, 5.5)),
    (1.0, SHRUB, (-9.0, 7.5)),
)
LAMPS = ((-4.3, -2.2), (1.7, -9.6), (6.6, -16.5), (-3.9, 9.5))
BENCHES = ((3.6, -2.4, -35.0), (-5.3, 2.0, 80.0))


def torus_park() -> Scene:
    """Return the scene."""
    parts = [
        Part(_torus(), GOLD),
        Part(_park(np.random.default_rng(2009)), PARK),
        *_furniture(),
    ]
    return scene_of(
        "torus_park",
        parts,
        MATERIALS,
        textures=[mottled(256, 14.0, seed=1), paving(256, 8, seed=2)],
        cameras=[camera_at((-1.3, 1.65, 6.2), (0.25, 1.55, 0.0), 38.0, 16 / 9)],
    )


def _torus() -> Mesh:
    """Stand the torus on its plinth, turned a little from the camera."""
    ring = torus(1.0, 0.4, rings=64, triangles=TORUS_TRIANGLES)
    return ring.turned(90, 0).turned(24, 1).moved([0, PLINTH_HEIGHT + 1.38, 0])


def _park(rng: np.random.Generator) -> Mesh:
    """Lawn, trees and bushes, and as many blades of grass as make up the count."""
    lawn = fine_disc(LAWN_RADIUS * np.linspace(1.0, 0.0, 111)[:-1] ** 1.6, LAWN_TRIANGLES)
    positions = lawn.positions.copy()
    positions[:, 1], normals = height_of_ground(positions[:, 0], positions[:, 2])
    worn = 0.85 + 0.25 * np.sin(0.9 * positions[:, 0]) * np.sin(0.7 * positions[:, 2] + 1.0)
    lawn = Mesh(
        positions=positions,
        normals=normals,
        tangents=_along_x(normals),
        uv=positions[:, [0, 2]] * 0.35,
        colours=np.array(GRASS) * worn[:, None],
        triangles=lawn.triangles,
    )
    trees = planted(
        [make(height, foliage, rng) for make, foliage, height, _ in TREES],
        _on_ground(np.array([place for *_, place in TREES])),
    )
    bushes = planted(
        [bush(radius, foliage, rng) for radius, foliage, _ in BUSHES],
        _on_ground(np.array([place for *_, place in BUSHES])),
    )
    grown = merged([lawn, trees, bushes])
    roots = _roots(PARK_TRIANGLES - len(grown.triangles), rng)
    return merged([grown, blades(roots, 0.12, GRASS, rng)])


def _roots(count: int, rng: np.random.Generator) -> Doubles:
    """(count, 3) places for grass off the path and the plaza, denser near the middle."""
    radius = 0.9 * PLAZA_RADIUS + 8.5 * rng.random(3 * count) ** 1.3
    turn = 2.0 * np.pi * rng.random(3 * count)
    places = np.column_stack([radius * np.cos(turn), radius * np.sin(turn)])
    free = (radius > PLAZA_RADIUS + 0.03) & beside_path(places[:, 0], places[:, 1])
    return _on_ground(places[free][:count])


def _furniture() -> list[Part]:
    """Everything of stone and of iron; the plaza has as many triangles as make up the count."""
    iron, stone = [], [plinth(1.05, PLINTH_HEIGHT), path_mesh()]
    for place in _on_ground(np.array(LAMPS)):
        post, globe = lamp_post()
        iron.append(post.moved(place))
        stone.append(globe.moved(place))
    for x, z, turn in BENCHES:
        legs, slats = bench()
        place = _on_ground(np.array([[x, z]]))[0]
        iron.append(legs.turned(turn, 1).moved(place))
        stone.append(slats.turned(turn, 1).moved(place))
    so_far = sum(len(mesh.triangles) for mesh in [*iron, *stone])
    rings = PLAZA_RADIUS * np.linspace(1.0, 0.0, 13)[:-1]
    plaza = fine_disc(rings, FURNITURE_TRIANGLES - so_far).textured(5, 1).coloured(SANDSTONE)
    stone.append(plaza.moved([0, 0.05, 0]))
    return [Part(merged(stone), STONE), Part(merged(iron), IRON)]


def _on_ground(places: Doubles) -> Doubles:
    """(N, 3) points of the lawn at (N, 2) x and z."""
    height, _ = height_of_ground(places[:, 0], places[:, 1])
    return np.column_stack([places[:, 0], height, places[:, 1]])


def _along_x(normals: Doubles) -> Doubles:
    """(N, 4) tangents of a height field whose u follows +X."""
    along = np.column_stack([normals[:, 1], -normals[:, 0], np.zeros(len(normals))])
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    return np.column_stack([along, np.ones(len(normals))])
