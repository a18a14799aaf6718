"""What is behind what the camera sees, where a lens looks past it.

A pinhole shows one surface in each pixel; a lens, beside a silhouette, also what that hides. There
a ray goes on behind it, to what lies in slices farther away. Those points are shaded with all
others, and only the lens ever shows them.
"""

import numpy as np

from raysvc import records
from raysvc.accel.base import Hits, Rays
from raysvc.frame.draft import Draft
from raysvc.frame.points import Points
from raysvc.frame.primary import CHUNK, evaluated
from raysvc.lens.coc import background_coc_px, coc_px, depth_at
from raysvc.lens.silhouettes import hiding
from raysvc.lens.slices import slices_for
from raysvc.parallel import map_chunks
from raysvc.shading.surface import Surface
from raysvc.types import Bools, Doubles, Floats, Longs

ROUNDS = 4
"""Times that a ray goes on from the inside of what it started in."""


def peel(draft: Draft) -> None:
    """Find what a lens sees behind the surfaces in front, and add it to the points."""
    draft.hidden = np.zeros(len(draft.points.pixel), np.bool_)
    if draft.settings.lens != "spread" or draft.camera.aperture_radius == 0.0:
        return
    last, depth = _last_of_pixels(draft)
    coc = coc_px(draft.camera, depth)
    draft.slices = slices_for(float(coc.min()), float(coc.max()), draft.settings.lens_layers)
    draft.uncovered = hiding(coc.reshape(draft.shape), draft.slices).reshape(-1)
    pixel = np.flatnonzero(draft.uncovered)
    begin = depth_at(draft.camera, draft.slices.beyond(coc[pixel]))
    known = np.isfinite(begin)
    draft.uncovered[
        pixel[~known & (draft.slices.beyond(coc[pixel]) > background_coc_px(draft.camera))]
    ] = False
    pixel, begin = pixel[known], begin[known]

    def some(first: int, end: int) -> Points:
        return _behind(draft, pixel[first:end], begin[first:end], last[pixel[first:end]])

    found = map_chunks(len(pixel), CHUNK, some, draft.control)
    _add(draft, found)


def _last_of_pixels(draft: Draft) -> tuple[Longs, Floats]:
    """(H * W,) number of the last point of each pixel, -1 without, and its depth.

    inf where the background is seen as well.
    """
    points = draft.points
    last = np.full(draft.camera.width * draft.camera.height, -1, np.int64)
    last[points.pixel] = np.arange(len(points.pixel))
    depth = np.full(len(last), np.inf, np.float32)
    solid = np.flatnonzero(last >= 0)
    solid = solid[points.surface.alpha[last[solid]] >= 1.0]
    depth[solid] = points.depth[last[solid]]
    return last, depth


def _behind(draft: Draft, pixel: Longs, begin: Doubles, last: Longs) -> Points:
    """What pixels (P,) show from depths `begin` (P,) on, behind their points `last` (P,)."""
    camera, prepared = draft.camera, draft.prepared
    object_of = prepared.scene.object_of_triangle
    origins, directions = camera.rays(pixel)
    along = directions @ camera.forward.astype(np.float32)
    start = (begin / along).astype(np.float32)
    rows: list[Longs] = []
    parts: list[Hits] = []
    active = np.arange(len(pixel))
    for _ in range(ROUNDS):
        rays = Rays(
            origins[active] + start[active, None] * directions[active],
            directions[active],
            np.full(len(active), np.inf, np.float32),
        )
        draft.ledger.count("primary", len(active))
        place, hits = prepared.world.along(rays)
        row = active[place]
        hits = hits._replace(t=hits.t + start[row])
        inside = _is_seen_from_inside(draft, hits, directions[row])
        inside &= object_of[hits.triangle] == object_of[draft.points.triangle[last[row]]]
        rows.append(row[~inside])
        parts.append(records.chosen(hits, np.flatnonzero(~inside)))
        again = np.flatnonzero(inside)
        active = row[again]
        start[active] = hits.t[again] * np.float32(1.0 + 1e-5)
        if not len(active):
            break
    row = np.concatenate(rows)
    order = np.argsort(row, kind="stable")
    row = row[order]
    every = records.chosen(records.joined(parts), order)
    return evaluated(
        prepared, camera, pixel[row], directions[row], every, draft.settings.texture_filter
    )


def _is_seen_from_inside(draft: Draft, hits: Hits, directions: Floats) -> Bools:
    """(N,) bool: whether a ray meets the back of a triangle."""
    scene = draft.prepared.scene
    a, b, c = (scene.positions[scene.triangles[hits.triangle, k]] for k in range(3))
    behind: Bools = np.einsum("nk,nk->n", np.cross(b - a, c - a), directions) > 0
    return behind


def _add(draft: Draft, found: list[Points]) -> None:
    """Add hidden points behind those of the same pixel."""
    parts = [draft.points, *found]
    count = len(draft.points.pixel)
    pixel = np.concatenate([part.pixel for part in parts])
    order = np.argsort(pixel, kind="stable")
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    draft.hidden = order >= count
    front = np.full_like(draft.front, -1)
    seen = draft.front >= 0  # perhaps nowhere
    front[seen] = place[draft.front[seen]]
    draft.front = front
    draft.points = Points(
        pixel[order],
        np.concatenate([part.triangle for part in parts])[order],
        np.concatenate([part.depth for part in parts])[order],
        records.chosen(records.joined([part.footprint for part in parts]), order),
        Surface.joined([part.surface for part in parts]).chosen(order),
    )
