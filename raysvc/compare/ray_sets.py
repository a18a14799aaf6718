"""Rays of five kinds, as renderers and textbooks ask them: exactly as many as wanted, from a seed.

    random       origins uniform in the bounds' box, directions uniform on the sphere
    primary      a camera's, through pixel centres, in tiles of 8 x 8 pixels from the top left
    reflection   off what the camera sees, mirrored about the shading normal
    diffuse      off what the camera sees, cosine-distributed about the shading normal
    shadow       from what the camera sees and the light faces, towards the light

Structures know triangles and not materials, so holes in a material are solid here. The last three
kinds keep the order of the pixels that they come from; where pixels show nothing, more are sampled.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final, Literal, get_args

import numpy as np

from raysvc.accel.base import Rays, Triangles, nearest
from raysvc.accel.registry import build
from raysvc.accel.report import Query
from raysvc.errors import InvalidSetting
from raysvc.frame.surroundings import default_environment
from raysvc.lighting.direct import arriving
from raysvc.lighting.sun import SunLight, extract_suns
from raysvc.parallel import Control, map_chunks
from raysvc.scene import Camera, PunctualLight, Scene
from raysvc.shading.scene_tables import SceneTables
from raysvc.shading.surface import Surface
from raysvc.tracing.reflection import mirror_rays, rays_from
from raysvc.types import Floats, Longs

RayKind = Literal["random", "primary", "reflection", "diffuse", "shadow"]
RAY_KINDS: Final = get_args(RayKind)
QUERY_OF: Final[dict[RayKind, Query]] = {
    kind: "occluded" if kind == "shadow" else "nearest" for kind in RAY_KINDS
}
"""What a renderer asks of rays of a kind."""

TILE: Final = 8
CHUNK: Final = 1 << 14
FEWEST_PIXELS: Final = 1 << 12
"""A coarser picture might miss what the camera sees."""
MOST_ROUNDS: Final = 64
"""A camera whose picture is emptier than one part in so many has too little to reflect off."""
BEFORE_LIGHT: Final = np.float32(0.9999)
"""A ray that starts off the surface must not pass a light that is near it."""


@dataclass(frozen=True, slots=True, eq=False)
class RaySet:
    """Rays, which depend on scene, camera, kind, count and seed, and on nothing else."""

    kind: RayKind
    seed: int
    rays: Rays

    @property
    def query(self) -> Query:
        """What is asked of them."""
        return QUERY_OF[self.kind]

    def __len__(self) -> int:
        return len(self.rays)


def ray_set(
    kind: RayKind,
    scene: Scene,
    camera: Camera,
    count: int,
    seed: int,
    control: Control | None = None,
) -> RaySet:
    """Make `count` rays; the camera's own resolution gives way to one of about as many pixels.

    Raises InvalidSetting when the camera sees nothing, or nothing that the light faces.
    """
    control = control or Control()
    rng = np.random.default_rng(seed)
    if kind == "random":
        rays = _random(scene, count, rng)
    elif kind == "primary":
        view = _resized(camera, count)
        rays = _primary(view, _tiled(view)[:count])
    else:
        leave: Callable[[Surface], Rays]
        if kind == "reflection":
            leave = mirror_rays
        elif kind == "diffuse":
            leave = _Diffuse(rng)
        else:
            leave = _Shadow(_light_of(scene))
        view = _resized(camera, max(count, FEWEST_PIXELS))
        rays = _leaving(scene, view, count, rng, leave, control)
    return RaySet(kind, seed, rays)


def _random(scene: Scene, count: int, rng: np.random.Generator) -> Rays:
    low, high = scene.bounds()
    origins = rng.uniform(low, high, (count, 3)).astype(np.float32)
    return _endless(origins, _on_sphere(count, rng))


def _on_sphere(count: int, rng: np.random.Generator) -> Floats:
    """(count, 3) float32 unit vectors, uniform: a point's height on a sphere is uniform."""
    z, turn = rng.uniform(-1.0, 1.0, count), rng.uniform(0.0, 2.0 * np.pi, count)
    across = np.sqrt(1.0 - z * z)
    return np.stack([across * np.cos(turn), across * np.sin(turn), z], axis=1).astype(np.float32)


def _resized(camera: Camera, count: int) -> Camera:
    """The same view in at least `count` pixels, and few more."""
    width = max(round(math.sqrt(count * camera.width / camera.height)), 1)
    return replace(camera, width=width, height=-(-count // width))


def _tiled(camera: Camera) -> Longs:
    """(width * height,) pixels, tile by tile, as threads of a renderer take them."""
    row, col = np.divmod(np.arange(camera.width * camera.height), camera.width)
    order: Longs = np.lexsort((col, row, col // TILE, row // TILE))
    return order


def _primary(camera: Camera, pixel: Longs) -> Rays:
    return _endless(*camera.rays(pixel))


def _endless(origins: Floats, directions: Floats) -> Rays:
    return Rays(origins, directions, np.full(len(origins), np.inf, np.float32))


def _leaving(
    scene: Scene,
    camera: Camera,
    count: int,
    rng: np.random.Generator,
    leave: Callable[[Surface], Rays],
    control: Control,
) -> Rays:
    """Rays that leave what the camera sees: at pixel centres, then elsewhere in the pixels."""
    triangles = Triangles(scene.positions, scene.triangles)
    structure, tables = build("bvh", triangles), SceneTables.of(scene)
    pixel, view = _tiled(camera), camera
    parts: list[Rays] = []
    found = 0

    def seen(begin: int, end: int) -> Surface:
        rays = _primary(view, pixel[begin:end])
        hits = nearest(structure, triangles, rays)
        met = np.flatnonzero(hits.triangle >= 0)
        return tables.surface(
            hits.triangle[met],
            hits.barycentric[met],
            rays.directions[met],
        )

    for _ in range(MOST_ROUNDS):
        surfaces = map_chunks(len(pixel), CHUNK, seen, control)
        parts.append(leave(Surface.joined(surfaces)))
        found += len(parts[-1])
        if found >= count:
            # Evenly spaced ones, so that the last come from the bottom of the picture.
            kept = np.arange(count) * found // count
            return Rays(
                np.concatenate([part.origins for part in parts])[kept],
                np.concatenate([part.directions for part in parts])[kept],
                np.concatenate([part.t_max for part in parts])[kept],
            )
        if not found:
            break
        view = camera.shifted(*rng.uniform(-0.5, 0.5, 2))
    raise InvalidSetting("shows too little for rays to leave from", field="camera")


class _Diffuse:
    """A unit normal and a point of the unit sphere add up to a cosine-distributed direction."""

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng

    def __call__(self, surface: Surface) -> Rays:
        directions = surface.normal + np.float32(0.9999) * _on_sphere(surface.size, self._rng)
        below = np.einsum("nk,nk->n", surface.geometric_normal, directions)[:, None]
        directions -= np.minimum(2.0 * below, 0.0) * surface.geometric_normal
        directions /= np.sqrt(np.einsum("nk,nk->n", directions, directions))[:, None]
        return rays_from(surface, directions, np.full(surface.size, np.inf, np.float32))


class _Shadow:
    """Points that face the light look whether it is there."""

    def __init__(self, light: SunLight | PunctualLight) -> None:
        self._light = light

    def __call__(self, surface: Surface) -> Rays:
        to_light, distance, _ = arriving(self._light, surface.position)
        faces = np.einsum("nk,nk->n", surface.geometric_normal, to_light) > 0
        faces &= np.einsum("nk,nk->n", surface.normal, to_light) > 0
        lit = surface.chosen(faces)
        return rays_from(lit, to_light[faces], distance[faces] * BEFORE_LIGHT)


def _light_of(scene: Scene) -> SunLight | PunctualLight:
    """The scene's first light, or the sun of the built-in sky if it has none."""
    if scene.lights:
        return scene.lights[0]
    suns, _ = extract_suns(default_environment().radiance)
    return suns[0]
