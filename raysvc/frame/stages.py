"""Stages of a frame, each a function from a draft of it to what it adds.

`raysvc.frame.order` says in which order. Within a stage, chunks of points run on the frame's
threads; progress, cancelling and the deadline are looked at between them.
"""

import numpy as np

from raysvc import records
from raysvc.frame.background import composite
from raysvc.frame.draft import Draft
from raysvc.frame.points import front
from raysvc.frame.primary import CHUNK, points_of, rasterised
from raysvc.frame.reflections import leaving
from raysvc.frame.shadows import AreaShadow
from raysvc.lighting.ambient import Ambient
from raysvc.parallel import for_chunks
from raysvc.tracing.neighbours import Neighbours
from raysvc.tracing.neighbours_kernels import Shown
from raysvc.tracing.occlusion import AROUND, is_traced, tile_of
from raysvc.types import Floats, Longs


def rasterise(draft: Draft) -> None:
    """Find what each pixel shows, and evaluate materials there."""
    pixel, triangle = rasterised(draft.prepared, draft.camera, draft.control, draft.shown)
    draft.points = points_of(
        draft.prepared,
        draft.camera,
        pixel,
        triangle,
        draft.settings.texture_filter,
        draft.control,
        "surfaces",
    )
    points = draft.points
    draft.front = front(
        points.pixel, points.surface.alpha, draft.camera.width * draft.camera.height
    )


def write_layers(draft: Draft) -> None:
    """Lay out what is known of each pixel's point."""
    points, scene = draft.points, draft.prepared.scene
    draft.layers |= {
        "depth": draft.picture(points.depth, np.inf),
        "normal": draft.picture(points.surface.normal, 0.0),
        "albedo": draft.picture(points.surface.base_colour, 0.0),
        "id": draft.picture(points.triangle, -1),
        "object": draft.picture(scene.object_of_triangle[points.triangle], -1),
        "material": draft.picture(scene.material_of_triangle[points.triangle], -1),
    }


def shadows(draft: Draft) -> None:
    """Light the points by what shines straight at them."""
    points, direct = draft.points, draft.illumination.direct
    draft.depth_step = _depth_step(draft)
    draft.direct = draft.each(
        lambda begin, end: direct.punctual(points.surface.rows(begin, end)), "", (3,)
    )
    neighbours = _neighbours(draft, points.surface.geometric_normal)
    for number, light in enumerate(direct.areas):
        draft.control.progress("shadows", number / len(direct.areas))
        shadow = AreaShadow(direct, light, points, neighbours, draft.settings.seed)
        draft.direct += shadow.fallen(draft.control)
        draft.shadows.append(shadow)
    draft.control.progress("shadows", 1.0)


def _depth_step(draft: Draft) -> Floats:
    """(N,) metres that depth may change from a pixel to the next on a point's surface."""
    surface, points = draft.points.surface, draft.points
    cosine = np.einsum("nk,nk->n", surface.geometric_normal, surface.to_viewer)
    slope = np.sqrt(np.maximum(1.0 - cosine**2, 0.0)) / np.maximum(cosine, 0.05)
    step: Floats = draft.camera.pixel_width_m(points.depth) * (1.0 + 1.5 * slope)
    return step


def _neighbours(draft: Draft, normal: Floats) -> Neighbours:
    """The points in front as neighbours, told apart by normals (N, 3)."""
    point_of = draft.front.reshape(draft.shape)
    return Neighbours(Shown(point_of, draft.points.depth, normal, draft.depth_step))


def occlusion(draft: Draft) -> None:
    """Find what surfaces send to each other, and what arrives from all around."""
    draft.illumination.settle(draft.control)
    gather_ambient(draft)


def gather_ambient(draft: Draft) -> None:
    """Find what arrives from all around, of light that has settled."""
    points = draft.points
    draft.neighbours = _neighbours(draft, points.surface.normal)
    if draft.prepared.patches is None:
        draft.ambient = Ambient.open(points.surface.size).columns()
    else:
        _share_ambient(draft)
    around = Ambient.of_columns(draft.ambient)
    draft.layers["occlusion"] = draft.picture(around.visible, 1.0)
    draft.layers["bent_normal"] = draft.picture(around.bent_normal(points.surface.normal), 0.0)


def _share_ambient(draft: Draft) -> None:
    """Trace rays from some points, and let the others take the mean of their neighbours."""
    points, width = draft.points, draft.camera.width
    in_front = draft.neighbours.is_shown()
    traced = ~in_front | is_traced(points.pixel, width)
    draft.ambient = np.full((len(points.pixel), 10), np.nan, np.float32)
    _trace_ambient(draft, np.flatnonzero(traced), "occlusion")
    known = draft.ambient
    draft.ambient = known.copy()

    def fill(begin: int, end: int) -> None:
        index = begin + np.flatnonzero(in_front[begin:end])
        draft.ambient[index] = draft.neighbours.mean(
            known,
            AROUND,
            points.pixel[index],
            points.depth[index],
            points.surface.normal[index],
        )

    for_chunks(len(points.pixel), CHUNK, fill, draft.control)
    _trace_ambient(draft, np.flatnonzero(np.isnan(draft.ambient[:, 0])), "")


def _trace_ambient(draft: Draft, index: Longs, stage: str) -> None:
    """Trace occlusion rays from some of the points."""
    points = draft.points
    tile = tile_of(points.pixel[index], draft.camera.width)

    def trace(begin: int, end: int) -> None:
        some = index[begin:end]
        surface = points.surface.chosen(some)
        draft.ambient[some] = draft.illumination.ambient(surface, tile[begin:end]).columns()

    for_chunks(len(index), CHUNK // 4, trace, draft.control, stage)


def light(draft: Draft) -> None:
    """Add the environment's light, and put points and background together."""
    points = draft.points

    def some(begin: int, end: int) -> Floats:
        lit = draft.illumination.lit(
            points.surface.rows(begin, end),
            records.rows(points.footprint, begin, end),
            draft.direct[begin:end],
            Ambient.of_columns(draft.ambient[begin:end]),
        )
        return leaving(
            lit,
            records.rows(draft.reflection, begin, end),
            records.rows(draft.transmission, begin, end),
        )

    draft.radiance = radiance = draft.each(some, "light", (3,))
    pixel = np.arange(len(draft.front))
    row = points.pixel
    starts = np.searchsorted(row, np.arange(0, len(pixel) + CHUNK, CHUNK))
    rgba = np.empty((len(pixel), 4), np.float32)

    def compose(begin: int, end: int) -> None:
        first, last = starts[begin // CHUNK], starts[begin // CHUNK + 1]
        rgba[begin:end] = composite(
            draft.prepared,
            draft.camera,
            draft.settings,
            pixel[begin:end],
            row[first:last] - begin,
            radiance[first:last],
            points.surface.alpha[first:last],
        )

    for_chunks(len(pixel), CHUNK, compose, draft.control)
    draft.beauty = rgba.reshape(*draft.shape, 4)
