"""Trees, bushes and grass. A crown is a few round puffs: dark cores under many small leaves."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from raysvc.builtin.mesh import Mesh, merged
from raysvc.builtin.shapes import lathe, sphere
from raysvc.geometry.transform import unit
from raysvc.types import Doubles

Colour = tuple[float, float, float]
BARK: Colour = (0.12, 0.085, 0.06)


@dataclass(frozen=True, slots=True)
class Foliage:
    """How leaves look: linear colour, metres long, and how many (two triangles each) on a plant."""

    colour: Colour
    length: float
    leaves: int


def broadleaf(height: float, foliage: Foliage, rng: np.random.Generator) -> Mesh:
    """Tree with a wide crown, its root at the origin."""
    puffs = 9
    turn = 2.4 * np.arange(puffs) + 6.0 * rng.random()
    level = (np.arange(puffs) + 0.5) / puffs
    spread = 0.24 * height * np.sqrt(np.sin(np.pi * (0.12 + 0.8 * level)))
    centres = np.column_stack(
        [spread * np.cos(turn), height * (0.48 + 0.36 * level), spread * np.sin(turn)]
    )
    radii = height * (0.2 - 0.06 * level) * (0.85 + 0.3 * rng.random(puffs))
    fork = np.array([0.0, 0.34 * height, 0.0])
    limbs = [_limb(fork, centre, 0.016 * height, 0.008 * height) for centre in centres]
    trunk = _trunk(0.42 * height, 0.032 * height)
    return merged([trunk, *limbs, crown(centres, radii, foliage, rng)])


def slender(height: float, foliage: Foliage, rng: np.random.Generator) -> Mesh:
    """Tree with a tall, narrow crown such as a poplar's, its root at the origin."""
    level = np.linspace(0.0, 1.0, 7)
    centres = np.column_stack([np.zeros(7), height * (0.2 + 0.68 * level), np.zeros(7)])
    centres[:, [0, 2]] += 0.03 * height * (rng.random((7, 2)) - 0.5)
    radii = height * (0.125 * np.sin(np.pi * (0.28 + 0.6 * level)) + 0.012)
    trunk = _trunk(0.25 * height, 0.018 * height)
    return merged([trunk, crown(centres, radii, foliage, rng)])


def bush(radius: float, foliage: Foliage, rng: np.random.Generator) -> Mesh:
    """Low plant about the origin, partly in the ground."""
    centres = radius * np.array([[0, 0.55, 0], [0.6, 0.35, 0.2], [-0.5, 0.4, 0.35], [0, 0.3, -0.6]])
    return crown(centres, radius * np.array([0.7, 0.55, 0.5, 0.5]), foliage, rng)


def crown(centres: Doubles, radii: Doubles, foliage: Foliage, rng: np.random.Generator) -> Mesh:
    """Puffs about (P, 3) centres with (P,) radii: dark cores, and leaves over them by area."""
    shade = np.array(foliage.colour) * 0.3
    ball = sphere(1.0, 7)
    cores = [
        ball.scaled(0.86 * radius).moved(centre).coloured(shade)
        for centre, radius in zip(centres, radii, strict=True)
    ]
    return merged([*cores, _leaves(centres, radii, foliage, rng)])


def _leaves(centres: Doubles, radii: Doubles, foliage: Foliage, rng: np.random.Generator) -> Mesh:
    """Rhombic leaves near the surface of puffs, shaded as parts of a round whole."""
    count = foliage.leaves
    area = np.cumsum(radii**2) / np.sum(radii**2)
    puff = np.searchsorted(area, rng.random(count))
    outward = _directions(count, rng)
    depth = 0.86 + 0.22 * rng.random(count)
    middle = centres[puff] + outward * (radii[puff] * depth)[:, None]

    facing = unit(outward + 0.7 * _directions(count, rng))
    along = unit(np.cross(facing, _directions(count, rng)))
    aside = np.cross(along, facing)
    half_length = 0.5 * foliage.length * (0.7 + 0.6 * rng.random(count))[:, None]
    corners = np.stack(
        [
            middle - along * half_length,
            middle + aside * half_length * 0.6,
            middle + along * half_length,
            middle - aside * half_length * 0.6,
        ],
        axis=1,
    )
    # Leaves deeper in the crown and on its underside see less of the sky than their own triangles
    # tell.
    whole = (centres * radii[:, None] ** 2).sum(axis=0) / np.sum(radii**2)
    from_whole = unit(middle - whole)
    open_sky = (0.55 + 0.45 * (depth - 0.86) / 0.22) * (0.8 + 0.2 * from_whole[:, 1])
    tone = open_sky * (0.75 + 0.5 * rng.random(count))
    tint = 1.0 + 0.35 * (rng.random(count)[:, None] - 0.5) * np.array([1.0, 0.15, -0.3])
    colours = np.array(foliage.colour) * tone[:, None] * tint
    return _scattered(corners, unit(outward + 0.6 * from_whole + 0.7 * facing), aside, colours)


def blades(roots: Doubles, length: float, colour: Colour, rng: np.random.Generator) -> Mesh:
    """Grass: one triangle for each of (N, 3) roots, lying at random under half of a right angle.

    Flat enough for the upper sides to be seen, and to be lit wherever the sun stands: nothing here
    lets light through, and upright blades with the sun behind them would be black.
    """
    count = len(roots)
    turn = 2.0 * np.pi * rng.random(count)
    lean = np.column_stack([np.cos(turn), np.zeros(count), np.sin(turn)])
    aside = np.column_stack([-lean[:, 2], np.zeros(count), lean[:, 0]])
    slope = np.radians(12.0 + 26.0 * rng.random(count))[:, None]
    up = np.array([0.0, 1.0, 0.0])
    reach = length * (0.5 + rng.random(count))[:, None]
    tip = roots + reach * (np.cos(slope) * lean + np.sin(slope) * up)
    foot = roots + 0.006 * up
    corners = np.stack([foot - aside * 0.08 * length, foot + aside * 0.08 * length, tip], axis=1)
    tone = (0.75 + 0.75 * rng.random(count))[:, None]
    tint = 1.0 + 0.5 * (rng.random(count)[:, None] - 0.5) * np.array([1.0, 0.2, 0.0])
    colours = np.array(colour) * tone * tint
    return _scattered(corners, unit(up - 0.4 * np.sin(slope) * lean), aside, colours)


def _scattered(corners: Doubles, normals: Doubles, aside: Doubles, colours: Doubles) -> Mesh:
    """Mesh of N small polygons (N, 3 or 4, 3), each with one normal, tangent and colour (N, 3)."""
    count, sides = corners.shape[:2]
    tangents = unit(aside - normals * np.einsum("nk,nk->n", aside, normals)[:, None])
    fan = np.array([[0, i + 1, i + 2] for i in range(sides - 2)])
    outline = np.array([[0.5, 1.0], [1.0, 0.5], [0.5, 0.0], [0.0, 0.5]])[:sides]
    return Mesh(
        positions=corners.reshape(-1, 3),
        normals=np.repeat(normals, sides, axis=0),
        tangents=np.repeat(np.column_stack([tangents, np.ones(count)]), sides, axis=0),
        uv=np.tile(outline, (count, 1)) * 0.1,
        colours=np.repeat(colours, sides, axis=0),
        triangles=(np.arange(count)[:, None, None] * sides + fan).reshape(-1, 3).astype(np.int32),
    )


def _trunk(height: float, radius: float) -> Mesh:
    """Trunk that flares towards the ground."""
    level = np.array([-0.05, 0.0, 0.06, 0.15, 0.35, 0.7, 1.0])
    girth = radius * np.array([2.0, 1.7, 1.3, 1.1, 1.0, 0.85, 0.7])
    return lathe(np.column_stack([girth, height * level]), [14] * 7).coloured(BARK)


def _limb(start: Doubles, end: Doubles, thick: float, thin: float) -> Mesh:
    length = float(np.linalg.norm(end - start))
    side = lathe(np.array([[thick, 0.0], [thin, length]]), [8, 8])
    return side.upright_along(end - start).moved(start).coloured(BARK)


def _directions(count: int, rng: np.random.Generator) -> Doubles:
    """(count, 3) unit vectors, uniform on the sphere."""
    height, turn = 2.0 * rng.random(count) - 1.0, 2.0 * np.pi * rng.random(count)
    out = np.sqrt(1.0 - height**2)
    return np.column_stack([out * np.cos(turn), height, out * np.sin(turn)])


def planted(plants: Sequence[Mesh], places: Doubles) -> Mesh:
    """Merge plants, each moved to its row of (N, 3) places."""
    return merged([plant.moved(place) for plant, place in zip(plants, places, strict=True)])
