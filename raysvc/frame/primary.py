"""From a camera to the points that its pixels show: by rasterising all of them, or by rays for a
few."""

import numpy as np

from raysvc import records
from raysvc.accel.base import Hits, Rays, Triangles, hits_on
from raysvc.frame.points import Points
from raysvc.frame.prepared import Prepared
from raysvc.parallel import Control, map_chunks
from raysvc.raster.rasterise import Raster
from raysvc.raster.spans import Fragments
from raysvc.scene import Camera
from raysvc.shading.surface import Surface
from raysvc.tracing.differentials import footprint_at, mirrored, primary_differentials
from raysvc.types import Bools, Doubles, Floats, Ints, Longs

CHUNK = 1 << 14


def rasterised(
    prepared: Prepared, camera: Camera, control: Control, shown: Bools | None = None
) -> tuple[Longs, Ints]:
    """Pixel (N,) and triangle (N,) of everything visible, by pixel and then by distance.

    Masked triangles are resolved where they are not cut out; blended ones are all kept. Of the
    scene's triangles only those `shown` (F,) are there; all by default.
    """
    tables = prepared.tables
    there = np.ones(len(tables.solid), np.bool_) if shown is None else shown
    raster = Raster(prepared.scene, tables.solid & there, tables.double_sided, camera, control)
    masked = np.flatnonzero(~tables.solid & ~tables.blended & there).astype(np.int32)
    raster.add(_covering(prepared, camera, raster.nearer_fragments(masked), control))
    blended = np.flatnonzero(tables.blended & there).astype(np.int32)
    layers = _covering(prepared, camera, raster.nearer_fragments(blended), control)
    visible = raster.visible()
    covered = np.flatnonzero(visible >= 0)
    order = np.lexsort((layers.key, layers.pixel))
    pixel = np.concatenate([layers.pixel[order], covered])
    triangle = np.concatenate([layers.triangle[order], visible[covered]])
    by_pixel = np.argsort(pixel, kind="stable")
    return pixel[by_pixel], triangle[by_pixel]


def _covering(prepared: Prepared, camera: Camera, found: Fragments, control: Control) -> Fragments:
    """Those fragments at which the material is not cut out or wholly transparent."""

    def covers(begin: int, end: int) -> Bools:
        _, hits = _hits(prepared, camera, found.pixel[begin:end], found.triangle[begin:end])
        return prepared.tables.alpha(hits.triangle, hits.barycentric) > 0

    parts = map_chunks(len(found.pixel), CHUNK, covers, control)
    kept = np.concatenate(parts) if parts else np.zeros(0, np.bool_)
    return Fragments(found.pixel[kept], found.triangle[kept], found.key[kept])


def _hits(prepared: Prepared, camera: Camera, pixel: Longs, triangle: Ints) -> tuple[Floats, Hits]:
    origins, directions = camera.rays(pixel)
    rays = Rays(origins, directions, np.full(len(pixel), np.inf, np.float32))
    scene = prepared.scene
    return directions, hits_on(Triangles(scene.positions, scene.triangles), triangle, rays)


def points_of(
    prepared: Prepared,
    camera: Camera,
    pixel: Longs,
    triangle: Ints,
    texture_filter: str,
    control: Control,
    stage: str = "",
) -> Points:
    """Evaluate what was rasterised: pixel (N,) shows triangle (N,)."""

    def some(begin: int, end: int) -> Points:
        part = pixel[begin:end]
        directions, hits = _hits(prepared, camera, part, triangle[begin:end])
        return evaluated(prepared, camera, part, directions, hits, texture_filter)

    parts = map_chunks(len(pixel), CHUNK, some, control, stage)
    if not parts:
        parts = [some(0, 0)]
    return Points(
        pixel,
        triangle,
        np.concatenate([part.depth for part in parts]),
        records.joined([part.footprint for part in parts]),
        Surface.joined([part.surface for part in parts]),
    )


def traced(
    prepared: Prepared, camera: Camera, pixel: Longs, within: Doubles
) -> tuple[Longs, Floats, Hits]:
    """What pixels (P,) show at places within them (P, 2), found by rays; see `Camera.rays`.

    Returns the place in `pixel` of each of N hits, in order and from near to far; the direction
    (N, 3) of its ray; and the hits.
    """
    origins, directions = camera.rays(pixel, within)
    rays = Rays(origins, directions, np.full(len(pixel), np.inf, np.float32))
    place, hits = prepared.world.along(rays)
    return place, directions[place], hits


def evaluated(
    prepared: Prepared,
    camera: Camera,
    pixel: Longs,
    directions: Floats,
    hits: Hits,
    texture_filter: str,
    pixels_per_step: float = 1.0,
) -> Points:
    """Evaluate N hits of rays through pixels (N,) in directions (N, 3).

    Each stands for `pixels_per_step` of a pixel along either axis, as in `primary_differentials`.
    """
    depth = hits.t * (directions @ camera.forward.astype(np.float32))
    differentials = primary_differentials(camera, directions, pixels_per_step)
    tables = prepared.tables
    footprint = footprint_at(tables.geometry, hits.triangle, hits.t, directions, differentials)
    surface = tables.surface(hits.triangle, hits.barycentric, directions, footprint, texture_filter)
    seen = mirrored(tables.geometry, hits.triangle, surface, differentials, footprint)
    surface = surface._replace(mirrored=seen)
    return Points(pixel, hits.triangle, depth, footprint, prepared.lobes_of(surface))
