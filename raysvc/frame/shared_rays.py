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
from raysvc.lighting.sun import LUMINANCE
from raysvc.parallel import for_chunks, map_chunks
from raysvc.tracing.gloss import GlossPicture, weight_of_rays
from raysvc.tracing.tile_pattern import place_in_tile, tile_points
from raysvc.types import Bools, Doubles, Floats, Longs

Brought = TypeVar("Brought", Reflection, Transmission)

RAYS = 8
"""Into lobes that one ray cannot tell, if no samples beside the pixel's centre will send theirs."""
NARROW_PX = (0.3, 4.0)
"""Half widths, where they end and in pixels, of lobes that are too narrow for neighbours to share
their rays, yet wider than a mirror's."""
LEAST_DIFFERENCE = 0.12
"""Between neighbours' rays into them, in light compressed to 0..1, at which one ray is too few."""


def trace_beyond(draft: Draft) -> None:
    """Trace rays from shiny points and through glass, and share those of rough surfaces."""
    points, rays = draft.points, draft.rays
    light = draft.prepared.light
    draft.grainy = np.zeros(len(points.pixel), np.bool_)

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
    draft: Draft,
    points: Points,
    lit: Lit,
    pixels_per_step: float,
    samples: Doubles | None = None,
) -> tuple[Reflection, Transmission]:
    """What samples beside pixel centres show: rough ones as their neighbours do, others by rays.

    `points` stand for `pixels_per_step` of a pixel along either axis. With `samples` (N, 2), which
    are for all points of a pixel to be a good choice, they send rays into grainy lobes.
    """
    seen = points.seen(draft.camera, 0, points.surface.size, pixels_per_step)
    reflection = Reflection.none(points.surface.size)
    narrow = _is_narrow(draft, points, draft.reflection, samples is not None)
    alone = _taken_over(draft.gloss, points, narrow, reflection)
    albedo = lit.albedo[alone]
    traced = draft.rays.reflected(
        records.chosen(seen, alone), albedo, None if samples is None else samples[alone]
    )
    reflection.radiance[alone] = traced.radiance
    # What the weights of a lobe's rays are on the mean
    mean = np.maximum(albedo.mean(axis=1), np.float32(1e-6))
    reflection.share[alone] = traced.share * np.minimum(traced.weight / mean, np.float32(1.0))
    reflection.varnish[alone] = traced.varnish

    transmission = Transmission.none(points.surface.size)
    if draft.frost is not None:
        through = draft.rays.transmitted(seen, samples)
        narrow = _is_narrow(draft, points, draft.transmission, samples is not None)
        alone = _taken_over(draft.frost, points, narrow, transmission)
        transmission.radiance[alone] = through.radiance[alone]
        transmission.albedo[:] = through.albedo
    return reflection, transmission


def _is_narrow(
    draft: Draft, points: Points, brought: Reflection | Transmission, or_grainy: bool
) -> Bools:
    """(N,) bool: points whose pixel's centre is of their material and has a lobe like a mirror's.

    Or one that makes it grainy.
    """
    centre, material = draft.front[points.pixel], draft.prepared.scene.material_of_triangle
    if not len(draft.points.pixel):
        return centre >= 0
    lobe_px = brought.lobe_px[centre]
    narrow = (lobe_px >= 0) & (lobe_px <= NARROW_PX[0])
    if or_grainy:
        narrow |= draft.grainy[centre]
    same = material[points.triangle] == material[draft.points.triangle[centre]]
    found: Bools = (centre >= 0) & same & narrow
    return found


def _taken_over(shared: GlossPicture, points: Points, alone: Bools, brought: Brought) -> Longs:
    """Let rough points take what their neighbours' rays have brought, but for those alone (N,).

    Returns which take nothing.
    """
    surface = points.surface
    radiance, share = shared.gathered(points.pixel, points.depth, surface.normal, surface.roughness)
    known = (share >= 0) & (surface.roughness > MIRROR_ROUGHNESS) & ~alone
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

    def some(begin: int, end: int) -> Brought:
        seen = points.seen(draft.camera, begin, end)
        # Points behind others have no neighbours to share with.
        front = np.flatnonzero(in_front[begin:end])
        behind = np.flatnonzero(~in_front[begin:end])
        place = place_in_tile(points.pixel[begin + front], draft.camera.width)
        parts = [
            trace(records.chosen(seen, front), pattern[place]),
            trace(records.chosen(seen, behind), None),
        ]
        order = np.argsort(np.concatenate([front, behind]))
        return records.chosen(records.joined(parts), order)

    parts = map_chunks(len(points.pixel), CHUNK, some, draft.control, "reflections")
    brought = records.joined(parts or [none(0)])
    grainy = _grainy(draft, brought, in_front)
    brushed = _brushed(points)[grainy]
    draft.grainy[grainy[~brushed]] = True
    # In a lobe like a mirror's there is no more to find.
    wide = brought.lobe_px[grainy] > NARROW_PX[0]
    more = grainy[brushed if draft.settings.shades_samples else wide | brushed]

    def again(begin: int, end: int) -> None:
        index = more[begin:end]
        seen = points.chosen(index).seen(draft.camera, 0, len(index))
        # Each point has a net of its own, and those of 8 neighbours are all of the pattern.
        net = RAYS * place_in_tile(points.pixel[index], draft.camera.width)
        _put_mean(
            brought, index, [trace(seen, pattern[(net + k) % len(pattern)]) for k in range(RAYS)]
        )

    for_chunks(len(more), CHUNK // RAYS, again, draft.control)
    return brought


def _brushed(points: Points) -> Bools:
    """(N,) bool: points with a lobe that is longer than it is wide."""
    if not points.surface.brushed.size:
        return np.zeros(len(points.pixel), np.bool_)
    brushed: Bools = points.surface.brushed.strength > 0.0
    return brushed


def _grainy(draft: Draft, brought: Reflection | Transmission, in_front: Bools) -> Longs:
    """Which of the points in front have narrow lobes, and show what their neighbours do not."""
    points, lobe_px = draft.points, brought.lobe_px
    # Across its scratches a wide lobe is narrow too.
    narrow = (lobe_px < NARROW_PX[1]) | _brushed(points)
    index = np.flatnonzero(in_front & (lobe_px > 0) & narrow)
    light = brought.radiance @ LUMINANCE.astype(np.float32)
    if isinstance(brought, Reflection):
        light *= brought.share
    light = np.where(lobe_px < 0, np.float32(np.nan), light / (1.0 + light))
    span = draft.neighbours.span(
        light, 1, points.pixel[index], points.depth[index], points.surface.normal[index]
    )
    return index[span > LEAST_DIFFERENCE]


def _put_mean(brought: Brought, few: Longs, rays: list[Brought]) -> None:
    """Write the mean of several rays of the same points to rows `few` of what they brought."""
    weight = np.mean([ray.weight for ray in rays], axis=0)
    shares = [
        ray.weight * (ray.share if isinstance(ray, Reflection) else np.float32(1.0)) for ray in rays
    ]
    met = np.mean(shares, axis=0)
    light = np.mean(
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
