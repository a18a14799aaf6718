"""Lamps: surfaces that glow, as lights.

Clusters of glowing pieces (`raysvc.lighting.lamp_clusters`) light as discs of their area do
(Wallace et al. 1989, "A Ray Tracing Algorithm for Progressive Radiosity"), and close by piece by
piece in closed form: without noise, and finite however near they are. Shadow rays go to places on
the pieces themselves, of clusters chosen by how much light they send to the point.

What is large, such as a glowing wall, is no lamp: rays in all directions find it.
"""

from typing import NamedTuple

import numpy as np

from raysvc import records
from raysvc.lighting.area_light import ShadowRays
from raysvc.lighting.brushed_light import round_roughness
from raysvc.lighting.lamp_clusters import areas, clustered, powers
from raysvc.lighting.lamp_kernels import Pieces, light_from_lamps, rays_to_pieces
from raysvc.lighting.lamp_pieces import pieces_of
from raysvc.lighting.sun import LUMINANCE
from raysvc.scene import Scene
from raysvc.shading.scene_tables import SceneTables
from raysvc.shading.surface import Surface
from raysvc.types import Bools, Doubles, Floats, Longs

LARGE = 0.002
"""Part of a scene's area above which clusters are too large on the mean to be seen as discs."""
MOST = 0.05
"""Part of a scene's area above which what glows is so much that rays find it, and no lamp."""
COLOURS = 4
"""Into how many lights lamps are divided at most, for the shadows of each to have its colour."""
LIKE = 0.06
"""Largest difference of a channel's share between like colours."""
SMOOTH, ROUGH = 0.08, 0.22
"""Roughness up to which reflected rays show what glows, and from which its highlight is here."""


def highlight(roughness: Floats) -> Floats:
    """(N,) share of the highlights of what glows that is not left to reflected rays."""
    x = np.clip((roughness - SMOOTH) / (ROUGH - SMOOTH), 0.0, 1.0)
    smooth: Floats = (x * x * (3.0 - 2.0 * x)).astype(np.float32)
    return smooth


class LampLight:
    """Lamps of about one colour. Immutable; safe to use from many threads."""

    rim: Doubles = np.array([(u, v) for u in (0.05, 0.35, 0.65, 0.95) for v in (0.1, 0.9)])
    """(8, 2): beginning, middle and end of all clusters, both sides of their pieces."""

    def __init__(self, pieces: Pieces) -> None:
        self._pieces, self._order, self._discs = clustered(pieces)

    @property
    def clusters(self) -> int:
        """As how many discs it lights from afar."""
        return len(self._discs.area)

    def unshadowed(self, surface: Surface) -> Floats:
        """(N, 3) radiance that points return of it with nothing in the way.

        Smooth surfaces are without highlights: their reflected rays meet what glows.
        """
        radiance = np.empty((surface.size, 3), np.float32)
        shine = highlight(round_roughness(surface))
        light_from_lamps(self._discs, self._pieces, self._order, surface, shine, radiance)
        return radiance

    def rays(self, surface: Surface, point: Longs, samples: Doubles) -> ShadowRays:
        """Rays from points (M,) of a surface to places chosen by how much light they send there."""
        count = len(point)
        rays = ShadowRays(np.empty((count, 3), np.float32), np.empty(count, np.float32))
        rays_to_pieces(self._discs, self._pieces, self._order, surface, point, samples, *rays)
        return rays


class Lamps(NamedTuple):
    """What of a scene glows and is small enough to be looked for."""

    lights: tuple[LampLight, ...]
    """One for each colour."""
    shines: Bools
    """(F,) triangles that these lights are made of."""


def lamps_of(scene: Scene, tables: SceneTables) -> Lamps:
    """Find what glows and is small: a light for each of up to COLOURS colours."""
    unlit = np.array([m.unlit for m in scene.materials], np.bool_)
    factor = np.array([m.emissive for m in scene.materials]).reshape(-1, 3) @ LUMINANCE
    factor = np.where(unlit, 0.0, factor)
    shines = np.zeros(len(scene.triangles), np.bool_)
    if not factor.any():
        return Lamps((), shines)
    corners = scene.positions[scene.triangles].astype(np.float64)
    edges = corners[:, 1:] - corners[:, :1]
    area = 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    glows = factor[scene.material_of_triangle] * area
    triangle = np.flatnonzero(glows > 0.0).astype(np.int32)
    pieces, material = pieces_of(scene, tables, triangle, glows[triangle])
    group = _colours(pieces, material, len(scene.materials))
    lights = []
    for number in range(COLOURS):
        own = np.flatnonzero(group[scene.material_of_triangle] == number)
        if len(own):
            light = LampLight(records.chosen(pieces, group[material] == number))
            if area[own].sum() <= min(LARGE * light.clusters, MOST) * area.sum():
                lights.append(light)
                shines[own] = True
    return Lamps(tuple(lights), shines)


def _colours(pieces: Pieces, material: Longs, materials: int) -> Longs:
    """(materials,) to which of COLOURS colours each belongs, -1 if it does not glow.

    The brightest give theirs; all that are like none of those share the last.
    """
    power = np.bincount(material, powers(pieces), materials)
    light = pieces.radiance * areas(pieces)[:, None]
    colour = np.stack([np.bincount(material, light[:, c], materials) for c in range(3)], axis=1)
    colour = colour / np.maximum(colour.sum(axis=1), 1e-300)[:, None]
    group = np.where(power > 0.0, COLOURS - 1, -1)
    left = power > 0.0
    for number in range(COLOURS - 1):
        brightest = int(np.argmax(np.where(left, power, -1.0)))
        like = left & (np.abs(colour - colour[brightest]).max(axis=1) <= LIKE)
        group[like] = number
        left &= ~like
    return group
