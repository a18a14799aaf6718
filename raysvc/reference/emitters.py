"""Triangles that shine, as a light of paths: points on them, drawn by how much they shine.

Both sides of a triangle shine, as rays see both. What a texture makes of the emission is looked at
in a few places of each triangle, and a tenth of the choices ignores it, so that no bright texel can
be missed for ever.
"""

import numpy as np

from raysvc.lighting.clearcoat import Varnish
from raysvc.lighting.sun import LUMINANCE
from raysvc.reference.lights import LightSamples
from raysvc.scene import Scene
from raysvc.shading.scene_tables import SceneTables
from raysvc.shading.surface import Surface
from raysvc.types import Bools, Doubles, Floats, Ints

LOOKS = 16
"""Places in which a triangle's emission is looked at."""
BLIND = 0.1
"""Part of the choices that goes by area and emission factor alone."""
CHUNK = 1 << 16


class Emitters:
    """All triangles of a scene that shine. Immutable; safe to use from many threads."""

    def __init__(self, scene: Scene, tables: SceneTables) -> None:
        self._tables = tables
        corners = scene.positions[scene.triangles].astype(np.float64)
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        area = np.sqrt(np.einsum("fk,fk->f", across, across)) / 2.0
        material = scene.material_of_triangle
        unlit = np.array([m.unlit for m in scene.materials], np.bool_)[material]
        factor = np.array([m.emissive for m in scene.materials]).reshape(-1, 3)[material]
        self.shines: Bools = unlit | factor.any(axis=1)
        """(F,) triangles that are not dark without light: these, and unlit ones."""
        strength = np.where(unlit, 0.0, factor @ LUMINANCE) * area
        self._triangle = np.flatnonzero(strength > 0.0).astype(np.int32)
        self._corners = corners[self._triangle]
        self.density_of_triangle = np.zeros(len(scene.triangles))
        """(F,) float64 density per square metre with which a point of a triangle is drawn."""
        if self.is_dark:
            return
        blind = strength[self._triangle]
        power = self._mean_luminance() * area[self._triangle]
        share = blind / blind.sum()
        if power.sum() > 0.0:
            share = BLIND * share + (1.0 - BLIND) * power / power.sum()
        self._sums = np.cumsum(share)
        self.density_of_triangle[self._triangle] = share / area[self._triangle]

    @property
    def is_dark(self) -> bool:
        """Nothing shines."""
        return not len(self._triangle)

    def density(self, triangle: Ints, surface: Surface, distance: Floats) -> Doubles:
        """Density per steradian (N,) with which `sample` draws points from `distance` (N,) away.

        `surface` are the points, of triangles (N,), seen from there.
        """
        cosine = np.einsum("nk,nk->n", surface.geometric_normal, surface.to_viewer)
        per_area = self.density_of_triangle[triangle]
        away = np.square(distance, dtype=np.float64)
        density: Doubles = per_area * away / np.maximum(np.abs(cosine), 1e-12)
        return density

    def sample(self, position: Floats, pick: Doubles, place: Doubles) -> LightSamples:
        """Draw for points (N, 3) float32 a point of a light each; not if `is_dark`.

        `pick` (N,) and `place` (N, 2) are random numbers in 0..1.
        """
        chosen = np.searchsorted(self._sums, pick * self._sums[-1], side="right")
        chosen = np.minimum(chosen, len(self._sums) - 1)
        barycentric = _on_triangle(place)
        origin = self._corners[chosen, 0]
        point = origin + barycentric[:, :1] * (self._corners[chosen, 1] - origin)
        point += barycentric[:, 1:] * (self._corners[chosen, 2] - origin)
        away = point - position
        distance = np.sqrt(np.einsum("nk,nk->n", away, away))
        to_light = (away / np.maximum(distance, 1e-20)[:, None]).astype(np.float32)
        triangle, at = self._triangle[chosen], barycentric.astype(np.float32)
        distance = distance.astype(np.float32)
        seen, emission = self._emission(triangle, at, to_light)
        density = self.density(triangle, seen, distance)
        radiance = emission / np.maximum(density, 1e-300)[:, None]
        radiance[density <= 0.0] = 0.0
        # What is free must end before the triangle itself
        cosine = np.einsum("nk,nk->n", seen.geometric_normal, seen.to_viewer)
        reach = np.maximum(distance - seen.clearance / np.maximum(np.abs(cosine), 1e-6), 0.0)
        return LightSamples(to_light, reach, radiance.astype(np.float32), density)

    def _emission(
        self, triangle: Ints, barycentric: Floats, directions: Floats
    ) -> tuple[Surface, Floats]:
        """Points as rays in `directions` (N, 3) see them, and what they emit (N, 3), as far as
        they cover what is behind them.
        """
        seen = self._tables.surface(triangle, barycentric, directions)
        return seen, emission_of(seen) * self._tables.alpha(triangle, barycentric)[:, None]

    def _mean_luminance(self) -> Doubles:
        """(E,) of the emission of the triangles that shine, over some places of each."""
        index = np.arange(LOOKS)
        steps = np.array([0.7548776662466927, 0.5698402909980532])
        looks = _on_triangle((0.5 + index[:, None] * steps) % 1.0).astype(np.float32)
        up = np.zeros((CHUNK, 3), np.float32)
        up[:, 1] = 1.0
        means = np.empty(len(self._triangle))
        for begin in range(0, len(means), CHUNK // LOOKS):
            some = np.repeat(self._triangle[begin : begin + CHUNK // LOOKS], LOOKS)
            at = np.tile(looks, (len(some) // LOOKS, 1))
            _, emission = self._emission(some, at, up[: len(some)])
            light = emission.astype(np.float64) @ LUMINANCE
            means[begin : begin + CHUNK // LOOKS] = light.reshape(-1, LOOKS).mean(axis=1)
        return means


def emission_of(surface: Surface) -> Floats:
    """Radiance (N, 3) that surfaces give off towards their viewers, as far as varnish lets it."""
    if not surface.coat.size:
        return surface.emissive
    emission, varnish = surface.emissive.copy(), Varnish.of(surface)
    emission[varnish.point] *= 1.0 - varnish.share
    return emission


def _on_triangle(place: Doubles) -> Doubles:
    """(N, 2) weights of vertices 1 and 2, spread evenly over a triangle, for (N, 2) in 0..1."""
    root = np.sqrt(place[:, 0])
    return np.stack([root * (1.0 - place[:, 1]), root * place[:, 1]], axis=1)
