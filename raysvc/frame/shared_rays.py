"""What the picture's points show by rays, those of rough surfaces shared with their neighbours."""

from collections.abc import Callable
from typing import TypeVar

import numpy as np

from raysvc import records
from raysvc.frame.draft import Draft
from raysvc.frame.points import Points, Seen
from raysvc.frame.primary import CHUNK
from raysvc.frame.radiance import Lit
from raysvc.frame.reflections import Reflection, Transmission
from raysvc.lighting.brdf import MIRROR_ROUGHNESS
from raysvc.parallel import for_chunks, map_chunks
from raysvc.tracing.gloss import GlossPicture, weight_of_rays
from raysvc.tracing.tile_pattern import place_in_tile, tile_points
from raysvc.types import Bools, Doubles, Floats, Longs

Brought = TypeVar("Brought", Reflection, Transmission)

MORE = 3
"""Further rays of a point whose lobe is too narrow for neighbours to share, yet not a mirror's."""
NARROW_PX = (0.3, 4.0)
"""Half widths of such lobes, where they end, in pixels."""


def trace_beyond(draft: Draft) -> None:
    """Trace rays from shiny points and through glass, and share those of rough surfaces."""
    points, rays = draft.points, draft.rays
    light = draft.prepared.light

    def reflected(seen: Seen, samples: Doubles | None) -> Reflection:
        return rays.reflected(seen, light.specular_albedo(seen.surface), samples)

    draft.reflection = _traced(draft, reflected, Reflection.none)
    known = draft.reflection.spread_px >= 0
    draft.gloss = _picture(draft, draft.reflection, np.where(known, draft.reflection.share, -1.0))
    _share(draft, draft.gloss, draft.reflection, known)
    draft.transmission = Transmission.none(len(points.pixel))
    if draft.prepared.tables.glassy:
        draft.transmission = _traced(draft, rays.transmitted, Transmission.none)
        known = draft.transmission.spread_px >= 0
        draft.frost = _picture(draft, draft.transmission, np.where(known, 1.0, -1.0))
        # A ray that is totally reflected is none, but its pixel shows what the others bring.
        _share(draft, draft.frost, draft.transmission, draft.transmission.albedo.max(axis=1) > 0)


def beside(
    draft: Draft, points: Points, lit: Lit, pixels_per_step: float
) -> tuple[Reflection, Transmission]:
    """What samples beside pixel centres show: rough ones as their neighbours do, others by rays.

    `points` stand for `pixels_per_step` of a pixel along either axis.
    """
    seen = points.seen(draft.camera, 0, points.surface.size, pixels_per_step)
    reflection = Reflection.none(points.surface.size)
    alone = _taken_over(draft.gloss, points, reflection)
    traced = draft.rays.reflected(records.chosen(seen, alone), lit.albedo[alone])
    reflection.radiance[alone], reflection.share[alone] = traced.radiance, traced.share
    reflection.varnish[alone] = traced.varnish

    transmission = Transmission.none(points.surface.size)
    if draft.frost is not None:
        through = draft.rays.transmitted(seen)
        alone = _taken_over(draft.frost, points, transmission)
        transmission.radiance[alone] = through.radiance[alone]
        transmission.albedo[:] = through.albedo
    return reflection, transmission


def _taken_over(shared: GlossPicture, points: Points, brought: Brought) -> Longs:
    """Let rough points take what their neighbours' rays have brought; which are left alone."""
    surface = points.surface
    radiance, share = shared.gathered(points.pixel, points.depth, surface.normal, surface.roughness)
    known = (share >= 0) & (surface.roughness > MIRROR_ROUGHNESS)
    if surface.coat.size:
        known &= surface.coat.clearcoat == 0
    brought.radiance[known] = radiance[known]
    if isinstance(brought, Reflection):
        brought.share[known] = share[known]
    return np.flatnonzero(~known)


def _traced(
    draft: Draft,
    trace: Callable[[Seen, Doubles | None], Brought],
    none: Callable[[int], Brought],
) -> Brought:
    """What rays of all points bring: into the lobe where a point stands for its pixel."""
    points = draft.points
    in_front = np.zeros(len(points.pixel), np.bool_)
    in_front[draft.front[draft.front >= 0]] = True
    pattern = tile_points(draft.settings.seed)

    def into_lobes(seen: Seen, place: Longs) -> Brought:
        brought = trace(seen, pattern[place])
        low, high = NARROW_PX
        few = np.flatnonzero((brought.lobe_px > low) & (brought.lobe_px < high))
        some_seen = records.chosen(seen, few)
        # The places of a block of 2 x 2 pixels are a net: its four points complete each other.
        rays: list[Brought] = [records.chosen(brought, few)]
        rays += [trace(some_seen, pattern[place[few] ^ k]) for k in range(1, 1 + MORE)]
        _put_mean(brought, few, rays)
        return brought

    def some(begin: int, end: int) -> Brought:
        seen = points.seen(draft.camera, begin, end)
        # Points behind others have no neighbours to share with.
        front = np.flatnonzero(in_front[begin:end])
        behind = np.flatnonzero(~in_front[begin:end])
        place = place_in_tile(points.pixel[begin + front], draft.camera.width)
        parts = [
            into_lobes(records.chosen(seen, front), place),
            trace(records.chosen(seen, behind), None),
        ]
        order = np.argsort(np.concatenate([front, behind]))
        return records.chosen(records.joined(parts), order)

    parts = map_chunks(len(points.pixel), CHUNK, some, draft.control, "reflections")
    return records.joined(parts or [none(0)])


def _put_mean(brought: Brought, few: Longs, rays: list[Brought]) -> None:
    """Write the mean of several rays of the same points to rows `few` of what they brought."""
    weight = np.sum([ray.weight for ray in rays], axis=0)
    shares = [
        ray.weight * (ray.share if isinstance(ray, Reflection) else np.float32(1.0)) for ray in rays
    ]
    met = np.sum(shares, axis=0)
    light = np.sum(
        [share[:, None] * ray.radiance for share, ray in zip(shares, rays, strict=True)], axis=0
    )
    brought.radiance[few] = light / np.maximum(met, np.float32(1e-30))[:, None]
    brought.weight[few] = weight
    if isinstance(brought, Reflection):
        brought.share[few] = met / np.maximum(weight, np.float32(1e-30))
    # Together they stand for the lobe as a ray in its middle does.
    brought.spread_px[few] = brought.lobe_px[few]


def _picture(draft: Draft, brought: Reflection | Transmission, share: Floats) -> GlossPicture:
    """What the rays of the points in front have brought."""

    def picture(values: Floats, empty: float) -> Floats:
        return draft.picture(values.astype(np.float32), empty)

    return GlossPicture(
        picture(brought.radiance, 0.0),
        picture(share, -1.0),
        picture(weight_of_rays(brought.weight, brought.spread_px, brought.lobe_px), 0.0),
        picture(brought.spread_px, 0.0),
        picture(draft.points.surface.roughness, 0.0),
        draft.layers["depth"],
        picture(draft.depth_step, np.inf),
        draft.layers["normal"],
    )


def _share(
    draft: Draft, shared: GlossPicture, brought: Reflection | Transmission, wanted: Bools
) -> None:
    """Let those points in front that are `wanted` (N,) take the mean of the rays about them."""
    points, pixels = draft.points, draft.front[draft.front >= 0]
    pixels = pixels[wanted[pixels]]

    def mean(begin: int, end: int) -> None:
        index = pixels[begin:end]
        radiance, share = shared.gathered(
            points.pixel[index],
            points.depth[index],
            points.surface.normal[index],
            points.surface.roughness[index],
        )
        brought.radiance[index] = radiance
        if isinstance(brought, Reflection):
            brought.share[index] = np.maximum(share, 0.0)

    for_chunks(len(pixels), CHUNK, mean, draft.control)
